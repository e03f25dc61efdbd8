//! Facets and the directions in which they reflect light.

use std::f64::consts::{PI, TAU};

use abbe::material::{Facets, RoughSurface, Roughness};
use abbe::math::{DVec3, sample_sphere};

use crate::support::chi_squared;
use crate::support::exact::Exact;
use crate::support::larger::larger;
use crate::support::materials::direction_about_z as at;
use crate::support::random::Random;

/// A grid of light directions. A direction is located by the facet that mirrors it, with the facet's slope s and
/// azimuth, where tan^2 = alpha^2 q / (1 - q) and 1 - q = (1 - s)^4. Densities over the unit square are bounded at
/// every roughness.
struct Grid {
    wo: DVec3,
    alpha: f64,
}

const CELLS: usize = 16;
const FINER: usize = 40;
const DRAWS: u64 = 400_000;

impl Grid {
    fn cell(&self, wi: DVec3) -> usize {
        let h = (self.wo + wi).normalize();
        let slope = (h.x * h.x + h.y * h.y) / (self.alpha * self.alpha * h.z * h.z);
        let s = 1.0 - 1.0 / (1.0 + slope).sqrt().sqrt();
        let around = libm::atan2(h.y, h.x) / TAU + 0.5;
        let place = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        place(s) * CELLS + place(around)
    }

    /// Returns the direction at a point of the unit square and the steradians per unit of area there, or none if the
    /// direction is below the surface.
    fn direction(&self, s: f64, around: f64) -> Option<(DVec3, f64)> {
        let left = libm::pow(1.0 - s, 4.0);
        let tan = self.alpha * ((1.0 - left) / left).sqrt();
        let cos = 1.0 / (1.0 + tan * tan).sqrt();
        let (y, x) = libm::sincos(TAU * (around - 0.5));
        let h = DVec3::new(x * tan * cos, y * tan * cos, cos);
        let toward = self.wo.dot(h);
        let wi = h * (2.0 * toward) - self.wo;
        let facets = 0.5 * cos * cos * cos * self.alpha * self.alpha / (left * left) * 4.0 * (left / (1.0 - s)) * TAU;
        (toward > 0.0 && wi.z > 0.0).then(|| (wi.normalize(), 4.0 * toward * facets))
    }

    /// Returns the probability of every cell, from the pdf.
    fn probabilities(&self, surface: &RoughSurface) -> Vec<f64> {
        let mut cells = vec![0.0; CELLS * CELLS];
        for row in 0..CELLS {
            // The last row holds nearly all light that is reflected more than once, with a sharp edge at the horizon.
            // Only a corner of the first row is visible from near the horizon.
            let up = if row == 0 || row == CELLS - 1 { 40 * FINER } else { FINER };
            for (i, j) in (0..up).flat_map(|i| (0..CELLS * FINER).map(move |j| (i, j))) {
                let s = (row as f64 + (i as f64 + 0.5) / up as f64) / CELLS as f64;
                // Rows are shifted relative to each other, so that edges are sampled everywhere.
                let around = (j as f64 + (i as f64 * 0.618_033_988_75).fract()) / (CELLS * FINER) as f64;
                if let Some((wi, steradians)) = self.direction(s, around) {
                    let pdf = surface.evaluate(self.wo, wi).map_or(0.0, |reflection| reflection.pdf);
                    cells[row * CELLS + j / FINER] += pdf * steradians / (CELLS * CELLS * up * FINER) as f64;
                }
            }
        }
        cells
    }
}

#[test]
fn directions_follow_their_density_and_the_rest_lies_below_the_surface() {
    let cases: Vec<[f64; 2]> =
        [0.05, 0.2, 0.5, 0.8, 1.0].iter().flat_map(|&r| [1.0, 0.6, 0.2, 0.02].map(|cos| [r, cos])).collect();
    for &[value, cos] in &cases {
        let roughness = Roughness::new(value);
        let surface = roughness.surface().expect("it is rough");
        let grid = Grid { wo: at(cos, 0.7), alpha: value * value };
        let mut probabilities = grid.probabilities(surface);
        let above: f64 = probabilities.iter().sum();
        assert!(above <= 1.0 + 2e-4, "roughness {value}, cos {cos}: the density sums to {above}");
        let mut counts = vec![0; CELLS * CELLS + 1];
        let mut random = Random::new((value * 1000.0 + cos * 1e6) as u64);
        for _ in 0..DRAWS {
            let cell = match surface.scatter(grid.wo, random.pair()) {
                None => CELLS * CELLS,
                Some(reflection) => {
                    assert!((reflection.wi.length() - 1.0).abs() < 1e-14 && reflection.wi.z > 0.0);
                    let again = surface.evaluate(grid.wo, reflection.wi).expect("it lies above").pdf;
                    assert!((again / reflection.pdf - 1.0).abs() < 1e-6, "{value}, {cos}: {reflection:?} for {again}");
                    grid.cell(reflection.wi)
                }
            };
            counts[cell] += 1;
        }
        probabilities.push((1.0 - above).max(0.0));
        chi_squared::check(&format!("roughness {value}, cos {cos}"), &counts, &probabilities, cases.len() as u32);
    }
}

#[test]
fn g4_the_density_of_nearly_even_facets_keeps_its_digits() {
    let exact = |alpha: f64, h: DVec3| {
        // Walter et al. 2007, equation 33, in cosines alone, of exactly the given vector.
        let [one, a2] = [Exact::from(1.0), Exact::from(alpha) * Exact::from(alpha)];
        let squares = [h.x, h.y, h.z].map(|x| Exact::from(x) * Exact::from(x));
        let c2 = squares[2] / (squares[0] + squares[1] + squares[2]);
        let term = c2 * (a2 - one) + one;
        (a2 / (Exact::from(PI) * term * term)).rounded()
    };
    let mut worst = 0f64;
    for alpha in [1e-4, 1e-3, 0.1, 1.0] {
        let facets = Facets::new(alpha);
        for step in 0..1000 {
            let tan = alpha * libm::exp(f64::from(step) * 0.02 - 10.0);
            let h = at(1.0 / (1.0 + tan * tan).sqrt(), f64::from(step));
            let sin = tan / (1.0 + tan * tan).sqrt();
            let (y, x) = libm::sincos(f64::from(step));
            let h = DVec3::new(sin * x, sin * y, h.z);
            worst = larger(worst, (facets.density(h) / exact(alpha, h) - 1.0).abs());
        }
    }
    println!("G4: relative error at most {worst:.1e}");
    assert!(worst <= 1e-5, "{worst:e}");
}

#[test]
fn g5_no_draw_is_not_a_number() {
    const LARGEST_BELOW_1: f64 = 1.0 - 1.0 / (1 << 24) as f64;
    for value in [0.01, 0.02, 0.1, 0.3, 0.6, 1.0] {
        let roughness = Roughness::new(value);
        let surface = roughness.surface().expect("it is rough");
        for cos in [0.0, 1e-300, 1e-20, 1e-8, 1e-3, 0.1, 0.5, 1.0f64.next_down(), 1.0] {
            let mut random = Random::new(5);
            let ends = [0.0, f64::MIN_POSITIVE, 0.5, LARGEST_BELOW_1];
            let corners = ends.iter().flat_map(|&a| ends.map(|b| [a, b])).collect::<Vec<_>>();
            let inside = (0..100_000).map(|i| match i % 20 {
                0 => [random.number(), LARGEST_BELOW_1],
                1 => [random.number(), 0.0],
                _ => random.pair(),
            });
            for u in corners.into_iter().chain(inside) {
                let wo = at(cos, 0.3);
                let Some(drawn) = surface.scatter(wo, u) else { continue };
                let numbers = [drawn.single, drawn.multiple, drawn.cos, drawn.pdf, drawn.wi.length()];
                assert!(numbers.iter().all(|x| x.is_finite() && *x >= 0.0), "{value}, {cos:e}, {u:?}: {drawn:?}");
                let weight = (drawn.single + drawn.multiple) / drawn.pdf;
                assert!(drawn.pdf > 0.0 && weight <= 2.5, "{value}, {cos:e}, {u:?}: {weight}, {drawn:?}");
            }
        }
    }
}

#[test]
fn light_goes_the_same_way_back() {
    let mut random = Random::new(9);
    for value in [0.02, 0.2, 0.5, 1.0] {
        let roughness = Roughness::new(value);
        let surface = roughness.surface().expect("it is rough");
        for _ in 0..10_000 {
            let [a, b] = [0; 2].map(|_| {
                let w = sample_sphere(random.pair());
                DVec3::new(w.x, w.y, w.z.abs())
            });
            let [there, back] = [(a, b), (b, a)].map(|(wo, wi)| {
                let reflection = surface.evaluate(wo, wi).expect("it lies above");
                [reflection.single, reflection.multiple].map(|x| x / wi.z)
            });
            for (x, y) in there.into_iter().zip(back) {
                assert!((x - y).abs() <= 1e-12 * x.max(y), "{value}: {a} {b}: {x} and {y}");
            }
        }
    }
}
