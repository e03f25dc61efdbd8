//! Leaving a surface without hitting it again: error bounds instead of epsilons.

use super::DVec3;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Bound of the relative error of `n` chained roundings, n u / (1 - n u).
///
/// Higham 2002, *Accuracy and Stability of Numerical Algorithms*, lemma 3.1.
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// Where a ray along `direction` starts so that it cannot hit the surface it leaves.
///
/// `position` is a point computed to lie on the surface, at most `error` off in each coordinate; `normal` is the
/// surface's geometric unit normal. The origin is moved along the normal, to the side of `direction`, beyond the box of
/// the error, then each coordinate one step outward to absorb the rounding of the move itself.
/// Pharr, Jakob & Humphreys 2023, *Physically Based Rendering*, 4th ed., section 6.8.5.
pub fn offset_origin(position: DVec3, error: DVec3, normal: DVec3, direction: DVec3) -> DVec3 {
    let distance = normal.abs().dot(error);
    let away = if direction.dot(normal) < 0.0 { -normal } else { normal };
    let offset = away * distance;
    let outward = |x: f64, d: f64| {
        if d > 0.0 {
            (x + d).next_up()
        } else if d < 0.0 {
            (x + d).next_down()
        } else {
            x
        }
    };
    DVec3::new(outward(position.x, offset.x), outward(position.y, offset.y), outward(position.z, offset.z))
}
