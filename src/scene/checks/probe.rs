//! Rays onto bodies from outside.

use crate::math::{Bounds, DVec3, Ray, ball_surface};
use crate::shape::{Shape, SurfacePoint};

/// A ray from outside of a box to the place at these shares of its sides, by way of a ball around it.
pub(in crate::scene) fn ray_into(bounds: &Bounds, place: DVec3, on_ball: [f64; 2]) -> Option<Ray> {
    let size = bounds.size().length();
    let target = bounds.min + bounds.size() * place;
    let direction = (target - (bounds.center() + ball_surface(on_ball) * size)).try_normalize()?;
    Some(Ray { origin: target - direction * (2.0 * size), direction })
}

/// The point of a bounded shape that such a ray into its box meets first, and the direction of the ray.
pub(in crate::scene) fn met_from_outside(
    shape: &Shape,
    place: DVec3,
    on_ball: [f64; 2],
) -> Option<(SurfacePoint, DVec3)> {
    let ray = ray_into(&shape.bounds()?, place, on_ball)?;
    let intersection = shape.intersect(&ray, f64::INFINITY)?;
    Some((shape.point(&ray, &intersection), ray.direction))
}
