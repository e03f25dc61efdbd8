//! The shares of light by which paths leave a rough boundary: they sum to 1 and follow the BSDF.

use std::f64::consts::TAU;

use abbe::material::{RoughInterface, Sides};
use abbe::math::DVec3;

use crate::chi_squared;
use crate::support::random::Random;

const ROUGHNESSES: [f64; 5] = [0.02, 0.3, 0.77, 0.99, 1.0];
const INDICES: [f64; 6] = [1.001, 1.1, 1.5, 2.4, 4.0, 9.9];
const COSINES: [f64; 7] = [1e-12, 1e-3, 0.05, 0.3, 0.6, 0.9, 1.0];

/// A unit vector at a cosine to the normal.
fn at(cos: f64, azimuth: f64) -> DVec3 {
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (y, x) = libm::sincos(azimuth);
    DVec3::new(sin * x, sin * y, cos)
}

/// Each index from outside and from inside, at each roughness and angle.
fn each(check: impl Fn(&Sides, [f64; 2], DVec3, &str)) {
    for roughness in ROUGHNESSES {
        let interface = RoughInterface::new(roughness * roughness);
        for index in INDICES {
            for indices in [[1.0, index], [index, 1.0]] {
                let sides = interface.between(indices[0], indices[1]);
                for cos in COSINES {
                    let what = format!("{indices:?}, roughness {roughness}, cos {cos}");
                    check(&sides, indices, at(cos, 0.7), &what);
                }
            }
        }
    }
}

#[test]
fn the_ways_out_take_all_the_light_in_every_draw() {
    each(|sides, _, wo, what| {
        let mut random = Random::new(5);
        for _ in 0..2_000 {
            let ways = sides.draw(wo, random.pair());
            let sum: f64 = ways.iter().flatten().map(|way| way.share).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{what}: {sum} of {ways:?}");
            let [above, beyond, _] = ways;
            assert!(
                above.is_none_or(|way| way.wi.z > 0.0) && beyond.is_none_or(|way| way.wi.z < 0.0),
                "{what}: {ways:?}"
            );
            assert!(ways.iter().flatten().all(|way| way.share > 0.0), "{what}: {ways:?}");
        }
    });
}

/// The weight that one scattering had if it were what is evaluated over the density: nearly the share, for both are the
/// same function but for the noise of the lobe's table.
#[test]
fn what_is_drawn_is_worth_what_is_evaluated() {
    each(|sides, [n1, n2], wo, what| {
        let (mut random, mut sums) = (Random::new(6), [[0.0; 2]; 2]);
        const COUNT: u32 = 20_000;
        for _ in 0..COUNT {
            for way in sides.draw(wo, random.pair()).into_iter().flatten() {
                let (side, flow, square) = if way.wi.z > 0.0 {
                    (0, sides.reflected(wo, way.wi, way.facet), 1.0)
                } else {
                    (1, sides.crossed(wo, way.wi, way.facet), (n2 / n1) * (n2 / n1))
                };
                let off = way.often * flow.value * square / flow.pdf - way.share;
                sums[side][0] += off;
                sums[side][1] += off * off;
            }
        }
        for [sum, squares] in sums {
            let (mean, error) = (sum / f64::from(COUNT), squares.sqrt() / f64::from(COUNT));
            // What the tables of blocked light are good to: see `sides`.
            assert!(mean.abs() < 2e-3 + 5.0 * error, "{what}: {mean} +- {error}");
        }
    });
}

/// Cells by height and by azimuth on each side, and places along each side of one.
const CELLS: usize = 12;
const FINER: usize = 64;

fn cell(wi: DVec3) -> usize {
    let (up, around) = (wi.z.abs(), libm::atan2(wi.y, wi.x) / TAU + 0.5);
    let place = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
    let side = if wi.z > 0.0 { 0 } else { CELLS * CELLS };
    side + place(up) * CELLS + place(around)
}

/// The light of every cell, by quadrature of the BSDF times cosine; radiance over n^2.
fn light(sides: &Sides, [n1, n2]: [f64; 2], wo: DVec3) -> Vec<f64> {
    let (mut cells, finer) = (vec![0.0; 2 * CELLS * CELLS], CELLS * FINER);
    for (i, j) in (0..finer).flat_map(|i| (0..finer).map(move |j| (i, j))) {
        let around = (j as f64 + (i as f64 * 0.618_033_988_75).fract()) / finer as f64;
        let above = at((i as f64 + 0.5) / finer as f64, TAU * (around - 0.5));
        let beyond = DVec3 { z: -above.z, ..above };
        let crossed = sides.crossed(wo, beyond, None).value * (n2 / n1) * (n2 / n1);
        let place = i / FINER * CELLS + j / FINER;
        for (side, value) in [sides.reflected(wo, above, None).value, crossed].into_iter().enumerate() {
            cells[side * CELLS * CELLS + place] += value * TAU / (finer * finer) as f64;
        }
    }
    cells
}

#[test]
fn paths_that_take_a_way_by_its_share_follow_the_bsdf_on_both_sides() {
    const COUNT: u32 = 200_000;
    let cases = [
        ([1.0, 1.5], 0.4, 0.5),
        ([1.5, 1.0], 0.7, 0.8),
        ([1.5, 1.0], 1.0, 0.1),
        ([1.0, 2.4], 0.99, 0.95),
        ([2.4, 1.0], 0.99, 0.6),
        ([4.0, 1.0], 0.77, 0.3),
        ([9.9, 1.0], 0.77, 0.7),
        ([9.9, 1.0], 0.99, 0.2),
        ([1.0, 9.9], 0.77, 0.05),
    ];
    for (indices, roughness, cos) in cases {
        let interface = RoughInterface::new(roughness * roughness);
        let sides = interface.between(indices[0], indices[1]);
        let wo = at(cos, 0.7);
        let what = format!("{indices:?}, roughness {roughness}, cos {cos}");
        let mut random = Random::new((roughness * 1000.0 + cos * 1e6 + indices[0] * 1e7) as u64);
        let mut counts = vec![0; 2 * CELLS * CELLS];
        for _ in 0..COUNT {
            let (ways, mut at) = (sides.draw(wo, random.pair()), random.number());
            let taken = ways.into_iter().flatten().find(|way| {
                at -= way.share;
                at < 0.0
            });
            let last = ways.into_iter().flatten().next_back();
            counts[cell(taken.or(last).expect("light goes on").wi)] += 1;
        }
        let mut cells = light(&sides, indices, wo);
        let all: f64 = cells.iter().sum();
        println!("{what}: the BSDF sums to {all:.5}");
        assert!((all - 1.0).abs() < 2e-3, "{what}: the BSDF sums to {all}");
        cells.iter_mut().for_each(|cell| *cell /= all);
        chi_squared::check(&what, &counts, &cells, cases.len() as u32);
    }
}
