//! Floor 1: where surfaces are; knows no spectra.
//!
//! A shape answers four questions: where a ray crosses it, what the surface is like there, what box it fills, and, as a
//! light, in which directions it is seen. Every answer carries the error bound that lets a new ray leave the surface.

mod affine_plane;
mod aim;
mod attributes;
mod bvh;
mod cap;
mod coordinates;
mod cube;
mod disc;
mod edges;
mod ellipsoid;
mod emit;
mod emitters;
mod gltf;
mod gltf_buffer;
mod instance;
mod mesh;
mod mesh_file;
mod obj;
mod outline;
mod packed;
mod plane;
mod pool;
mod quad;
mod sides;
mod sphere;
mod tangents;
mod triangle;

pub use aim::{Density, Sighting};
pub use attributes::{Attributes, vertex_normals};
pub use bvh::{Bvh, Vectors, Visitor};
pub use cap::Cap;
pub use coordinates::Coordinates;
pub use cube::Cube;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use emit::Ball;
pub use emitters::{Choice, Emitter, Emitters, Facing};
pub use instance::Instance;
pub use mesh::{Mesh, MeshReport, Vertices};
pub use mesh_file::{read as read_mesh, read_smooth as read_smooth_mesh};
pub use plane::Plane;
pub use pool::Pool;
pub use quad::Quad;
pub use sides::Sides;
pub use sphere::Sphere;
pub use triangle::Triangle;

use std::sync::Arc;

use crate::math::{Bounds, DVec3, Ray, Transform};

/// A surface.
#[derive(Clone, Debug)]
pub enum Shape {
    /// An infinite plane.
    Plane(Plane),
    /// One triangle.
    Triangle(Triangle),
    /// A sphere.
    Sphere(Sphere),
    /// A sphere after an uneven scale.
    Ellipsoid(Ellipsoid),
    /// A flat disc or ellipse.
    Disc(Disc),
    /// A parallelogram.
    Quad(Quad),
    /// A box or parallelepiped.
    Cube(Cube),
    /// Many triangles.
    Mesh(Arc<Mesh>),
    /// Many triangles that other places share.
    Instance(Box<Instance>),
}

/// Where a ray crosses one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance along the ray, above 0.
    pub t: f64,
    /// Triangle of a mesh, face of a cube; 0 elsewhere.
    pub part: u32,
    /// Affine coordinates on a triangle, disc, quad or cube face; 0 elsewhere.
    pub uv: [f64; 2],
}

impl Crossing {
    fn at(t: f64) -> Self {
        Self { t, part: 0, uv: [0.0; 2] }
    }
}

/// A point of a surface, as good as arithmetic can place it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, in the world.
    pub position: DVec3,
    /// Bound of the distance to the true surface, coordinate by coordinate.
    pub error: DVec3,
    /// Geometric unit normal on the front side.
    pub normal: DVec3,
    /// Unit normal by which materials scatter, on the front side: `normal` but on smooth meshes and under maps of relief.
    pub shading: DVec3,
}

impl SurfacePoint {
    /// The ray that leaves the surface at this point along a unit vector and cannot hit it again there.
    pub fn leave(&self, direction: DVec3) -> Ray {
        let origin = crate::math::offset_origin(self.position, self.error, self.normal, direction);
        Ray { origin, direction }
    }
}

impl Shape {
    /// The nearest crossing with 0 < t <= `t_max`.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Crossing> {
        match self {
            Self::Plane(plane) => plane.intersect(ray, t_max),
            Self::Triangle(triangle) => triangle.intersect(ray, t_max),
            Self::Sphere(sphere) => sphere.intersect(ray, t_max),
            Self::Ellipsoid(ellipsoid) => ellipsoid.intersect(ray, t_max),
            Self::Disc(disc) => disc.intersect(ray, t_max),
            Self::Quad(quad) => quad.intersect(ray, t_max),
            Self::Cube(cube) => cube.intersect(ray, t_max),
            Self::Mesh(mesh) => mesh.intersect(ray, t_max),
            Self::Instance(instance) => instance.intersect(ray, t_max),
        }
    }

    /// Whether there is a crossing with 0 < t <= `t_max`.
    pub fn is_crossed(&self, ray: &Ray, t_max: f64) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.is_crossed(ray, t_max),
            Self::Instance(instance) => instance.is_crossed(ray, t_max),
            _ => self.intersect(ray, t_max).is_some(),
        }
    }

    /// The surface at a crossing that `intersect` found on this ray.
    pub fn point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        match self {
            Self::Plane(plane) => plane.point(ray.at(crossing.t)),
            Self::Triangle(triangle) => triangle.point(crossing.uv),
            Self::Sphere(sphere) => sphere.point(ray.at(crossing.t)),
            Self::Ellipsoid(ellipsoid) => ellipsoid.point(ray.at(crossing.t)),
            Self::Disc(disc) => disc.point(crossing.uv),
            Self::Quad(quad) => quad.point(crossing.uv),
            Self::Cube(cube) => cube.point(crossing),
            Self::Mesh(mesh) => mesh.point(crossing),
            Self::Instance(instance) => instance.point(crossing),
        }
    }

    /// The box the shape fills, or none for an infinite one.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Plane(_) => None,
            Self::Triangle(triangle) => Some(triangle.bounds()),
            Self::Sphere(sphere) => Some(sphere.bounds()),
            Self::Ellipsoid(ellipsoid) => Some(ellipsoid.bounds()),
            Self::Disc(disc) => Some(disc.bounds()),
            Self::Quad(quad) => Some(quad.bounds()),
            Self::Cube(cube) => Some(cube.bounds()),
            Self::Mesh(mesh) => Some(mesh.bounds()),
            Self::Instance(instance) => Some(instance.bounds()),
        }
    }

    /// The shape after an invertible affine map.
    pub fn transformed(self, map: &Transform) -> Self {
        if *map == Transform::IDENTITY {
            return self;
        }
        match self {
            Self::Plane(plane) => Self::Plane(plane.transformed(map)),
            Self::Triangle(triangle) => Self::Triangle(triangle.transformed(map)),
            Self::Sphere(sphere) => sphere.transformed(map),
            Self::Ellipsoid(ellipsoid) => Self::Ellipsoid(ellipsoid.transformed(map)),
            Self::Disc(disc) => Self::Disc(disc.transformed(map)),
            Self::Quad(quad) => Self::Quad(quad.transformed(map)),
            Self::Cube(cube) => Self::Cube(cube.transformed(map)),
            Self::Mesh(mesh) => Self::Mesh(Arc::new(mesh.transformed(map))),
            Self::Instance(instance) => match instance.transformed(map) {
                Some(instance) => Self::Instance(Box::new(instance)),
                None => Self::Mesh(Arc::new(instance.baked().transformed(map))),
            },
        }
    }

    /// Another one of many such shapes, after an invertible affine map; they share the triangles of a mesh.
    pub fn copied(&self, map: &Transform) -> Self {
        let shared = match self {
            Self::Mesh(mesh) if *map != Transform::IDENTITY => Instance::new(mesh.clone(), *map),
            _ => None,
        };
        shared.map_or_else(|| self.clone().transformed(map), |instance| Self::Instance(Box::new(instance)))
    }

    /// Whether the shape has an inside: a dielectric on it fills that, or the half space behind a plane.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Plane(_) | Self::Sphere(_) | Self::Ellipsoid(_) | Self::Cube(_) => true,
            Self::Triangle(_) | Self::Disc(_) | Self::Quad(_) => false,
            Self::Mesh(mesh) => mesh.is_closed(),
            Self::Instance(instance) => instance.is_closed(),
        }
    }

    /// The shape's area, infinite for a plane.
    pub fn area(&self) -> f64 {
        match self {
            Self::Plane(_) => f64::INFINITY,
            Self::Triangle(triangle) => triangle.area(),
            Self::Sphere(sphere) => sphere.area(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.area(),
            Self::Disc(disc) => disc.area(),
            Self::Quad(quad) => quad.area(),
            Self::Cube(cube) => cube.area(),
            Self::Mesh(mesh) => mesh.area(),
            Self::Instance(instance) => instance.area(),
        }
    }
}
