use super::Intersection;
use super::affine_plane::AffinePlane;
use crate::math::{DVec3, Ray};

/// The parallelogram `center +- u +- v`; its front is the side `u x v` points to.
///
/// ```toml
/// shape.quad = { center = [0, 4, 0], u = [1, 0, 0], v = [0, 0, 1] }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Quad {
    /// The plane of the parallelogram, which is the region |a| <= 1, |b| <= 1 of it.
    pub(super) plane: AffinePlane,
}

impl Quad {
    /// Creates the parallelogram with two independent half edges.
    pub fn new(center: DVec3, u: DVec3, v: DVec3) -> Self {
        Self { plane: AffinePlane::new(center, u, v, u.normalize().cross(v.normalize())) }
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        self.plane.intersect(ray, t_max).filter(|c| c.uv[0].abs() <= 1.0 && c.uv[1].abs() <= 1.0)
    }
}
