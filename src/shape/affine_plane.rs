use super::outline::{Outline, is_near};
use super::triangle::difference_of_products;
use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma};

/// A plane with affine coordinates (a, b): the points `center + a u + b v`. Discs and quads are regions of such a
/// plane.
#[derive(Clone, Debug, PartialEq)]
pub struct AffinePlane {
    pub(super) center: DVec3,
    pub(super) u: DVec3,
    pub(super) v: DVec3,
    pub(super) normal: DVec3,
    dual_u: DVec3,
    dual_v: DVec3,
    /// Largest terms in the sums that give a point of the plane, per coordinate.
    terms: DVec3,
}

impl AffinePlane {
    /// Creates the plane spanned by two independent vectors. Its front is the side that `front` points to.
    pub(super) fn new(center: DVec3, u: DVec3, v: DVec3, front: DVec3) -> Self {
        // Each coordinate is accurate to one rounding, however small the angle between both vectors: the height of
        // points over the plane depends on it.
        let (a, b) = (u.normalize(), v.normalize());
        let coordinate = |i: usize, j: usize| difference_of_products(a[i], b[j], a[j], b[i]);
        let cross = DVec3::new(coordinate(1, 2), coordinate(2, 0), coordinate(0, 1)).normalize();
        let normal = if cross.dot(front) < 0.0 { -cross } else { cross };
        // The duals pick out one coordinate: dual_u.u = 1, dual_u.v = 0.
        let dual = |axis: DVec3, other: DVec3| {
            let across = other.normalize().cross(cross);
            across / across.dot(axis)
        };
        let terms = center.abs() + u.abs() + v.abs();
        Self { center, u, v, normal, dual_u: dual(u, v), dual_v: dual(v, u), terms }
    }

    /// Returns the plane as a face of a body whose own intersection test works with terms as large as these.
    pub(super) fn with_terms(self, terms: DVec3) -> Self {
        Self { terms, ..self }
    }

    /// Returns the crossing with the whole plane. Its `uv` tells whether it lies in the region.
    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        let to_center = self.center - ray.origin;
        let t = to_center.dot(self.normal) / ray.direction.dot(self.normal);
        if !(t > 0.0 && t <= t_max && t.is_finite()) {
            return None;
        }
        let d = ray.direction * t - to_center;
        Some(Intersection { t, part: 0, uv: [d.dot(self.dual_u), d.dot(self.dual_v)] })
    }

    /// Returns the point with the given coordinates.
    pub(super) fn point(&self, [a, b]: [f64; 2]) -> SurfacePoint {
        let position = self.at([a, b]);
        // Two products and two sums, and 3 roundings of the normal: 7 roundings on the largest terms.
        SurfacePoint { position, error: self.terms * gamma(7), normal: self.normal, shading: self.normal }
    }

    pub(super) fn at(&self, [a, b]: [f64; 2]) -> DVec3 {
        self.center + self.u * a + self.v * b
    }

    /// Returns the outline of the parallelogram |a| <= 1, |b| <= 1 as seen from a point, if it is near.
    pub(super) fn outline(&self, from: DVec3) -> Option<Outline> {
        let Self { center, u, v, .. } = *self;
        if !is_near(center - from, u.length_squared() + v.length_squared()) {
            return None;
        }
        Outline::seen_from(from, &[center - u - v, center + u - v, center + u + v, center - u + v], 4.0 * u.cross(v))
    }

    /// Returns the area of the parallelogram |a| <= 1, |b| <= 1.
    pub(super) fn area(&self) -> f64 {
        4.0 * self.u.cross(self.v).length()
    }

    /// Samples a point of the parallelogram |a| <= 1, |b| <= 1 uniformly by area.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> DVec3 {
        self.at([2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0])
    }

    /// Returns the bounding box of the parallelogram |a| <= 1, |b| <= 1.
    pub(super) fn bounds(&self) -> Bounds {
        let corners = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
        Bounds::around(corners.map(|uv| self.at(uv))).padded(8)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        Self::new(map.point(self.center), map.vector(self.u), map.vector(self.v), map.normal(self.normal))
    }
}
