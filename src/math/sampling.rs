//! Maps from the unit square to shapes, each with its density.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::{DVec2, DVec3, Frame, unit};

/// Samples the unit disk uniformly by area (density 1 / pi), by the concentric map, which keeps strata compact.
///
/// Shirley & Chiu 1997, *A Low Distortion Map Between Disk and Square*.
pub fn sample_disk(u: [f64; 2]) -> DVec2 {
    let (a, b) = (2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0);
    if a == 0.0 && b == 0.0 {
        return DVec2::ZERO;
    }
    let (radius, angle) =
        if a.abs() > b.abs() { (a, FRAC_PI_4 * (b / a)) } else { (b, 2.0 * FRAC_PI_4 - FRAC_PI_4 * (a / b)) };
    let (sin, cos) = libm::sincos(angle);
    DVec2::new(radius * cos, radius * sin)
}

/// Samples a direction about local +z with density cos(theta) / pi per steradian.
pub fn sample_cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    let p = sample_disk(u);
    DVec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Samples a direction above a surface with the unit normal `normal`, with density cos(theta) / pi per steradian.
pub fn sample_cosine_about(normal: DVec3, u: [f64; 2]) -> DVec3 {
    unit(Frame::about(normal).to_world(sample_cosine_hemisphere(u)))
}

/// Samples a direction of the full sphere uniformly (density 1 / (4 pi) per steradian).
pub fn sample_sphere(u: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * u[0];
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    DVec3::new(radius * cos, radius * sin, z)
}

/// Returns 1 - cos of a cone's half angle from the square of its sine, without cancellation for narrow cones.
pub fn one_minus_cos_of_cone(sin_squared: f64) -> f64 {
    sin_squared / (1.0 + (1.0 - sin_squared).max(0.0).sqrt())
}

/// Samples a direction within a cone about local +z, uniformly in solid angle.
///
/// The sine is computed from x (2 - x) with x = 1 - cos, so that cones as narrow as that of a star keep full precision.
pub fn cone(one_minus_cos: f64, u: [f64; 2]) -> DVec3 {
    let x = u[0] * one_minus_cos;
    let radius = (x * (2.0 - x)).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * u[1]);
    DVec3::new(radius * cos, radius * sin, 1.0 - x)
}

/// Maps a point of the square [0, 1]^2 to the inscribed unit disk, as (x, y) with |x|^2 + |y|^2 < 1. Returns `None`
/// outside the disk. An area of the square is a quarter of the corresponding area of the disk.
pub fn square_to_disk(place: [f64; 2]) -> Option<[f64; 2]> {
    let [x, y] = place.map(|x| 2.0 * x - 1.0);
    (x * x + y * y < 1.0).then_some([x, y])
}

/// Returns the point of the square that `square_to_disk` maps to a point of the disk, or `None` for a point outside the
/// disk.
pub fn disk_to_square([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    (x * x + y * y < 1.0).then_some([0.5 * (x + 1.0), 0.5 * (y + 1.0)])
}

/// Samples the affine coordinates (u, v) of a point of a triangle, uniformly by area.
///
/// Heitz 2019, *A Low-Distortion Map Between Triangle and Square*.
pub fn sample_triangle(u: [f64; 2]) -> [f64; 2] {
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

/// Returns the point of the unit square that `sample_triangle` maps to a point of a triangle.
pub fn triangle_to_square([a, b]: [f64; 2]) -> [f64; 2] {
    if b > a { [2.0 * a, a + b] } else { [a + b, 2.0 * b] }
}
