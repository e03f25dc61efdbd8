//! Rays that hit bodies from outside.

use crate::math::{Bounds, DVec3, Ray, sample_sphere};
use crate::shape::{Shape, SurfacePoint};

/// Returns a ray that starts outside of a box and leads to the place at these fractions of its sides. It passes through
/// a point of a ball around the box, which `on_ball` selects.
pub(in crate::scene) fn ray_into(bounds: &Bounds, place: DVec3, on_ball: [f64; 2]) -> Option<Ray> {
    let size = bounds.size().length();
    let target = bounds.min + bounds.size() * place;
    let direction = (target - (bounds.center() + sample_sphere(on_ball) * size)).try_normalize()?;
    Some(Ray { origin: target - direction * (2.0 * size), direction })
}

/// Returns the first point of a bounded shape that a ray from `ray_into` through its box hits, and the direction of
/// that ray.
pub(in crate::scene) fn hit_from_outside(
    shape: &Shape,
    place: DVec3,
    on_ball: [f64; 2],
) -> Option<(SurfacePoint, DVec3)> {
    let ray = ray_into(&shape.bounds()?, place, on_ball)?;
    let intersection = shape.intersect(&ray, f64::INFINITY)?;
    Some((shape.point(&ray, &intersection), ray.direction))
}
