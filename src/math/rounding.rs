//! Ray origins that leave a surface without hitting it again, by error bounds instead of epsilons.

use super::DVec3;

/// Half a unit in the last place of 1: the largest relative error of one rounding.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Returns the bound of the relative error of `n` chained roundings, n u / (1 - n u), where u is the unit roundoff.
///
/// Higham 2002, *Accuracy and Stability of Numerical Algorithms*, lemma 3.1.
pub const fn gamma(n: u32) -> f64 {
    let nu = n as f64 * UNIT_ROUNDOFF;
    nu / (1.0 - nu)
}

/// Returns the origin of a ray along `direction` that cannot hit the surface it leaves.
///
/// `position` is a computed point of the surface, off by at most `error` in each coordinate. `normal` is the surface's
/// geometric unit normal. The origin is moved along the normal, to the side of `direction`, until it is outside the
/// error box. Then each coordinate is moved one step further out, to absorb the rounding of the move itself.
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
