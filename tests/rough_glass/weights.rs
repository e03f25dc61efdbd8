//! The weights of paths at a rough boundary hardly vary, and the directions of the paths follow the BSDF.

use std::f64::consts::TAU;

use abbe::material::{BsdfValue, FacetSample, FacetSides, RoughInterface};
use abbe::math::DVec3;

use crate::support::chi_squared;
use crate::support::materials::direction_about_z as at;
use crate::support::random::Random;

const ROUGHNESSES: [f64; 5] = [0.02, 0.3, 0.77, 0.99, 1.0];
const INDICES: [f64; 6] = [1.001, 1.1, 1.5, 2.4, 4.0, 9.9];
const COSINES: [f64; 7] = [1e-12, 1e-3, 0.05, 0.3, 0.6, 0.9, 1.0];

/// Calls `check` with all of these, seen from a direction.
fn for_each_boundary(check: impl Fn(&FacetSides, [f64; 2], DVec3, &str)) {
    super::for_each_boundary(&ROUGHNESSES, &INDICES, &COSINES, |sides, indices, cos, what| {
        check(sides, indices, at(cos, 0.7), what)
    });
}

/// Returns the weights of both sides of a draw: the BSDF value over its pdf, as radiance over n^2.
fn weights(sides: &FacetSides, [n1, n2]: [f64; 2], wo: DVec3, ways: [Option<FacetSample>; 2]) -> [f64; 2] {
    let weight_of = |flow: BsdfValue| flow.value / flow.pdf;
    let [above, beyond] = ways;
    [
        above.map_or(0.0, |way| weight_of(sides.reflected(wo, way.wi, way.facet))),
        beyond.map_or(0.0, |way| weight_of(sides.crossed(wo, way.wi, way.facet)) * (n2 / n1) * (n2 / n1)),
    ]
}

/// The product of the weights of some 1.7 n^2 surfaces has a long tail unless they hardly vary inside dense glass.
#[test]
fn no_draw_is_lost_no_way_weighs_more_than_1_and_dense_glass_sends_on_what_it_gets() {
    for_each_boundary(|sides, indices @ [n1, n2], wo, what| {
        const COUNT: u32 = 20_000;
        let (mut random, mut sum, mut squares) = (Random::new(5), 0.0, 0.0);
        for _ in 0..COUNT {
            let weights = weights(sides, indices, wo, sides.draw(wo, random.pair()));
            let all = weights[0] + weights[1];
            // The lobe is drawn from a table of its own, which is linear between its entries.
            assert!(weights.iter().all(|weight| (0.0..1.1).contains(weight)) && all > 0.0, "{what}: {weights:?}");
            sum += all;
            squares += (all - 1.0) * (all - 1.0);
        }
        let (mean, spread) = (sum / f64::from(COUNT), (squares / f64::from(COUNT)).sqrt());
        let error = spread / f64::from(COUNT).sqrt();
        println!("{what}: {mean:.5} +- {error:.1e}, spread {spread:.4}");
        assert!((mean - 1.0).abs() < 2e-3 + 5.0 * error, "{what}: {mean} +- {error}");
        // A body of index n holds light for some 1.7 n^2 surfaces: the spread of the product is below 1.
        if n1 > 2.0 {
            assert!(1.7 * (n1 / n2) * (n1 / n2) * spread * spread < 1.0, "{what}: spread {spread}");
        }
    });
}

/// Number of cells by height and by azimuth on each side, and of points along each side of a cell.
const CELLS: usize = 12;
const FINER: usize = 64;

fn cell(wi: DVec3) -> usize {
    let (up, around) = (wi.z.abs(), libm::atan2(wi.y, wi.x) / TAU + 0.5);
    let place = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
    let side = if wi.z > 0.0 { 0 } else { CELLS * CELLS };
    side + place(up) * CELLS + place(around)
}

/// Returns the light of every cell as radiance over n^2, by quadrature of the BSDF times the cosine.
fn light(sides: &FacetSides, [n1, n2]: [f64; 2], wo: DVec3) -> Vec<f64> {
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
fn ways_that_are_kept_by_their_weights_follow_the_bsdf_on_both_sides() {
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
            // Each direction is kept with a probability equal to its weight.
            let ways = sides.draw(wo, random.pair());
            for (way, weight) in ways.into_iter().zip(weights(&sides, indices, wo, ways)) {
                if let Some(way) = way.filter(|_| random.number() < weight) {
                    counts[cell(way.wi)] += 1;
                }
            }
        }
        let mut cells = light(&sides, indices, wo);
        let all: f64 = cells.iter().sum();
        println!("{what}: the BSDF sums to {all:.5}");
        assert!((all - 1.0).abs() < 1e-3, "{what}: the BSDF sums to {all}");
        cells.iter_mut().for_each(|cell| *cell /= all);
        chi_squared::check(&what, &counts, &cells, cases.len() as u32);
    }
}
