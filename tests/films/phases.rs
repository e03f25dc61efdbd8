//! The phase between the two polarizations, which no image of unpolarized light shows.

use abbe::material::{Block, Incoming, Index, Layer, Mueller, PolarizedShare, Scatter, ScatterContext, Stack, reflect};
use abbe::math::Complex;
use abbe::spectrum::{Draw, Table};

use crate::support::materials::{context, direction_at, material};

/// Returns the light reflected at 550 nm by one clear layer on n - i k, at an angle in degrees.
fn reflected(index: f64, thickness_nm: f64, n2: [f64; 2], degrees: f64) -> PolarizedShare {
    let layer = Layer { index: index.into(), thickness_nm };
    let stack = Stack::new([550.0, 0.0], [layer].into_iter());
    stack.shares(1.0, Complex::new(n2[0], -n2[1]), degrees.to_radians().cos()).reflected
}

#[test]
fn p_is_the_negative_of_s_along_the_normal_and_turns_as_abeles_predicts() {
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

/// Lanes that share a direction are totally reflected where their common ray is, and where a lane has no refraction
/// angle of its own.
#[test]
fn total_reflection_of_lanes_that_go_together_keeps_all_polarization_under_a_film_as_without() {
    let materials = ["", ", coating = [{ index = 1.38, thickness_nm = 99.6 }]"]
        .map(|coating| material(&format!("dielectric = {{ index = 1.5{coating} }}")));
    let (draw, grazing) = (Draw::<4>::fixed(3), [0.001, 0.01, 0.05]);
    // Beyond the critical angle of the common ray only: the first lane alone would be partly transmitted.
    let critical = (1.0 - (1.485_f64 / 1.62).powi(2)).sqrt();
    for (inside, outside, cosines) in
        [([1.49, 1.5, 1.51], [1.0; 3], &grazing[..]), ([1.6, 1.62, 1.64], [1.5, 1.48, 1.46], &[critical])]
    {
        let (direction_indices, [incident, beyond]) =
            ([Some(inside[1]), Some(outside[1])], [inside, outside].map(Table::new));
        for &cos in cosines {
            let context = ScatterContext {
                from_inside: true,
                incident: Index::Own(&incident),
                beyond: Index::Own(&beyond),
                direction_indices,
                ..context(&draw, direction_at(cos, 0.4), 1.0)
            };
            let (wi, lanes) = (reflect(context.wo, context.normal), context.present.nonzero());
            let incoming = Incoming { wi, crosses: false, single: true, lanes };
            for material in &materials {
                let mut mueller = Mueller::NONE;
                material.mueller(&context, incoming, &mut mueller);
                let Block { a, d, c, q } = mueller.block;
                for lane in 0..3 {
                    let [a, d, c, q] = [a, d, c, q].map(|x| x[lane]);
                    assert!((a - 1.0).abs() < 1e-6 && d.abs() < 1e-6, "{a} {d} of lane {lane} at {cos}");
                    assert!((c.hypot(q) - 1.0).abs() < 1e-6, "{c} {q} of lane {lane} at {cos}");
                    // p is at most 12 degrees ahead of s: Born & Wolf 1999, section 1.5.4.
                    assert!(cosines.len() == 1 || c > 0.975, "{c} of lane {lane} at {cos}");
                }
            }
        }
    }
}
