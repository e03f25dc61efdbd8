//! Row D17: layers that absorb all light, and layers at their critical angle.

use std::f64::consts::TAU;

use abbe::material::{Layer, Stack};
use abbe::math::Complex;

const NM: f64 = 548.6;
const SILVER: [f64; 2] = [0.06, 3.586];

fn stack(layers: &[([f64; 2], f64)]) -> Stack {
    let layer = |&([n, k], thickness_nm): &([f64; 2], f64)| Layer { index: Complex::new(n, -k), thickness_nm };
    Stack::new([NM, 0.0], layers.iter().map(layer))
}

/// Returns the cosine of a layer's complex phase delta, as it is written in the characteristic matrix of Born & Wolf.
fn cosine_as_written(index: [f64; 2], thickness_nm: f64) -> [f64; 2] {
    let [re, im] = index.map(|part| part * TAU * thickness_nm / NM);
    [re.cos() * im.cosh(), re.sin() * im.sinh()]
}

/// A layer that transmits no light acts as its bulk. The largest numbers of its matrix have a thousand digits and more
/// before the point, and only their quotients count.
#[test]
fn d17_layers_that_absorb_all_light_are_as_their_bulk() {
    for thickness in [10_000.0, 20_000.0, 100_000.0] {
        let written = cosine_as_written(SILVER, thickness);
        assert_eq!(written.iter().all(|x| x.is_finite()), thickness < 15_000.0, "{thickness} nm: {written:?}");
        for cos in [1.0, 0.5, 1e-3, 1e-12] {
            let bulk = stack(&[]).shares(1.0, Complex::new(SILVER[0], -SILVER[1]), cos).reflected;
            for layers in [vec![(SILVER, thickness)], vec![(SILVER, thickness); 32]] {
                let found = stack(&layers).shares(1.0, 1.5.into(), cos);
                assert!((found.reflected.s - bulk.s).abs() < 1e-12, "{thickness} nm at {cos}: {found:?}");
                assert!((found.reflected.p - bulk.p).abs() < 1e-12, "{thickness} nm at {cos}: {found:?}");
                assert_eq!([found.refracted.s, found.refracted.p], [0.0; 2], "{thickness} nm at {cos}");
            }
        }
    }
}

/// At the critical angle of a layer, the phase and the admittance are 0, and sin(delta) / q is 0 / 0. A gap of air
/// between glasses of index 1.25, hit at a cosine of 0.6, is there to the last bit. Then R = x^2 / (4 + x^2), with x =
/// k d q1 for s and x = k d q1 / n1^2 for p.
#[test]
fn d17_a_layer_at_its_critical_angle_has_its_limit() {
    let (n1, cos) = (1.25, 0.6);
    let q1 = n1 * cos;
    assert_eq!((1.0 - n1) * (1.0 + n1) + q1 * q1, 0.0);
    for gap in [1.0, 100.0, 300.0, 5000.0, 100_000.0] {
        let phase = TAU * gap / NM;
        let [s, p] = [phase * q1, phase * q1 / (n1 * n1)].map(|x| x * x / (4.0 + x * x));
        let found = stack(&[([1.0, 0.0], gap)]).shares(n1, n1.into(), q1);
        assert!((found.reflected.s - s).abs() < 1e-12 && (found.reflected.p - p).abs() < 1e-12, "{gap} nm: {found:?}");
        // Nothing jumps next to it.
        for q1 in [q1 * (1.0 - 1e-12), q1 * (1.0 + 1e-12)] {
            let beside = stack(&[([1.0, 0.0], gap)]).shares(n1, n1.into(), q1);
            assert!((beside.reflected.s - s).abs() < 1e-5, "{gap} nm: {beside:?} for {s}");
            assert!((beside.reflected.mean() + beside.refracted.mean() - 1.0).abs() < 1e-12, "{gap} nm: {beside:?}");
        }
    }
}

/// A wave that decays in a gap of any width is transmitted or reflected, and none of it is lost or gained. The
/// difference of two growing exponentials would leave nothing but rounding errors.
#[test]
fn d17_total_reflection_at_a_gap_of_any_width_keeps_all_light() {
    for gap in [1.0, 30.0, 300.0, 3000.0, 100_000.0] {
        for cos in [0.7, 0.3, 1e-2, 1e-6, 1e-12] {
            let found = stack(&[([1.0, 0.0], gap)]).shares(1.5, 1.5.into(), 1.5 * cos);
            let [s, p] = [found.reflected.s + found.refracted.s, found.reflected.p + found.refracted.p];
            assert!((s - 1.0).abs() < 1e-12 && (p - 1.0).abs() < 1e-12, "{gap} nm at {cos}: {found:?}");
            if gap == 100_000.0 {
                assert_eq!([found.refracted.s, found.refracted.p], [0.0; 2], "at {cos}");
            }
        }
    }
}
