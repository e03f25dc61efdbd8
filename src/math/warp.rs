//! From the unit square to a shape, each with its density.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::{DVec2, DVec3, Frame, unit};

/// A point of the unit disk, uniform by area (density 1 / pi), by the concentric map that keeps strata compact.
///
/// Shirley & Chiu 1997, *A Low Distortion Map Between Disk and Square*.
pub fn disk(u: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b)) };
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(radius * cos, radius * sin)
}

/// A direction about local +z with density cos(theta) / pi per steradian.
pub fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let p = disk(u);
    DVec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// A direction above a surface of the unit vector `normal`, with density cos(theta) / pi per steradian.
pub fn cosine_about(normal: DVec3, u: [f64; 2]) -> DVec3 {
    unit(Frame::about(normal).to_world(cosine_hemisphere(u)))
}

/// A direction of the full sphere, uniform (density 1 / (4 pi) per steradian).
pub fn ball_surface(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    DVec3::new(radius * cos, radius * sin, z)
}

/// 1 - cos of a cone's half angle from the sine squared, without cancellation for narrow cones.
pub fn one_minus_cos_of_cone(sin_squared: f64) -> f64 {
    sin_squared / (1.0 + (1.0 - sin_squared).max(0.0).sqrt())
}

/// A direction within a cone about local +z, uniform by solid angle.
///
/// The sine comes from x (2 - x) with x = 1 - cos, so that cones as narrow as a star keep all their digits.
pub fn cone(one_minus_cos: f64, u: [f64; 2]) -> DVec3 {
    let x = u[0] * one_minus_cos;
    let radius = (x * (2.0 - x)).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    DVec3::new(radius * cos, radius * sin, 1.0 - x)
}

/// The point (x, y), |x|^2 + |y|^2 < 1, of the unit disk that lies at a place of the square around it, [0, 1]^2; none
/// beside the disk. An area of the square is a quarter of that of the disk.
pub fn disk_in_square(place: [f64; 2]) -> Option<[f64; 2]> {
    let [x, y] = place.map(|x| 2.0 * x - 1.0);
    (x * x + y * y < 1.0).then_some([x, y])
}

/// The place that `disk_in_square` takes to a point; none of a point beside the disk.
pub fn square_around_disk([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    (x * x + y * y < 1.0).then_some([0.5 * (x + 1.0), 0.5 * (y + 1.0)])
}

/// Affine coordinates (u, v) of a point of a triangle, uniform by area.
///
/// Heitz 2019, *A Low-Distortion Map Between Triangle and Square*.
pub fn triangle_coordinates(u: [f64; 2]) -> [f64; 2] {
    let [mut a, mut b] = u;
    if b > a {
        a *= 0.5;
        b -= a;
    } else {
        b *= 0.5;
        a -= b;
    }
    [a, b]
}

/// The place of the unit square that `triangle_coordinates` takes to a point of a triangle.
pub fn triangle_square([a, b]: [f64; 2]) -> [f64; 2] {
    if b > a { [2.0 * a, a + b] } else { [a + b, 2.0 * b] }
}
