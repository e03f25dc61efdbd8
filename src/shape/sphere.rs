use std::f64::consts::PI;

use super::{Cap, Crossing, Ellipsoid, Shape, SurfacePoint};
use crate::math::{Bounds, DMat3, DVec3, Frame, Ray, Transform, ball_surface, cone, gamma, one_minus_cos_of_cone};

/// A sphere; its front is the outside.
///
/// ```toml
/// shape.sphere = { center = [0, 1, 0], radius = 1 }
/// ```
#[derive(Clone, Debug)]
pub struct Sphere {
    center: DVec3,
    radius: f64,
}

/// How often a sphere of which a cap is seen is aimed at as a whole.
const ELSEWHERE: f64 = 0.05;

impl Sphere {
    /// The sphere of a radius above 0.
    pub fn new(center: DVec3, radius: f64) -> Self {
        Self { center, radius }
    }

    pub(super) fn center(&self) -> DVec3 {
        self.center
    }

    /// Both roots t = n.d -+ s with s^2 = R^2 - |d x n|^2, d = center - origin.
    ///
    /// The cross product keeps the distance to the center out of the discriminant: the error of the hit is a few
    /// roundings of D / R instead of (D / R)^2 (rows S1 to S4 of `tests/stability_shapes.rs`).
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

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Crossing> {
        let t = self.roots(ray)?.into_iter().find(|&t| t > 0.0)?;
        (t <= t_max).then(|| Crossing::at(t))
    }

    /// The point of the sphere nearest to a computed hit.
    pub(super) fn point(&self, hit: DVec3) -> SurfacePoint {
        let normal = (hit - self.center).normalize();
        let arm = normal * self.radius;
        let position = self.center + arm;
        // Normalizing and the arm take 5 roundings, the sum 1: Pharr et al. 2023, section 6.8.4. The roots of the ray
        // that leaves are off by up to 13 more on terms of size R, which do not shrink where the coordinates of center
        // and arm cancel.
        let error = arm.abs() * gamma(18) + position.abs() * gamma(6);
        SurfacePoint { position, error, normal, shading: normal }
    }

    /// The point of the sphere with a unit normal, rounded.
    pub(super) fn over(&self, normal: DVec3) -> DVec3 {
        self.center + normal * self.radius
    }

    pub(super) fn bounds(&self) -> Bounds {
        let reach = DVec3::splat(self.radius);
        Bounds { min: self.center - reach, max: self.center + reach }.padded(8)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Shape {
        match map.uniform_scale() {
            Some(scale) => Shape::Sphere(Self::new(map.point(self.center), self.radius * scale)),
            None => {
                let axes = DMat3::from_diagonal(DVec3::splat(self.radius));
                Shape::Ellipsoid(Ellipsoid::new(self.center, axes).transformed(map))
            }
        }
    }

    pub(super) fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    /// From outside: uniform in the cone the sphere fills. From inside or on it: every direction alike. With its density.
    pub(super) fn aim(&self, from: DVec3, u: [f64; 2]) -> (DVec3, f64) {
        match self.cone_from(from) {
            Some((axis, one_minus_cos)) => {
                let (direction, pdf) = cone(one_minus_cos, u);
                (Frame::about(axis).to_world(direction), pdf)
            }
            None => (ball_surface(u), 1.0 / (4.0 * PI)),
        }
    }

    pub(super) fn pdf_toward(&self, ray: &Ray) -> f64 {
        match self.cone_from(ray.origin) {
            Some((_, one_minus_cos)) => 1.0 / (2.0 * PI * one_minus_cos),
            None => 1.0 / (4.0 * PI),
        }
    }

    /// The same where only a cap is likely to be seen: most directions from outside lead to points of it, uniform by area. The
    /// others keep the estimate right where more is seen.
    pub(super) fn aim_at_cap(&self, cap: &Cap, from: DVec3, [u, v]: [f64; 2]) -> Option<DVec3> {
        if u < ELSEWHERE || self.cone_from(from).is_none() {
            let u = if self.cone_from(from).is_none() { u } else { u / ELSEWHERE };
            return Some(self.aim(from, [u, v]).0);
        }
        let normal = cap.draw([(u - ELSEWHERE) / (1.0 - ELSEWHERE), v]);
        let direction = self.center + normal * self.radius - from;
        // A point behind the horizon is hidden by one in front, whose own density counts.
        if normal.dot(direction) < 0.0 { direction.try_normalize() } else { None }
    }

    /// Density per steradian with which `aim_at_cap` draws the direction of a ray that first meets the sphere at a distance.
    pub(super) fn pdf_at_cap(&self, cap: &Cap, ray: &Ray, t: f64) -> f64 {
        let everywhere = self.pdf_toward(ray);
        if self.cone_from(ray.origin).is_none() {
            return everywhere;
        }
        let normal = (ray.at(t) - self.center).normalize();
        let of_cap = if cap.contains(normal) {
            t * t / (cap.share() * self.area() * normal.dot(ray.direction).abs())
        } else {
            0.0
        };
        ELSEWHERE * everywhere + (1.0 - ELSEWHERE) * of_cap
    }

    /// Axis and 1 - cos of the half angle of the cone in which the sphere is seen from outside.
    fn cone_from(&self, from: DVec3) -> Option<(DVec3, f64)> {
        let d = self.center - from;
        let sin_squared = self.radius * self.radius / d.length_squared();
        (sin_squared < 1.0).then(|| (d.normalize(), one_minus_cos_of_cone(sin_squared)))
    }
}
