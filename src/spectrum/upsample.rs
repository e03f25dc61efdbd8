//! From three color numbers to a smooth spectrum within 0..1.

use std::collections::HashMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

use serde::{Deserialize, Serialize};

use super::color::{ColorSpace, Matrix, adaptation, apply, inverse, product};
use super::data;
use super::visible::{self, ULTRAVIOLET_COUNT};

/// A spectrum S(w) = 1/2 + x / (2 sqrt(1 + x^2)), x = (a t + b) t + c, where t runs from 0 at 360 to 1 at 830 nm.
///
/// Jakob & Hanika 2019, *A Low-Dimensional Function Space for Efficient Spectral Upsampling*, equations 4 and 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigmoid {
    coefficients: [f64; 3],
    /// Share of the color's distance from gray that was kept: 1 unless no smooth reflectance has the color.
    pub saturation: f64,
}

impl Sigmoid {
    /// Returns the value at a wavelength, within 0..1.
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        let t = (wavelength_nm - visible::FIRST_NM) / (visible::LAST_NM - visible::FIRST_NM);
        sigmoid((a * t + b) * t + c)
    }
}

fn sigmoid(x: f64) -> f64 {
    if x.is_infinite() { 0.5 + 0.5 * x.signum() } else { 0.5 + 0.5 * x / (1.0 + x * x).sqrt() }
}

/// A solver for the sigmoid spectra that look like linear Rec.709 colors under a film's white.
#[derive(Clone, Serialize, Deserialize)]
pub struct Upsampler {
    /// Rec.709 red, green and blue of a reflectance of 1 within one step of the visible range. Each channel sums to 1.
    steps: Vec<[f64; 3]>,
    /// A cache by the bits of the colors: a plan needs each color a dozen times, and a search takes 0.1 ms.
    #[serde(skip)]
    cache: Arc<Mutex<HashMap<[u64; 3], Sigmoid>>>,
}

// The cache is not part of an upsampler's value, by which plans are told apart.
impl fmt::Debug for Upsampler {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.debug_struct("Upsampler").field("steps", &self.steps).finish_non_exhaustive()
    }
}

impl PartialEq for Upsampler {
    fn eq(&self, other: &Self) -> bool {
        self.steps == other.steps
    }
}

/// Maximum number of colors in the cache. They take 8 MB.
const MAX_CACHED: usize = 1 << 16;

/// Largest residual of a fit that is accepted, in linear Rec.709.
const MAX_RESIDUAL: f64 = 1e-4;

impl Upsampler {
    /// Returns the upsampler of a film: a reflectance of 1 has the color (1, 1, 1) under its white. All upsamplers of
    /// one space share a cache.
    pub fn new(space: ColorSpace) -> Self {
        static UPSAMPLERS: [OnceLock<Upsampler>; ColorSpace::ALL.len()] =
            [const { OnceLock::new() }; ColorSpace::ALL.len()];
        UPSAMPLERS[space as usize].get_or_init(|| Self::build(space)).clone()
    }

    fn build(space: ColorSpace) -> Self {
        let (spectrum, correction) = visible::white(space);
        let adapted = adaptation(space.white(), ColorSpace::Rec709.white());
        let to_rec709 = product(&ColorSpace::Rec709.matrix_from_xyz(), &adapted);
        let steps = spectrum.iter().skip(ULTRAVIOLET_COUNT).zip(data::color_matching());
        let color = |(power, cmf): (&f64, &[f64; 3])| std::array::from_fn(|c| power * cmf[c] * correction[c]);
        Self { steps: steps.map(|step| apply(&to_rec709, color(step))).collect(), cache: Arc::default() }
    }

    fn found(&self) -> MutexGuard<'_, HashMap<[u64; 3], Sigmoid>> {
        self.cache.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the spectrum of a reflectance, for numbers within 0..1. A color that no sigmoid has is moved toward gray
    /// until one has it.
    pub fn fit(&self, rgb: [f64; 3]) -> Sigmoid {
        let gray = (rgb.iter().sum::<f64>() / 3.0).clamp(0.0, 1.0);
        if rgb.iter().all(|&x| x == gray) {
            return Sigmoid { coefficients: [0.0, 0.0, inverse_sigmoid(gray)], saturation: 1.0 };
        }
        let bits = rgb.map(f64::to_bits);
        if let Some(&known) = self.found().get(&bits) {
            return known;
        }
        // The cache is not locked here: others may search meanwhile, even for the same color.
        let sigmoid = self.search(rgb, gray);
        let mut found = self.found();
        if found.len() >= MAX_CACHED {
            found.clear();
        }
        found.insert(bits, sigmoid);
        sigmoid
    }

    /// Searches for the spectrum of a color that is not gray. `gray` is its mean.
    fn search(&self, rgb: [f64; 3], gray: f64) -> Sigmoid {
        let desaturated = |saturation: f64| rgb.map(|x| gray + saturation * (x - gray));
        let try_solve = |saturation: f64| {
            let (coefficients, residual) = self.solve(desaturated(saturation), gray);
            (residual < MAX_RESIDUAL).then_some(Sigmoid { coefficients, saturation })
        };
        if let Some(sigmoid) = try_solve(1.0) {
            return sigmoid;
        }
        let (mut low, mut high) = (0.0, 1.0);
        let mut best = Sigmoid { coefficients: [0.0, 0.0, inverse_sigmoid(gray)], saturation: 0.0 };
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            match try_solve(middle) {
                Some(sigmoid) => (best, low) = (sigmoid, middle),
                None => high = middle,
            }
        }
        best
    }

    /// Solves by damped Gauss-Newton (Levenberg 1944), from gray outward: saturated colors start near their solution.
    fn solve(&self, target: [f64; 3], gray: f64) -> ([f64; 3], f64) {
        let mut k = [0.0, 0.0, inverse_sigmoid(gray.clamp(0.002, 0.998))];
        let mut max_residual = f64::INFINITY;
        for part in [0.5, 0.9, 1.0] {
            let goal = target.map(|x| gray + part * (x - gray));
            let (mut residual, mut jacobian) = self.evaluate(k, goal);
            let mut error = squared(residual);
            let mut damping = 1e-3;
            for _ in 0..60 {
                if error < if part == 1.0 { 1e-20 } else { 1e-6 } {
                    break;
                }
                let step = gauss_newton_step(&jacobian, residual, damping);
                let next: [f64; 3] = std::array::from_fn(|i| k[i] - step[i]);
                let (next_residual, next_jacobian) = self.evaluate(next, goal);
                let next_error = squared(next_residual);
                if next_error < error {
                    (k, residual, jacobian, error) = (next, next_residual, next_jacobian, next_error);
                    damping *= 0.2;
                } else {
                    damping = (damping * 4.0).min(1e8);
                }
            }
            max_residual = residual.iter().fold(0.0, |max_residual: f64, r| max_residual.max(r.abs()));
        }
        (k, max_residual)
    }

    /// Returns the color minus the goal, and its derivatives by the coefficients.
    fn evaluate(&self, [a, b, c]: [f64; 3], goal: [f64; 3]) -> ([f64; 3], Matrix) {
        let (mut residual, mut jacobian) = (goal.map(|x| -x), [[0.0; 3]; 3]);
        for (i, step) in self.steps.iter().enumerate() {
            let t = i as f64 / (visible::LAST_NM - visible::FIRST_NM);
            let x = (a * t + b) * t + c;
            let q = 1.0 / (1.0 + x * x).sqrt();
            let (value, slope) = (0.5 + 0.5 * x * q, 0.5 * q * q * q);
            for channel in 0..3 {
                residual[channel] += step[channel] * value;
                let weight = step[channel] * slope;
                (0..3).for_each(|power| jacobian[channel][power] += weight * [t * t, t, 1.0][power]);
            }
        }
        (residual, jacobian)
    }
}

fn squared(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

/// Solves (J^T J + damping) s = J^T r for the step s.
fn gauss_newton_step(jacobian: &Matrix, residual: [f64; 3], damping: f64) -> [f64; 3] {
    let mut normal: Matrix =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|c| jacobian[c][i] * jacobian[c][j]).sum()));
    let right: [f64; 3] = std::array::from_fn(|i| (0..3).map(|c| jacobian[c][i] * residual[c]).sum());
    let trace: f64 = (0..3).map(|i| normal[i][i]).sum();
    (0..3).for_each(|i| normal[i][i] += damping * trace + 1e-14);
    apply(&inverse(&normal), right)
}

/// Returns the x at which the sigmoid has a value; infinite at 0 and 1.
fn inverse_sigmoid(value: f64) -> f64 {
    let y = 2.0 * value - 1.0;
    y / (1.0 - y * y).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_color_is_fitted_once_for_all_upsamplers_of_a_space() {
        let (space, rgb) = (ColorSpace::Aces2065, [0.9, 0.1, 0.02]);
        let found = Upsampler::new(space).fit(rgb);
        // A new search would not find this value.
        let planted = Sigmoid { saturation: 0.5 * found.saturation, ..found };
        Upsampler::new(space).found().insert(rgb.map(f64::to_bits), planted);
        assert_eq!(Upsampler::new(space).fit(rgb), planted);
        Upsampler::new(space).found().clear();
        assert_eq!(Upsampler::new(space).fit(rgb), found);
    }
}
