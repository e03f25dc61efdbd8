//! Predicts how much color each spectral model would miss of dyes.

use std::borrow::Cow;

use super::survey::{Survey, Tint, lanes, max_channel, max_channel_error};
use crate::spectrum::{
    Basis, Curve, Draw, Dye, Emission, FilmColors, Lanes, MAX_LANES, PreparedDye, Quantity, Upsampler, visible,
};

/// Most tints of each path that are combined: those farthest from gray.
const MAX_TINTS: usize = 8;

/// What tints light on a path: nothing, or a surface.
struct PathTints<'a> {
    tints: Vec<Option<&'a Tint<'a>>>,
}

impl PathTints<'_> {
    /// Returns what is left of light at wavelengths in nm.
    fn at(&self, wavelengths_nm: &[f64], upsampler: &Upsampler) -> Vec<Vec<f64>> {
        self.read(wavelengths_nm.len(), |tint| tint.at(wavelengths_nm, upsampler))
    }

    /// Returns what is left of light in the lanes of a basis.
    fn in_basis(&self, basis: &Basis) -> Vec<Lanes<MAX_LANES>> {
        self.read(basis.fixed_lanes(), |tint| tint.in_basis(basis)).iter().map(|left| lanes(left)).collect()
    }

    fn read(&self, count: usize, read: impl Fn(&Tint) -> Vec<f64>) -> Vec<Vec<f64>> {
        self.tints.iter().map(|tint| tint.map_or_else(|| vec![1.0; count], &read)).collect()
    }
}

/// Returns the largest relative error of a basis in the color of a dye that is seen and lit via every other surface.
pub(super) fn error(survey: &Survey, basis: &Basis) -> f64 {
    if survey.dyes.is_empty() {
        return 0.0;
    }
    let tints = survey.scattering(MAX_TINTS).into_iter().chain(survey.smooth(MAX_TINTS)).map(Some);
    let paths = PathTints { tints: std::iter::once(None).chain(tints).collect() };
    let reference_lights: Vec<&(Curve, Emission)> = survey.reference_lights().collect();
    let lights: Vec<&Curve> = reference_lights.iter().map(|(curve, _)| curve).collect();
    let dyes: Vec<Dye> = survey.dyes.iter().map(|(dye, _)| dye.clone()).collect();
    let basis = &basis.clone().for_dyes(&dyes, &lights);
    let mut worst: f64 = 0.0;
    for (dye, reflectance) in &survey.dyes {
        let (dye, glow) = (&dye.prepared(), &dye.shines(basis.color_space()).film_colors());
        for (curve, light) in &reference_lights {
            let lit = LitDye { dye, glow, reflectance, curve, light };
            worst = worst.max(lit.color_error(&paths, basis));
        }
    }
    worst
}

/// A surface with a dye under a light.
struct LitDye<'a> {
    dye: &'a PreparedDye<'a>,
    glow: &'a FilmColors,
    reflectance: &'a Curve,
    /// The light's curve as it is written, and its emission.
    curve: &'a Curve,
    light: &'a Emission,
}

impl LitDye<'_> {
    fn color_error(&self, paths: &PathTints, basis: &Basis) -> f64 {
        let Self { dye, glow, reflectance, curve, light } = *self;
        let colors = light.film_colors();
        let wavelengths = &colors.wavelengths_nm;
        let excited: Vec<f64> = dye.by(light).parts().collect();
        let exact = paths.at(wavelengths, basis.upsampler());
        let surface = Tint::Diffuse(Cow::Borrowed(reflectance));
        let (reflected, reflected_lanes) =
            (surface.at(wavelengths, basis.upsampler()), lanes(&surface.in_basis(basis)));

        let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
        let in_lanes = paths.in_basis(basis);
        let emission = draw.read(&basis.tabulate(Quantity::Emission, curve));
        let (excitation, response) = (basis.excitation(dye, light), basis.response(&dye.dye().emission));
        let (response_to_light, reflected_light) = (basis.response(curve), emission * reflected_lanes);
        let brightness: Vec<[f64; 2]> = exact
            .iter()
            .zip(&in_lanes)
            .map(|(left, lanes)| {
                let exact = left.iter().zip(&excited).map(|(left, power)| left * power).sum();
                [exact, excitation.film_rgb(&draw, emission * *lanes, false)[0]]
            })
            .collect();
        let mut worst: f64 = 0.0;
        for (seen, seen_lanes) in exact.iter().zip(&in_lanes) {
            let seen_glow = glow.color(seen);
            let found_glow = response.film_rgb(&draw, *seen_lanes, false);
            for ((lit, lit_lanes), [brightness, found]) in exact.iter().zip(&in_lanes).zip(&brightness) {
                let product: Vec<f64> = (0..wavelengths.len()).map(|i| reflected[i] * seen[i] * lit[i]).collect();
                let elastic = colors.color(&product);
                let found_elastic =
                    response_to_light.film_rgb(&draw, reflected_light * *seen_lanes * *lit_lanes, false);
                let color: [f64; 3] = std::array::from_fn(|c| elastic[c] + brightness * seen_glow[c]);
                let found: [f64; 3] = std::array::from_fn(|c| found_elastic[c] + found * found_glow[c]);
                let scale = max_channel(color);
                if scale > 0.0 {
                    worst = worst.max(max_channel_error(found, color) / scale);
                }
            }
        }
        worst
    }
}

/// Describes a material's dyes: where they absorb light, and whether lanes reach there.
pub(super) fn describe(dyes: &[Dye], basis: &Basis) -> Option<String> {
    let absorbed = |nm: f64| dyes.iter().map(|dye| dye.absorbed()(nm)).fold(0.0, f64::max);
    let peak = visible::wavelengths().map(absorbed).fold(0.0, f64::max);
    let mut strong = visible::wavelengths().filter(|&nm| absorbed(nm) > 0.05 * peak);
    let (first, last) = (strong.next()?, strong.last()?);
    let lowest = basis.wavelengths_nm().iter().copied().fold(f64::INFINITY, f64::min);
    let lanes = if basis.fixed_lanes() > 3 { format!("; lanes reach down to {lowest:.0} nm") } else { String::new() };
    Some(format!("fluoresces under light of {first:.0} to {last:.0} nm{lanes}"))
}
