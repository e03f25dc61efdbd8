//! The grid on which light is integrated, 300 to 830 nm in steps of 1 nm: the visible range, and the ultraviolet light
//! below it that dyes make visible.

use super::color::{ColorSpace, weighted_sum};
use super::data;

/// The first wavelength of the grid, in nm: CIE illuminants have no light below it.
pub const START_NM: f64 = 300.0;
/// The first wavelength that the eye sees, in nm.
pub const FIRST_NM: f64 = 360.0;
/// The last wavelength, in nm.
pub const LAST_NM: f64 = 830.0;
/// Number of wavelengths on the grid.
pub const COUNT: usize = 531;
/// Number of wavelengths on the grid below the visible range.
pub const ULTRAVIOLET_COUNT: usize = 60;

/// Luminous efficacy of radiation at the peak of photopic vision, in lm/W: K_m of CIE 018:2019, *The Basis of Physical
/// Photometry*.
pub const EFFICACY: f64 = 683.002;

/// Returns the wavelengths of the grid, in nm.
pub fn wavelengths() -> impl Iterator<Item = f64> {
    (0..COUNT).map(|i| START_NM + i as f64)
}

/// Returns where a wavelength lies on the grid: the entry at or below it, and the fraction of the step to the next one.
pub fn grid_position(wavelength_nm: f64) -> (usize, f64) {
    let at = (wavelength_nm - START_NM).clamp(0.0, (COUNT - 1) as f64);
    let below = (at as usize).min(COUNT - 2);
    (below, at - below as f64)
}

/// Interpolates a function that is known on the grid, linearly within a step.
pub(super) fn read(function: &[f64], wavelength_nm: f64) -> f64 {
    let (below, fraction) = grid_position(wavelength_nm);
    function[below] + fraction * (function[below + 1] - function[below])
}

/// Returns the CIE 1931 2 degree color matching functions, linear within a step; 0 outside the visible range.
pub fn color_matching(wavelength_nm: f64) -> [f64; 3] {
    if !(FIRST_NM..=LAST_NM).contains(&wavelength_nm) {
        return [0.0; 3];
    }
    let (below, fraction) = grid_position(wavelength_nm);
    let [a, b] = [0, 1].map(|step| data::color_matching()[below - ULTRAVIOLET_COUNT + step]);
    std::array::from_fn(|i| a[i] + fraction * (b[i] - a[i]))
}

/// Returns the color matching functions at each wavelength of the grid.
pub fn observer() -> impl Iterator<Item = [f64; 3]> {
    std::iter::repeat_n([0.0; 3], ULTRAVIOLET_COUNT).chain(data::color_matching().iter().copied())
}

/// Returns CIE XYZ of a spectrum on the grid: the sum over 1 nm steps (CIE 15:2018, equation 7.1) with k = 1.
pub fn xyz(spectrum: &[f64]) -> [f64; 3] {
    weighted_sum(spectrum.iter().copied().zip(observer()))
}

/// Returns the spectrum of a film's white on the grid, and the factors on its XYZ that make it exactly that white.
pub(super) fn white(space: ColorSpace) -> (Vec<f64>, [f64; 3]) {
    let light = space.white_light();
    let spectrum: Vec<f64> = wavelengths().map(|nm| light.at(nm)).collect();
    let (found, white) = (xyz(&spectrum), space.white());
    (spectrum, std::array::from_fn(|i| white[i] / found[i]))
}

/// Returns the integral of y-bar over the visible range: Y of a flat spectrum of 1 before it is scaled.
pub fn y_integral() -> f64 {
    data::color_matching().iter().map(|cmf| cmf[1]).sum()
}
