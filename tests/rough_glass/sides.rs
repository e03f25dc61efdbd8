//! The boundary of two media: furnaces of its BSDF, directions compared with their pdf, and reciprocity.

use std::f64::consts::TAU;

use abbe::material::{FacetSides, RoughInterface};
use abbe::math::DVec3;

use super::for_each_boundary;
use crate::support::chi_squared;
use crate::support::materials::{direction_about_z as at, hammersley_points};
use crate::support::random::Random;

const ROUGHNESSES: [f64; 4] = [0.02, 0.3, 0.8, 1.0];
const COSINES: [f64; 5] = [1e-6, 0.001, 0.05, 0.3, 1.0];
/// Indices from outside and from inside, close to each other and far apart. `tests/white_furnace.rs` has others.
const INDICES: [f64; 3] = [1.001, 1.05, 2.2];
/// With 2^14 draws, furnaces of nearly equal indices at grazing angles are off by 1 %.
const DRAWS: u32 = 1 << 17;

/// Returns the reflected and the transmitted light in a uniform environment, where radiance over n^2 is 1 everywhere.
fn furnace(sides: &FacetSides, [n1, n2]: [f64; 2], cos: f64) -> [f64; 2] {
    let (wo, mut sum) = (at(cos, 0.3), [0.0; 2]);
    for u in hammersley_points(DRAWS) {
        let [reflected, crossed] = sides.draw(wo, u);
        let reflected = reflected.map(|way| sides.reflected(wo, way.wi, way.facet));
        let crossed = crossed.map(|way| sides.crossed(wo, way.wi, way.facet));
        for ((sum, flow), square) in sum.iter_mut().zip([reflected, crossed]).zip([1.0, n2 * n2 / (n1 * n1)]) {
            *sum += flow.map_or(0.0, |flow| flow.value / flow.pdf * square / f64::from(DRAWS));
        }
    }
    sum
}

#[test]
fn a_lossless_boundary_sends_on_all_light_at_every_roughness_ratio_and_angle() {
    let mut worst = [1.0f64, 1.0];
    for_each_boundary(&ROUGHNESSES, &INDICES, &COSINES, |sides, indices, cos, what| {
        let [reflected, crossed] = furnace(sides, indices, cos);
        let all = reflected + crossed;
        assert!((0.998..=1.001).contains(&all), "{what}: {reflected} + {crossed} = {all}");
        worst = [worst[0].min(all), worst[1].max(all)];
    });
    println!("furnaces of the BSDF: {worst:.5?}");
}

#[test]
fn the_closer_two_indices_the_less_a_rough_boundary_turns_any_light() {
    for roughness in [0.3, 1.0] {
        let interface = RoughInterface::new(roughness * roughness);
        for step in [1e-2, 1e-3, 1e-4] {
            for indices in [[1.5, 1.5 + step], [1.5 + step, 1.5]] {
                let sides = interface.between(indices[0], indices[1]);
                let square = (indices[1] / indices[0]) * (indices[1] / indices[0]);
                for cos in [0.2, 0.5, 1.0] {
                    let wo = at(cos, 0.3);
                    let mut kept = 0.0;
                    for u in hammersley_points(1 << 14) {
                        if let [_, Some(way)] = sides.draw(wo, u)
                            && (wo + way.wi).length() < step.sqrt()
                        {
                            let flow = sides.crossed(wo, way.wi, way.facet);
                            kept += flow.value / flow.pdf * square / f64::from(1 << 14);
                        }
                    }
                    // Facets reflect all light below a cosine of sqrt(2 step / n), and deflect it by more than that a
                    // little above.
                    let what = format!("roughness {roughness}, {indices:?}, cos {cos}");
                    println!("{what}: {kept:.5} goes nearly straight on");
                    assert!(kept > 1.0 - step.sqrt(), "{what}: only {kept} goes nearly straight on");
                }
            }
        }
    }
}

#[test]
fn what_facets_refract_once_is_what_mitsuba_refracts() {
    // The indices, alpha, the viewer's cosine at the azimuth 0.3, the direction below the surface, and the BSDF times
    // cosine that `roughdielectric` of Mitsuba 3.9.1 has there: GGX with separate masking on each side, in f32.
    let rows = [
        ([1.0, 1.5], 0.1, 0.8, [-0.351531973, -0.118821055], 28.6894),
        ([1.0, 1.5], 0.1, 0.2, [-0.559467540, -0.208458706], 1.57772),
        ([1.5, 1.0], 0.1, 0.8, [-0.895268516, -0.254047558], 18.5557),
        ([1.5, 1.0], 0.1, 0.2, [-0.629682660, -0.747473661], 0.00957135),
        ([1.0, 1.1], 0.1, 0.8, [-0.512082836, -0.161331022], 573.594),
        ([1.1, 1.0], 0.1, 0.8, [-0.678723392, -0.193613442], 6.75358),
        ([1.0, 1.5], 0.7, 0.8, [-0.292957042, -0.147944487], 0.936854),
        ([1.0, 1.5], 0.7, 0.2, [-0.657888682, -0.326477929], 0.314159),
        ([1.5, 1.0], 0.7, 0.8, [-0.837814358, -0.034982887], 0.979944),
        ([1.5, 1.0], 0.7, 0.2, [-0.988028272, -0.004622800], 0.454703),
        ([1.0, 1.1], 0.7, 0.2, [-0.788993366, -0.506995265], 0.140634),
        ([1.1, 1.0], 0.7, 0.2, [-0.980924027, -0.187857316], 0.445115),
    ];
    for (indices, alpha, cos, [x, y], expected) in rows {
        let interface = RoughInterface::new(alpha);
        let mut once = interface.between(indices[0], indices[1]);
        (once.crossing, once.straight) = ([0.0; 2], 0.0);
        let value = once.crossed(at(cos, 0.3), DVec3::new(x, y, -(1.0 - x * x - y * y).sqrt()), None).value;
        assert!((value / expected - 1.0).abs() < 3e-5, "{indices:?}, alpha {alpha}, cos {cos}: {value} for {expected}");
    }
}

#[test]
fn light_goes_the_same_way_back_through_and_off_a_rough_boundary() {
    let mut random = Random::new(9);
    for roughness in [0.2, 1.0] {
        let interface = RoughInterface::new(roughness * roughness);
        for [n1, n2] in [[1.0, 1.5], [1.33, 1.2], [2.4, 1.0]] {
            let (there, back) = (interface.between(n1, n2), interface.between(n2, n1));
            for _ in 0..5_000 {
                let [a, b] = [0; 2].map(|_| random.direction()).map(|w| DVec3 { z: w.z.abs(), ..w });
                let [x, y] = [(a, b), (b, a)].map(|(wo, wi)| there.reflected(wo, wi, None).value / wi.z);
                assert!((x - y).abs() <= 1e-10 * x.max(y), "{roughness}: {a} {b}: {x} and {y}");
                // On the other side, the axis points down. Both directions are seen from above there, turned about x.
                let turn = |w: DVec3| DVec3::new(w.x, -w.y, -w.z);
                // Veach 1997, section 5.2: f / n^2, with n of the side that light goes to, is the same in both
                // directions.
                let x = there.crossed(a, -b, None).value / b.z / (n1 * n1);
                let y = back.crossed(turn(-b), turn(a), None).value / a.z / (n2 * n2);
                assert!((x - y).abs() <= 1e-9 * x.max(y) + 1e-300, "{roughness}, {n1} {n2}: {a} {b}: {x} and {y}");
            }
        }
    }
}

/// Number of cells by height and by azimuth, and of points along each side of a cell.
const CELLS: usize = 12;
const FINER: usize = 64;

/// Returns the cell of a direction on its hemisphere. All cells have the same solid angle.
fn cell(wi: DVec3) -> usize {
    let (up, around) = (wi.z.abs(), libm::atan2(wi.y, wi.x) / TAU + 0.5);
    let place = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
    place(up) * CELLS + place(around)
}

#[test]
fn directions_on_both_sides_follow_their_density_and_the_rest_leads_nowhere() {
    const COUNT: u64 = 200_000;
    // Each roughness occurs with each cosine, and each of these values with all indices.
    let cases = [
        ([1.0, 1.5], [(0.4, 0.95), (0.7, 0.5), (1.0, 0.1)]),
        ([1.5, 1.0], [(0.4, 0.5), (0.7, 0.1), (1.0, 0.95)]),
        ([1.33, 2.4], [(0.4, 0.1), (0.7, 0.95), (1.0, 0.5)]),
    ];
    let cases: Vec<_> = cases.iter().flat_map(|&(n, cases)| cases.map(|(r, cos)| (n, r, cos))).collect();
    for &(indices, roughness, cos) in &cases {
        let interface = RoughInterface::new(roughness * roughness);
        let sides = interface.between(indices[0], indices[1]);
        let wo = at(cos, 0.7);
        let what = format!("{indices:?}, roughness {roughness}, cos {cos}");
        let mut random = Random::new((roughness * 1000.0 + cos * 1e6 + indices[0] * 1e7) as u64);
        let mut counts = [0, 1].map(|_| vec![0; CELLS * CELLS + 1]);
        for _ in 0..COUNT {
            for (counts, way) in counts.iter_mut().zip(sides.draw(wo, random.pair())) {
                counts[way.map_or(CELLS * CELLS, |way| cell(way.wi))] += 1;
            }
        }
        for (side, counts) in counts.iter().enumerate() {
            let mut cells = vec![0.0; CELLS * CELLS];
            let finer = CELLS * FINER;
            for (i, j) in (0..finer).flat_map(|i| (0..finer).map(move |j| (i, j))) {
                let up = (i as f64 + 0.5) / finer as f64;
                let around = (j as f64 + (i as f64 * 0.618_033_988_75).fract()) / finer as f64;
                let wi = at(up, TAU * (around - 0.5));
                let pdf = match side {
                    0 => sides.reflected(wo, wi, None).pdf,
                    _ => sides.crossed(wo, DVec3 { z: -wi.z, ..wi }, None).pdf,
                };
                cells[i / FINER * CELLS + j / FINER] += pdf * TAU / (finer * finer) as f64;
            }
            let inside: f64 = cells.iter().sum();
            assert!(inside <= 1.0 + 1e-3, "{what}: the density sums to {inside}");
            let drawn = 1.0 - counts[CELLS * CELLS] as f64 / COUNT as f64;
            assert!(
                (inside - drawn).abs() < 1e-3 + 4.0 * (0.25 / COUNT as f64).sqrt(),
                "{what}: {inside}, drawn {drawn}"
            );
            // Draws that lead nowhere are judged above. At the edge of the directions that facets reach, the sums are
            // accurate to 5e-4.
            cells.iter_mut().for_each(|cell| *cell /= inside);
            let name = format!("{what}, side {side}");
            chi_squared::check(&name, &counts[..CELLS * CELLS], &cells, 2 * cases.len() as u32);
        }
    }
}

#[test]
fn no_draw_is_not_a_number_along_the_surface_and_between_nearly_equal_indices() {
    const LARGEST_BELOW_1: f64 = 1.0 - 1.0 / (1 << 24) as f64;
    let ends = [0.0, f64::MIN_POSITIVE, 0.25, 0.5, LARGEST_BELOW_1];
    for roughness in [0.01, 1.0] {
        let interface = RoughInterface::new(roughness * roughness);
        for [n1, n2] in [[1.0, 1.0f64.next_up()], [1.5, 1.5 + 1e-9], [1.0, 10.0], [10.0, 1.0], [1.5, 1.33]] {
            let sides = interface.between(n1, n2);
            let mut random = Random::new(3);
            for cos in [0.0, 1e-300, 1e-20, 1e-8, 1e-3, 0.1, 0.5, 1.0f64.next_down(), 1.0] {
                let wo = at(cos, 0.3);
                let corners = ends.iter().flat_map(|&a| ends.map(|b| [a, b])).collect::<Vec<_>>();
                for u in corners.into_iter().chain((0..1_000).map(|_| random.pair())) {
                    let [reflected, crossed] = sides.draw(wo, u);
                    let flows = [
                        reflected.map(|way| sides.reflected(wo, way.wi, way.facet)),
                        crossed.map(|way| sides.crossed(wo, way.wi, way.facet)),
                    ];
                    for flow in flows.into_iter().flatten() {
                        let weight = flow.value / flow.pdf * (n2 / n1).powi(2).min(1.0);
                        let what = format!("roughness {roughness}, {n1} {n2}, cos {cos:e}, {u:?}: {flow:?}");
                        assert!(flow.value.is_finite() && flow.pdf > 0.0 && flow.pdf.is_finite(), "{what}");
                        assert!((0.0..=5.0).contains(&weight), "{what}: {weight}");
                    }
                }
            }
        }
    }
}
