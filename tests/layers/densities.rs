//! Sampled directions are compared with their stated pdf.

use std::f64::consts::TAU;

use abbe::material::{Lobes, Material, Scatter, ScatterContext};
use abbe::math::Frame;
use abbe::spectrum::{Draw, Table};

use crate::support::chi_squared;
use crate::support::materials::{NORMAL, context, direction_at, material};
use crate::support::random::Random;

const TEXTS: [&str; 6] = [
    "plastic = { reflectance = 0.6 }",
    "plastic = { reflectance = 0.6, roughness = 0.4 }",
    "plastic = { reflectance = { rgb = [0.9, 0.1, 0.5] }, index = { rgb = [1.1, 1.5, 2.5] }, roughness = 0.7 }",
    "plastic = { reflectance = 0, roughness = 1 }",
    "mix = { materials = [\"rough\", \"silver\"], amount = { rgb = [0.1, 0.5, 0.6] } }",
    "mask = { material = \"rough\", opacity = 0.3 }",
];
/// Materials that combine a narrow lobe with another one.
const NARROW_MIXES: [&str; 3] = [
    "plastic = { reflectance = { rgb = [0.9, 0.1, 0.5] }, roughness = 0.31 }",
    "mix = { materials = [\"satin\", \"white\"], amount = { rgb = [0.1, 0.5, 0.6] } }",
    "mask = { material = \"satin\", opacity = 0.3 }",
];
const VIEWS: [f64; 3] = [0.95, 0.5, 0.1];
const CELLS: [usize; 2] = [12, 16];
/// Refinement of the grid on which the pdf is summed. It is finer for narrow lobes alone.
const FINER: [usize; 2] = [24, 60];
const DRAWS: u64 = 100_000;

/// Returns the probability of every cell of cosine and azimuth, from the pdf.
fn probabilities(material: &Material<Table>, context: &ScatterContext<4>) -> Vec<f64> {
    let finer = FINER[usize::from(context.lobes == Lobes::NARROW_REFLECTION)];
    let [up, around] = CELLS.map(|cells| cells * finer);
    let mut cells = vec![0.0; CELLS[0] * CELLS[1]];
    for (i, j) in (0..up).flat_map(|i| (0..around).map(move |j| (i, j))) {
        let (z, azimuth) = ((i as f64 + 0.5) / up as f64, TAU * (j as f64 + 0.5) / around as f64);
        let pdf = material.evaluate(context, direction_at(z, azimuth)).map_or(0.0, |(_, pdf)| pdf);
        cells[i / finer * CELLS[1] + j / finer] += pdf * TAU / (up * around) as f64;
    }
    cells
}

#[test]
fn directions_follow_their_density_and_bring_what_is_sent_along_them() {
    let frame = Frame::about(NORMAL);
    let whole_cases = TEXTS.map(|text| (text, Lobes::ALL));
    let parts = [Lobes::DIFFUSE_REFLECTION, Lobes::NARROW_REFLECTION];
    let part_cases = NARROW_MIXES.into_iter().flat_map(|text| parts.map(|lobes| (text, lobes)));
    let cases: Vec<_> = whole_cases.into_iter().chain(part_cases).collect();
    for (number, &(text, lobes)) in cases.iter().enumerate() {
        let material = material(text);
        for cos in VIEWS {
            let draw = Draw::<4>::fixed(3);
            let context = ScatterContext { lobes, ..context(&draw, direction_at(cos, 0.0), 1.0) };
            let (mut random, mut counts, mut missed) = (Random::new(number as u64), vec![0; CELLS[0] * CELLS[1]], 0);
            let mut branches = Vec::new();
            for _ in 0..DRAWS {
                material.scatter(&context, [random.number(), random.number()], &mut branches);
                let wide: Vec<_> = branches.drain(..).filter(|branch| branch.pdf.is_some()).collect();
                assert!(wide.len() <= 1, "{text}: one direction for all that scatters widely");
                let Some(branch) = wide.first() else {
                    missed += 1;
                    continue;
                };
                let local = frame.to_local(branch.wi);
                let azimuth = (libm::atan2(local.y, local.x) / TAU).rem_euclid(1.0);
                let place = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
                counts[place(local.z, CELLS[0]) * CELLS[1] + place(azimuth, CELLS[1])] += 1;
                let (light, pdf) = material.evaluate(&context, branch.wi).expect("it was drawn");
                let drawn = branch.pdf.expect("it is wide");
                // Near a mirror direction, the pdf keeps the digits of the direction, less those lost to the narrow
                // facet distribution.
                assert!((pdf / drawn - 1.0).abs() < 1e-6, "{text}: {pdf}, {drawn}");
                for lane in 0..3 {
                    let [one, other] = [f64::from(branch.share[lane]) * drawn, f64::from(light[lane])];
                    assert!((one - other).abs() <= 3e-6 * (one + other), "{text}: {one}, {other}");
                }
            }
            // The last cell holds what lies below the surface.
            let mut expected = probabilities(&material, &context);
            let sum: f64 = expected.iter().sum();
            assert!(sum < 1.0 + 1e-3, "{text}, cos {cos}: the density sums to {sum}");
            if missed == 0 {
                assert!((sum - 1.0).abs() < 1e-3, "{text}, cos {cos}: the density sums to {sum}");
            }
            expected.push((1.0 - sum).max(0.0));
            counts.push(missed);
            let tests = (cases.len() * VIEWS.len()) as u32;
            chi_squared::check(&format!("{text}, cos {cos}"), &counts, &expected, tests);
        }
    }
}

/// Lobes that are evaluated one by one add up to what all of them scatter.
#[test]
fn lobes_told_apart_make_up_the_whole() {
    let draw = Draw::<4>::fixed(3);
    for text in NARROW_MIXES {
        let material = material(text);
        assert!(material.lobes().has_narrow_apart(), "{text}");
        for (cos, z, azimuth) in [(0.95, 0.9, 0.5), (0.5, 0.55, 0.51), (0.1, 0.2, 0.4), (0.7, 0.3, 0.0)] {
            let evaluate_lobes = |lobes: Lobes| {
                let context = ScatterContext { lobes, ..context(&draw, direction_at(cos, 0.0), 1.0) };
                material.evaluate(&context, direction_at(z, TAU * azimuth)).expect("both are above the surface").0
            };
            let [all, base, narrow] =
                [Lobes::ALL, Lobes::DIFFUSE_REFLECTION, Lobes::NARROW_REFLECTION].map(evaluate_lobes);
            for lane in 0..3 {
                let sum = base[lane] + narrow[lane];
                assert!((sum / all[lane] - 1.0).abs() < 1e-6, "{text}: {sum} for {}", all[lane]);
                assert!(base[lane] > 0.0 && narrow[lane] > 0.0, "{text}");
            }
        }
    }
}
