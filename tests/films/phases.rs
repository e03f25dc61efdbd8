//! The phase between both polarizations, which no image of unpolarized light shows.

use abbe::material::{Block, Layer, PolarizedShare, Stack};
use abbe::math::Complex;

/// What is reflected at 550 nm by one clear layer on n - i k, under an angle in degrees.
fn reflected(index: f64, thickness_nm: f64, n2: [f64; 2], degrees: f64) -> PolarizedShare {
    let layer = Layer { index: index.into(), thickness_nm };
    let stack = Stack::new([550.0, 0.0], [layer].into_iter());
    stack.shares(1.0, Complex::new(n2[0], -n2[1]), degrees.to_radians().cos()).reflected
}

#[test]
fn p_is_the_negative_of_s_along_the_normal_and_turns_as_abeles_has_it() {
    // Index and thickness of the layer, n and k beyond, angle and argument of r_p / r_s in degrees.
    const QUARTER: f64 = 99.637_681_159;
    let glass = [1.518_522_366, 0.0];
    for (index, thickness, n2, angle, argument) in [
        (1.38, QUARTER, glass, 0.0, 180.0),
        (1.38, QUARTER, glass, 30.0, 178.5563),
        (1.38, QUARTER, glass, 45.0, 165.1251),
        (1.38, QUARTER, glass, 60.0, 17.7510),
        (1.38, QUARTER, glass, 75.0, 5.9963),
        (1.46, 100.0, [1.015, 6.627], 60.0, 160.8335),
    ] {
        let share = reflected(index, thickness, n2, angle);
        let Block { c, q, .. } = share.block();
        let found = q.atan2(c).to_degrees().abs();
        assert!((found - argument).abs() < 2e-3, "{found} for {argument} at {angle} degrees");
        assert!((c.hypot(q) - (share.s * share.p).sqrt()).abs() < 1e-12);
    }
}
