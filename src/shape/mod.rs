//! Floor 1: the geometry of surfaces. Does not depend on spectra.
//!
//! A shape answers four questions: where a ray crosses it, what the surface is like there, what box it fills, and, if
//! it is a light, in which directions it is seen. Every answer carries the error bound that lets a new ray leave the
//! surface.

mod affine_plane;
mod attributes;
mod ball;
mod bvh;
mod coordinates;
mod cube;
mod disc;
mod ear_clipping;
mod edges;
mod ellipsoid;
mod faces;
mod flipped;
mod fragments;
mod gltf;
mod gltf_buffer;
mod hull;
mod instance;
mod interner;
mod intersection;
mod kinds;
mod mesh;
mod mesh_data;
mod mesh_file;
mod obj;
mod outline;
mod packed_triangles;
mod plane;
mod ply;
mod ply_body;
mod polygon;
mod pool;
mod quad;
mod sample;
mod sides;
mod sphere;
mod textured;
mod triangle;
mod vertices;

pub use attributes::{Attributes, vertex_normals};
pub use ball::Ball;
pub use bvh::{Bvh, Visitor};
pub(crate) use bvh::{Computation, Instructions, Vectors, prefetch};
pub use coordinates::Coordinates;
pub use cube::Cube;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use faces::Faces;
pub use instance::Instance;
pub use intersection::{Intersection, SurfacePoint};
pub use kinds::{Shape, is_before};
pub use mesh::Mesh;
pub use mesh_data::MeshFile;
pub use mesh_file::read as read_mesh;
pub use plane::Plane;
pub use polygon::Polygon;
pub use pool::Pool;
pub use quad::Quad;
pub use sample::{Density, ShapeSample};
pub use sides::Sides;
pub use sphere::Sphere;
pub use textured::{TexturedPoint, TexturedShape};
pub use triangle::Triangle;
pub use vertices::Vertices;
