use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma};

/// The infinite plane through `point`; its front is the side `normal` points to.
///
/// ```toml
/// shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Plane {
    pub(super) point: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Creates the plane through a point, with a normal of any length above 0.
    pub fn new(point: DVec3, normal: DVec3) -> Self {
        Self { point, normal: normal.normalize() }
    }

    /// Returns the unit normal on the front side.
    pub fn normal(&self) -> DVec3 {
        self.normal
    }

    /// Returns whether another plane lies in the same place, to within `tolerance` times the distance from the world's
    /// origin.
    pub fn coincides(&self, other: &Self, tolerance: f64) -> bool {
        let far = self.point.length().max(other.point.length());
        let is_parallel = self.normal.cross(other.normal).length() < 1e-6;
        is_parallel && (other.point - self.point).dot(self.normal).abs() <= tolerance * far
    }

    /// Returns whether the plane cuts a box, or passes it within `tolerance` times the box's diagonal.
    pub fn meets(&self, bounds: &Bounds, tolerance: f64) -> bool {
        let size = bounds.size();
        let half = 0.5 * size.dot(self.normal.abs());
        (bounds.center() - self.point).dot(self.normal).abs() <= half + tolerance * size.length()
    }

    /// Returns whether a point lies behind the plane, on the side from which the normal points away.
    pub fn is_behind(&self, point: DVec3) -> bool {
        (point - self.point).dot(self.normal) < 0.0
    }

    /// Intersects a ray at t = (q - p0).n_p / (n.n_p). The difference is formed first, so that distance from the
    /// world's origin costs no precision.
    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        let t = (self.point - ray.origin).dot(self.normal) / ray.direction.dot(self.normal);
        (t > 0.0 && t <= t_max && t.is_finite()).then(|| Intersection::at(t))
    }

    /// Returns the point of the plane nearest to a computed hit.
    pub(super) fn point(&self, hit: DVec3) -> SurfacePoint {
        let away = hit - self.point;
        let position = hit - self.normal * away.dot(self.normal);
        // Height above the plane: 1 rounding of `away`, 3 of the dot product, 3 of the unit normal, on terms of size
        // |away|; then 2 of the projection on terms of size |hit|.
        let reach = away.abs().dot(DVec3::ONE);
        let error = (hit.abs() + DVec3::splat(reach)) * gamma(8);
        SurfacePoint { position, error, normal: self.normal, shading: self.normal }
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        Self { point: map.point(self.point), normal: map.normal(self.normal) }
    }
}
