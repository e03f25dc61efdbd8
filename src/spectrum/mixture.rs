//! The wavelengths that matter, from which heroes are drawn.

use serde::{Deserialize, Serialize};

use super::draw::Hero;
use super::visible::{self, COUNT, ULTRAVIOLET_COUNT};
use super::{Emission, Excited, WavelengthBands};
use crate::math::Distribution;

/// A distribution of wavelengths: a density that is constant over each nm, and ideal lines with a probability each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Mixture {
    /// Each step of the visible grid, then each line.
    entries: Distribution,
    /// The ideal lines in nm, as they follow the visible grid on the fine grid of every table.
    pub(super) lines: Vec<f64>,
}

/// Share of wavelengths drawn by what lights emit. The others are drawn by what the eye sees of a flat spectrum.
const LIGHT_SHARE: f64 = 0.9;

impl Mixture {
    /// Mixes nine tenths of light times color matching functions, with an equal share for each different light, and one
    /// tenth of color matching functions alone. If all light is in ideal lines, only these are drawn.
    pub(super) fn new(lights: &[Emission]) -> Self {
        let mut lines: Vec<f64> = lights.iter().flat_map(|light| light.lines()).map(|line| line[0]).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        let steps = COUNT - 1;
        let mut probabilities = vec![0.0; steps + lines.len()];
        let mut add = |share: f64, density: &[f64], line: &dyn Fn(f64) -> f64| {
            let mut part = visible_steps(density);
            part.extend(lines.iter().map(|&nm| line(nm)));
            let total: f64 = part.iter().sum();
            if total > 0.0 {
                probabilities.iter_mut().zip(part).for_each(|(sum, x)| *sum += share * x / total);
            }
        };
        let mut has_spectrum = lights.is_empty();
        for light in lights {
            let density = seen_spectrum(light);
            has_spectrum |= density.iter().any(|&x| x > 0.0);
            add(LIGHT_SHARE / lights.len() as f64, &density, &|nm| {
                let here = light.lines().iter().filter(|line| line[0] == nm);
                here.map(|line| line[1] * visible::color_matching(nm).iter().sum::<f64>()).sum()
            });
        }
        if has_spectrum {
            add(1.0 - LIGHT_SHARE, &eye_sensitivity().collect::<Vec<_>>(), &|_| 0.0);
        }
        Self { entries: Distribution::new(probabilities), lines }
    }

    /// Draws a third of the wavelengths evenly where lights shine within the bands of a spectral image, because the eye
    /// sees hardly anything at both ends, and the others as before. If all light is in ideal lines, only these are
    /// drawn.
    pub(super) fn spread_over_bands(&self, bands: &WavelengthBands, lights: &[Emission]) -> Self {
        let is_lit = |step: usize| lights.iter().any(|light| light.spectrum()[step..step + 2].iter().any(|&x| x > 0.0));
        let is_shown = |step: usize| bands.band_at(visible::START_NM + step as f64 + 0.5).is_some();
        let shown: Vec<usize> = (0..COUNT - 1).filter(|&step| is_shown(step) && is_lit(step)).collect();
        let mut weights: Vec<f64> = self.probabilities().collect();
        shown.iter().for_each(|&step| weights[step] += 0.5 / shown.len() as f64);
        Self { entries: Distribution::new(weights), lines: self.lines.clone() }
    }

    /// Draws two fifths of the wavelengths as before, two fifths by what excites dyes, and the others by what the eye
    /// sees of the dyes' emission. Under lines alone, nothing else would be drawn where dyes emit.
    pub(super) fn for_dyes(&self, excitations: &[Excited], shining: &[Emission]) -> Self {
        let mut weights: Vec<f64> = self.probabilities().collect();
        let mut add = |part: Vec<f64>, share: f64, of: usize| {
            let scale = share / (part.iter().sum::<f64>() * of as f64);
            if scale.is_finite() {
                weights.iter_mut().zip(part).for_each(|(weight, x)| *weight += scale * x);
            }
        };
        shining.iter().for_each(|dye| add(visible_steps(&seen_spectrum(dye)), 0.5, shining.len()));
        for excited in excitations {
            let mut part = steps(&excited.smooth);
            part.extend(self.lines.iter().map(|&nm| excited.by_line(nm)));
            add(part, 1.0, excitations.len());
        }
        Self { entries: Distribution::new(weights), lines: self.lines.clone() }
    }

    /// Returns the density of pbrt-v4, sech^2(0.0072 (w - 538)) (Radziszewski, Boryczko & Alda 2009, *An Improved
    /// Technique for Full Spectral Rendering*).
    pub(super) fn visible() -> Self {
        let density = |nm: f64| match nm {
            nm if nm < visible::FIRST_NM => 0.0,
            _ => libm::pow(libm::cosh(0.0072 * (nm + 0.5 - 538.0)), -2.0),
        };
        let entries = Distribution::new(visible::wavelengths().take(COUNT - 1).map(density));
        Self { entries, lines: Vec::new() }
    }

    /// Returns the probability of each step of the visible grid, then of each line.
    pub(super) fn probabilities(&self) -> impl Iterator<Item = f64> {
        (0..self.entries.count()).map(|entry| self.entries.probability(entry))
    }

    /// Returns the wavelength for a random number, as one of `heroes`.
    pub(super) fn draw(&self, u: f64, heroes: usize) -> Hero {
        let drawn = self.entries.sample(u);
        let factor = 1.0 / (heroes as f64 * drawn.probability);
        if drawn.index < COUNT - 1 {
            Hero { below: drawn.index, fraction: drawn.u, factor }
        } else {
            // Lines follow the last wavelength of the grid.
            Hero { below: drawn.index + 1, fraction: 0.0, factor }
        }
    }
}

/// Returns what the eye sees of a flat spectrum at each wavelength of the grid.
fn eye_sensitivity() -> impl Iterator<Item = f64> {
    visible::observer().map(|cmf| cmf.iter().sum())
}

/// Returns what the eye sees of a light at each wavelength of the grid.
fn seen_spectrum(light: &Emission) -> Vec<f64> {
    light.spectrum().iter().zip(eye_sensitivity()).map(|(power, eye_sensitivity)| power * eye_sensitivity).collect()
}

/// Returns the means of a density over the steps between its wavelengths.
fn steps(density: &[f64]) -> Vec<f64> {
    density.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect()
}

/// Returns the means of a density over the steps that the eye sees, which begin abruptly, and 0 over the others.
fn visible_steps(density: &[f64]) -> Vec<f64> {
    let mut steps = steps(density);
    steps[..ULTRAVIOLET_COUNT].fill(0.0);
    steps
}
