use super::affine_plane::AffinePlane;
use super::{Crossing, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform};

/// The parallelogram `center +- u +- v`; its front is the side `u x v` points to.
///
/// ```toml
/// shape.quad = { center = [0, 4, 0], u = [1, 0, 0], v = [0, 0, 1] }
/// ```
#[derive(Clone, Debug)]
pub struct Quad {
    plane: AffinePlane,
}

impl Quad {
    /// The parallelogram of two independent half edges.
    pub fn new(center: DVec3, u: DVec3, v: DVec3) -> Self {
        Self { plane: AffinePlane::new(center, u, v, u.normalize().cross(v.normalize())) }
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Crossing> {
        self.plane.intersect(ray, t_max).filter(|c| c.uv[0].abs() <= 1.0 && c.uv[1].abs() <= 1.0)
    }

    /// The plane it lies in, whose unit square it is.
    pub(super) fn plane(&self) -> &AffinePlane {
        &self.plane
    }

    pub(super) fn point(&self, uv: [f64; 2]) -> SurfacePoint {
        self.plane.point(uv)
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.plane.bounds()
    }

    pub(super) fn normal(&self) -> DVec3 {
        self.plane.normal()
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        Self { plane: self.plane.transformed(map) }
    }

    pub(super) fn area(&self) -> f64 {
        self.plane.area()
    }
}
