//! Where a ray crosses a shape, and the surface point there.

use crate::math::{DVec3, Ray, offset_origin};

/// Where a ray crosses one shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Intersection {
    /// Distance along the ray, above 0.
    pub t: f64,
    /// Triangle of a mesh or face of a cube; 0 for other shapes.
    pub part: u32,
    /// Affine coordinates on a triangle, disc, quad or cube face; 0 for other shapes.
    pub uv: [f64; 2],
}

impl Intersection {
    pub(super) fn at(t: f64) -> Self {
        Self { t, part: 0, uv: [0.0; 2] }
    }
}

/// A point of a surface, as accurate as arithmetic can place it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point, in the world.
    pub position: DVec3,
    /// Bound of the distance to the true surface, coordinate by coordinate.
    pub error: DVec3,
    /// Geometric unit normal on the front side.
    pub normal: DVec3,
    /// Shading normal: the unit normal by which materials scatter, on the front side. It equals `normal`, except on
    /// smooth meshes and under relief maps.
    pub shading: DVec3,
}

impl SurfacePoint {
    /// Creates a point that lies on no surface. Rays start exactly there. Its normals are 0.
    pub fn in_space(position: DVec3) -> Self {
        Self { position, error: DVec3::ZERO, normal: DVec3::ZERO, shading: DVec3::ZERO }
    }

    /// Returns the ray that leaves the surface at this point along a unit vector. It cannot hit the surface there
    /// again.
    pub fn leave(&self, direction: DVec3) -> Ray {
        let origin = offset_origin(self.position, self.error, self.normal, direction);
        Ray { origin, direction }
    }
}
