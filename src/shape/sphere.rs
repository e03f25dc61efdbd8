use std::f64::consts::PI;

use super::{Ball, Ellipsoid, Intersection, ShapeSample, SurfacePoint};
use crate::math::{Bounds, Cone, DMat3, DVec3, Ray, Transform, gamma, sample_sphere};

/// A sphere; its front is the outside.
///
/// ```toml
/// shape.sphere = { center = [0, 1, 0], radius = 1 }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sphere {
    pub(super) center: DVec3,
    radius: f64,
}

/// Probability of sampling a sphere as a whole, although mostly only a cap of it is seen.
const WHOLE_PROBABILITY: f64 = 0.05;

impl Sphere {
    /// Creates the sphere with a radius above 0.
    pub fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }

    /// Returns whether more than a spot of the surface may lie in another sphere's: only if centers and radii are about
    /// the same. Spheres that touch from within, with centers 1e-4 radii apart, lie within 1e-9 of their size of one
    /// another over a hundredth of a radian.
    pub fn may_coincide(&self, other: &Self) -> bool {
        let near = 1e-4 * self.radius;
        (self.center - other.center).length() < near && (self.radius - other.radius).abs() < near
    }

    /// Returns both roots t = n.d -+ s with s^2 = R^2 - |d x n|^2, d = center - origin.
    ///
    /// The cross product keeps the distance to the center out of the discriminant. The error of the hit is a few
    /// roundings times D / R instead of (D / R)^2 (rows S1 to S4 of `tests/stability_shapes.rs`).
    fn roots(&self, ray: &Ray) -> Option<[f64; 2]> {
        let d = self.center - ray.origin;
        let s2 = self.radius * self.radius - d.cross(ray.direction).length_squared();
        if s2 >= 0.0 {
            let (middle, s) = (d.dot(ray.direction), s2.sqrt());
            Some([middle - s, middle + s])
        } else {
            None
        }
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        let t = self.roots(ray)?.into_iter().find(|&t| t > 0.0)?;
        (t <= t_max).then(|| Intersection::at(t))
    }

    /// Returns the point of the sphere nearest to a computed hit.
    pub(super) fn point(&self, hit: DVec3) -> SurfacePoint {
        let normal = (hit - self.center).normalize();
        let arm = normal * self.radius;
        let position = self.center + arm;
        // Normalizing and scaling take 5 roundings, the sum 1: Pharr et al. 2023, section 6.8.4. The roots of a ray
        // that leaves are off by up to 13 more on terms of size R, which do not shrink where the coordinates of center
        // and arm cancel.
        let error = arm.abs() * gamma(18) + position.abs() * gamma(6);
        SurfacePoint { position, error, normal, shading: normal }
    }

    /// Returns the point of the sphere with a unit normal, rounded.
    pub(super) fn position_at(&self, normal: DVec3) -> DVec3 {
        self.center + normal * self.radius
    }

    pub(super) fn bounds(&self) -> Bounds {
        let reach = DVec3::splat(self.radius);
        Bounds { min: self.center - reach, max: self.center + reach }.padded(8)
    }

    /// Returns the ball that fills the sphere's box.
    pub(super) fn ball(&self) -> Ball {
        let bounds = self.bounds();
        Ball { center: bounds.center(), radius: 0.5 * bounds.size().max_element() }
    }

    /// Returns the sphere after a map, or `None` after a non-uniform map, which makes it an ellipsoid.
    pub(super) fn transformed(&self, map: &Transform) -> Option<Self> {
        map.uniform_scale().map(|scale| Self::new(map.point(self.center), self.radius * scale))
    }

    /// Returns the surface as an ellipsoid.
    pub(super) fn ellipsoid(&self) -> Ellipsoid {
        Ellipsoid::new(self.center, DMat3::from_diagonal(DVec3::splat(self.radius)))
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    /// Samples a direction from a point. From outside, it is uniform in the cone that the sphere fills. From inside or
    /// on the surface, it is uniform over all directions.
    pub(super) fn sample(&self, from: DVec3, u: [f64; 2]) -> ShapeSample {
        match self.cone_from(from) {
            Some(cone) => ShapeSample::of_direction(cone.sample_uniform(u), cone.uniform_pdf()),
            None => ShapeSample::of_direction(sample_sphere(u), 1.0 / (4.0 * PI)),
        }
    }

    /// Returns the density per steradian with which `sample` draws the direction of a ray that meets the sphere.
    pub(super) fn pdf(&self, ray: &Ray) -> f64 {
        self.cone_from(ray.origin).map_or(1.0 / (4.0 * PI), |cone| cone.uniform_pdf())
    }

    /// Samples a direction from a point to a sphere of which mostly only a cap is seen, given by its unit normals. From
    /// outside, most directions lead to points of the cap, uniformly by area. The others keep the estimate unbiased
    /// where more is seen.
    pub fn sample_cap(&self, cap: &Cone, from: DVec3, [u, v]: [f64; 2]) -> Option<ShapeSample> {
        let outside = self.is_outside(from);
        if u < WHOLE_PROBABILITY || !outside {
            let u = if outside { u / WHOLE_PROBABILITY } else { u };
            return Some(ShapeSample { density: None, ..self.sample(from, [u, v]) });
        }
        let normal = cap.sample_uniform([(u - WHOLE_PROBABILITY) / (1.0 - WHOLE_PROBABILITY), v]);
        let direction = self.position_at(normal) - from;
        // A point behind the horizon is hidden by one in front, and the density of that one counts.
        if normal.dot(direction) < 0.0 { ShapeSample::along(direction) } else { None }
    }

    /// Returns the density per steradian with which `sample_cap` draws the direction of a ray that first meets the
    /// sphere at a distance.
    pub fn pdf_cap(&self, cap: &Cone, ray: &Ray, t: f64) -> f64 {
        let whole_pdf = self.pdf(ray);
        if !self.is_outside(ray.origin) {
            return whole_pdf;
        }
        let normal = (ray.at(t) - self.center).normalize();
        let cap_pdf = if cap.contains(normal) {
            t * t / (0.5 * cap.one_minus_cos * self.area() * normal.dot(ray.direction).abs())
        } else {
            0.0
        };
        WHOLE_PROBABILITY * whole_pdf + (1.0 - WHOLE_PROBABILITY) * cap_pdf
    }

    /// Samples a point of the cap that sees some of a ball. The density increases toward the middle of the cap, in the
    /// same way as the light that the ball receives.
    pub(super) fn sample_emission(&self, toward: &Ball, u: [f64; 2]) -> SurfacePoint {
        let cap = self.ball().cap_toward(toward);
        let u = if cap.is_all() { u } else { [1.0 - u[0].sqrt(), u[1]] };
        self.point(self.position_at(cap.sample_uniform(u)))
    }

    /// Returns the density per unit area with which `sample_emission` draws a point.
    pub(super) fn pdf_emission(&self, toward: &Ball, point: &SurfacePoint) -> f64 {
        let Cone { axis, one_minus_cos } = self.ball().cap_toward(toward);
        // 1 - cos of the angle from the middle of the cap. A far ball receives light by the cosine, which is 0 at the
        // rim.
        let here = 0.5 * (point.normal - axis).length_squared();
        let share = if one_minus_cos < 2.0 { 2.0 * (1.0 - here / one_minus_cos).max(0.0) } else { 1.0 };
        share * 2.0 / (one_minus_cos * self.area())
    }

    /// Samples a point from which light may reach a ball. Most points lie on a cap, given by its unit normals, and are
    /// uniform by area. The others are drawn by `sample_emission`.
    pub fn sample_cap_emission(&self, cap: &Cone, toward: &Ball, [u, v]: [f64; 2]) -> SurfacePoint {
        if u < WHOLE_PROBABILITY {
            return self.sample_emission(toward, [u / WHOLE_PROBABILITY, v]);
        }
        self.point(self.position_at(cap.sample_uniform([(u - WHOLE_PROBABILITY) / (1.0 - WHOLE_PROBABILITY), v])))
    }

    /// Returns the density per unit area with which `sample_cap_emission` draws a point for a ball.
    pub fn pdf_cap_emission(&self, cap: &Cone, toward: &Ball, point: &SurfacePoint) -> f64 {
        let cap_pdf = if cap.contains(point.normal) { 2.0 / (cap.one_minus_cos * self.area()) } else { 0.0 };
        WHOLE_PROBABILITY * self.pdf_emission(toward, point) + (1.0 - WHOLE_PROBABILITY) * cap_pdf
    }

    pub(super) fn is_outside(&self, point: DVec3) -> bool {
        self.cone_from(point).is_some()
    }

    /// Returns the cone of directions in which the sphere is seen from outside.
    fn cone_from(&self, from: DVec3) -> Option<Cone> {
        let cone = Ball { center: self.center, radius: self.radius }.cone_from(from);
        (!cone.is_all()).then_some(cone)
    }
}
