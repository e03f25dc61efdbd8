//! Three bands that represent measured spectra as they look under one light.

use serde::{Deserialize, Serialize};

use super::color::{ColorSpace, apply, weighted_sum};
use super::visible::{self, color_matching};
use super::{Curve, CurveKind, Emission, Quantity};

/// The color that a light gives to each wavelength, in some primaries. Each channel sums to 1.
///
/// Ward & Eydelberg-Vileshin 2002, *Picture Perfect RGB Rendering Using Spectral Prefiltering and Sharp Color
/// Primaries*.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Bands {
    /// (wavelength in nm, share of each channel).
    parts: Vec<(f64, [f64; 3])>,
}

impl Bands {
    pub(super) fn new(primaries: ColorSpace, light: &Emission) -> Self {
        let to_bands = primaries.matrix_from_xyz();
        let smooth = visible::wavelengths().zip(light.spectrum()).map(|(nm, &power)| (nm, power));
        let lines = light.lines().iter().map(|&[nm, power]| (nm, power));
        let mut parts: Vec<_> = smooth
            .chain(lines)
            .map(|(nm, power)| (nm, apply(&to_bands, color_matching(nm).map(|x| power * x))))
            .collect();
        let total = |channel: usize, parts: &[(f64, [f64; 3])]| parts.iter().map(|part| part.1[channel]).sum::<f64>();
        let totals = [0, 1, 2].map(|channel| total(channel, &parts));
        // A channel that the light hardly contains would be divided by nearly 0: it follows the strongest one instead.
        let strongest = (0..3).fold(0, |most, c| if totals[c] > totals[most] { c } else { most });
        if totals[strongest] <= 0.0 {
            return Self { parts: vec![(visible::FIRST_NM, [1.0; 3])] };
        }
        for (_, share) in &mut parts {
            *share = std::array::from_fn(|c| {
                let channel = if totals[c].abs() < 1e-3 * totals[strongest] { strongest } else { c };
                share[channel] / totals[channel]
            });
        }
        Self { parts }
    }

    /// Returns the mean over each band.
    fn mean(&self, value: &dyn Fn(f64) -> f64) -> [f64; 3] {
        weighted_sum(self.parts.iter().map(|&(nm, share)| (value(nm), share)))
    }

    /// Returns the three numbers of a curve: colors as they look under the light, and the extinction of a catalog metal
    /// such that its reflectance at normal incidence does.
    pub(super) fn filter(&self, quantity: Quantity, curve: &Curve, value: &dyn Fn(f64) -> f64) -> [f64; 3] {
        match quantity {
            Quantity::Reflectance | Quantity::Transmittance | Quantity::Share => {
                self.mean(value).map(|x| x.clamp(0.0, 1.0))
            }
            Quantity::MetalIndex => self.mean(value).map(|x| x.max(1e-3)),
            Quantity::MetalExtinction if matches!(curve.kind, CurveKind::Metal(_)) => {
                let index = curve.values(Quantity::MetalIndex);
                let normal = self.mean(&|nm| normal_reflectance(index(nm), value(nm)));
                let n = self.mean(&index).map(|x| x.max(1e-3));
                std::array::from_fn(|c| extinction(n[c], normal[c].clamp(0.0, 0.9999)))
            }
            _ => self.mean(value).map(|x| x.max(0.0)),
        }
    }

    /// Returns the index of each band that gives the reflectance at normal incidence that the light shows: the mean of
    /// ((n - 1) / (n + 1))^2 over the band.
    pub(super) fn index(&self, value: &dyn Fn(f64) -> f64) -> [f64; 3] {
        self.mean(&|nm| normal_reflectance(value(nm), 0.0)).map(|reflectance| {
            let amplitude = reflectance.clamp(0.0, 0.9999).sqrt();
            (1.0 + amplitude) / (1.0 - amplitude)
        })
    }
}

/// Returns the reflectance of a metal n - ik at normal incidence (Born & Wolf 1999, section 14.2).
pub fn normal_reflectance(n: f64, k: f64) -> f64 {
    ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k)
}

/// Returns the extinction that gives a metal of index n this reflectance at normal incidence; 0 if it needs none.
fn extinction(n: f64, reflectance: f64) -> f64 {
    let squared = (reflectance * (n + 1.0) * (n + 1.0) - (n - 1.0) * (n - 1.0)) / (1.0 - reflectance);
    squared.max(0.0).sqrt()
}
