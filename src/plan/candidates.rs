//! Predicts how much color each spectral model would miss in a scene.

use super::dyes;
use super::seen::Seen;
use super::survey::{Survey, Tint, lanes, max_channel, max_channel_error};
use crate::spectrum::{Basis, Draw, Emission, MAX_LANES, Quantity, Upsampler, WavelengthBands};

/// A spectral model, with the largest color error that it is predicted to make.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Candidate {
    /// What its lanes stand for.
    pub basis: Basis,
    /// Relative to the strongest channel, before the safety factor.
    pub error: f64,
    /// Factor that covers nineteen of twenty scenes, measured on random rooms: see `tests/planning.rs`.
    pub safety: f64,
}

impl Candidate {
    /// Returns the bound below which the color error is promised to stay.
    pub fn bound(&self) -> f64 {
        self.error * self.safety
    }
}

/// Most diffuse and smooth colors that are combined; of more, those farthest from gray.
const MAX_COLORS: [usize; 2] = [20, 6];

/// Returns the largest relative color error of a basis in a scene: over its lights and all pairs of surfaces, and over
/// what the light of a probe hits, however many smooth surfaces that is.
pub(super) fn error(survey: &Survey, seen: &Seen, basis: &Basis) -> f64 {
    let scattered = error_of_paths(survey, basis, &survey.scattering(MAX_COLORS[0]), &survey.smooth(MAX_COLORS[1]));
    scattered.max(seen.error(survey, basis)).max(dyes::error(survey, basis))
}

/// Returns the largest relative color error over paths of chosen tints.
fn error_of_paths(survey: &Survey, basis: &Basis, scattering: &[&Tint], smooth: &[&Tint]) -> f64 {
    let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
    let evaluate = |tints: &[&Tint]| tints.iter().map(|tint| tint.in_basis(basis)).collect::<Vec<_>>();
    let films = film_crossings(smooth);
    let in_lanes = paths(&evaluate(scattering), &evaluate(smooth), &films);
    let mut worst: f64 = 0.0;
    for (curve, light) in survey.reference_lights() {
        let exact = exact_colors(light, scattering, smooth, &survey.upsampler);
        let (table, response) = (basis.tabulate(Quantity::Emission, curve), basis.response(curve));
        let emission = draw.read(&table);
        for (exact, left) in exact.iter().zip(&in_lanes) {
            let found = response.film_rgb(&draw, emission * lanes(left), false);
            let scale = max_channel(*exact);
            if scale > 0.0 {
                worst = worst.max(max_channel_error(found, *exact) / scale);
            }
        }
    }
    worst
}

/// Returns the film colors of all paths, from sums over 1 nm.
fn exact_colors(light: &Emission, scattering: &[&Tint], smooth: &[&Tint], upsampler: &Upsampler) -> Vec<[f64; 3]> {
    let colors = light.film_colors();
    let evaluate =
        |tints: &[&Tint]| tints.iter().map(|tint| tint.at(&colors.wavelengths_nm, upsampler)).collect::<Vec<_>>();
    let films = film_crossings(smooth);
    paths(&evaluate(scattering), &evaluate(smooth), &films).iter().map(|path| colors.color(path)).collect()
}

/// Returns what is left of light on all paths: every surface i, lit directly and via every surface j, q = r_i (1 + r_j
/// / (1 - mean r)), alone and seen via every smooth surface; and the lights, seen directly and via one or two smooth
/// surfaces. At most one of these two is one of the `films`, which come first: two films never share their fringes as a
/// film does with itself. Light that enters a body through its film leaves through it, so a film that light crosses is
/// crossed twice, also by light that goes back and forth in a slab.
fn paths(scattering: &[Vec<f64>], smooth: &[Vec<f64>], films: &[bool]) -> Vec<Vec<f64>> {
    let length = scattering.iter().chain(smooth).next().map_or(0, Vec::len);
    let count = scattering.len().max(1) as f64;
    let mean: Vec<f64> = (0..length).map(|i| scattering.iter().map(|r| r[i]).sum::<f64>() / count).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
    let mut paths = Vec::new();
    for first in scattering {
        for second in scattering {
            let path_value = |i: usize| first[i] * (1.0 + second[i] / (1.0 - mean[i].min(MAX_MEAN_REFLECTANCE)));
            let path: Vec<f64> = (0..length).map(path_value).collect();
            paths.extend(smooth.iter().map(|filter| product(filter, &path)));
            paths.push(path);
        }
    }
    for (number, first) in smooth.iter().enumerate() {
        paths.extend(smooth[number.max(films.len())..].iter().map(|second| product(first, second)));
        if films.get(number) == Some(&true) {
            paths.push(product(first, first));
            // Between two faces, with r = 1 - t: t^2 / (1 - r^2).
            paths.push(first.iter().map(|t| t / (2.0 - t)).collect());
        }
        paths.push(first.clone());
    }
    paths
}

/// For each of the first tints, those in which light interferes, tells whether light crosses it.
fn film_crossings(smooth: &[&Tint]) -> Vec<bool> {
    let is_crossed = |tint: &&Tint| matches!(tint, Tint::Film(film) if film.crosses);
    smooth.iter().take_while(|tint| tint.has_fringes()).map(is_crossed).collect()
}

/// Largest mean reflectance of a closed room; a larger one is clamped.
const MAX_MEAN_REFLECTANCE: f64 = 0.95;

/// Returns the models that could render a scene, from few lanes to many, each with its predicted error.
pub(super) fn candidates(survey: &Survey, seen: &Seen, heroes: usize) -> Vec<Candidate> {
    let space = survey.color_space;
    let candidate = |basis: Basis, safety: f64| Candidate { error: error(survey, seen, &basis), basis, safety };
    let mut candidates = Vec::new();
    if survey.is_rgb_only() {
        // Colors of three numbers have no error; only what glass reflects is measured.
        let basis = Basis::rgb(space);
        let error = error_of_paths(survey, &basis, &[], &survey.surfaces(MAX_COLORS[1]));
        candidates.push(Candidate { basis, error, safety: PREFILTERED_SAFETY });
        if heroes == 0 && error == 0.0 {
            return candidates;
        }
    } else if let (Some(light), false) = (survey.common_light(), survey.has_fringes() || !survey.dyes.is_empty()) {
        candidates.push(candidate(Basis::prefiltered(space, &light), PREFILTERED_SAFETY));
    }
    candidates.extend([8, 12, 16, 32].map(|bands| candidate(fixed_bands(survey, bands, heroes), LANES_SAFETY)));
    candidates
}

/// Returns the emission lines that have lanes of their own beside heroes.
pub(super) fn lines_with_lane(survey: &Survey, heroes: usize) -> Vec<f64> {
    survey.lines(MAX_LANES - heroes - MIN_BANDS)
}

/// Returns fixed lanes that leave room for heroes: the scene's emission lines, and as many wavelengths as fit.
pub(super) fn fixed_bands(survey: &Survey, bands: usize, heroes: usize) -> Basis {
    bands_covering(survey, bands, heroes, None)
}

/// Returns fixed lanes beside heroes and emission lines, spread over all bands of a spectral image if there are any:
/// beyond the first and last lane, spectra of surfaces are taken as constant.
pub(super) fn bands_covering(
    survey: &Survey,
    bands: usize,
    heroes: usize,
    output_bands: Option<&WavelengthBands>,
) -> Basis {
    let lines = lines_with_lane(survey, heroes);
    let bands = bands.min(MAX_LANES - heroes - lines.len());
    let space = survey.color_space;
    let [from, to] = match survey.needs_ultraviolet() {
        true => Basis::FROM_ULTRAVIOLET_NM,
        false => Basis::best_range_nm(bands),
    };
    let basis = match output_bands.map(WavelengthBands::range_nm) {
        None => Basis::bands_over(space, bands, [from, to], &lines),
        // Lanes lie at both ends: with lanes half a step inside, an edge at 380 nm was off by 0.15.
        Some([first, last]) => {
            let (from, to) = (from.min(first), to.max(last));
            let step = (to - from) / (bands - 1) as f64;
            Basis::wavelengths(space, (0..bands).map(|i| from + i as f64 * step).collect(), &lines)
        }
    };
    let (lights, dyes) = survey.emitters();
    basis.with_true_colors_under(&lights, &dyes, output_bands)
}

/// Fewest interpolated wavelengths beside the lanes of emission lines.
const MIN_BANDS: usize = 8;
pub(super) const LANES_SAFETY: f64 = 1.5;
const PREFILTERED_SAFETY: f64 = 1.9;
