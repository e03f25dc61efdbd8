//! Decides which lanes carry the light, and whether they part.

use std::cell::LazyCell;
use std::collections::BTreeSet;

use super::candidates::{Candidate, LANES_SAFETY, bands_covering, candidates, error, fixed_bands, lines_with_lane};
use super::dyes::describe as describe_dyes;
use super::films::describe as describe_film;
use super::format::{percent, percent_bound};
use super::seen::Seen;
use super::survey::{Survey, disperses, look_method, tolerance};
use crate::material::{Dielectric, Material};
use crate::scene::{ModelText, NamedMaterial, Scene};
use crate::spectrum::{Basis, Curve, CurveKind, Dye, Emission, MAX_LANES, Quantity, index_source};
use crate::trace::{COLORS_NM, Dispersion, World, dispersion as measured_dispersion};

/// Share of the camera rays on dispersive surfaces above which twice as many wavelengths are carried.
const FILLING_SHARE: f64 = 0.5;
/// Fixed and hero wavelengths where dispersion is visible, and where it fills the image.
const HERO_LANES: [[usize; 2]; 2] = [[12, 4], [24, 8]];

/// What the lanes stand for, why, and a basis to compare its cost with.
pub(super) struct Model {
    pub(super) basis: Basis,
    /// How far colors may be off, in words.
    pub(super) error_line: Option<String>,
    /// How far colors may be off, as a number.
    pub(super) error: f64,
    pub(super) because: Vec<String>,
    /// The model to compare with, which would cost more or less.
    pub(super) next: Option<Basis>,
    /// The models it was chosen from.
    pub(super) candidates: Vec<Candidate>,
}

/// Returns the smallest model that a scene needs, or the one it asks for.
pub(super) fn model(scene: &Scene<Curve>) -> Model {
    let dispersion = dispersion(scene);
    let visible = dispersion.is_some_and(|d| d.is_visible());
    let requests_heroes = scene.render.model == ModelText::Hero;
    let together = !visible && !requests_heroes;
    let survey = Survey::new(scene, together);
    let seen = Seen::new(scene, &survey);
    let hero = requests_heroes || (scene.render.model == ModelText::Auto && visible);
    let fills_view = dispersion.is_some_and(|d| d.seen > FILLING_SHARE);
    let [bands, heroes] = HERO_LANES[usize::from(fills_view)];
    let shown = scene.format.spectral.as_ref();
    let spectral = shown.is_some();
    let candidates = candidates(&survey, &seen, if hero { heroes } else { 0 });
    let tolerance = tolerance(scene);
    let min_lanes = if hero { fixed_bands(&survey, bands, heroes).fixed_lanes() } else { 0 };
    let chosen = choose_candidate(&candidates, tolerance, min_lanes);

    let is_exact = survey.is_rgb_only() && candidates[0].error == 0.0;
    let with_heroes = |bands| {
        let lights = survey.emissions();
        let basis = bands_covering(&survey, bands, heroes, shown).with_heroes(heroes, &lights);
        shown.iter().fold(basis, |basis, shown| basis.spread_over_bands(shown, &lights))
    };
    let (basis, why) = match scene.render.model {
        _ if hero && spectral && requests_heroes => (with_heroes(MAX_LANES), "the scene asks for it".to_owned()),
        _ if hero && spectral => (with_heroes(MAX_LANES), "dispersion is seen, and spectra are asked for".to_owned()),
        _ if hero && requests_heroes => (with_heroes(bands), "the scene asks for it".to_owned()),
        _ if hero => {
            let least = candidates[chosen].basis.fixed_lanes().saturating_sub(lines_with_lane(&survey, heroes).len());
            (with_heroes(bands.max(least)), "dispersion is seen".to_owned())
        }
        ModelText::Rgb => (three_bands(&survey), "the scene asks for it".to_owned()),
        ModelText::Bands(count) => (fixed_bands(&survey, count as usize, 0), "the scene asks for it".to_owned()),
        _ if spectral => {
            (bands_covering(&survey, MAX_LANES, 0, shown), "the most lanes available, for the spectra".to_owned())
        }
        _ => (candidates[chosen].basis.clone(), lane_count_reason(&candidates, chosen, tolerance, is_exact)),
    };
    let next =
        if hero { candidates.get(chosen) } else { candidates.get(chosen + 1) }.map(|candidate| candidate.basis.clone());
    let next = next.filter(|_| hero || !survey.is_rgb_only());
    let may_miss = !is_exact || basis.fixed_lanes() > 3;
    let error = if may_miss { bound(&candidates, &basis, &survey, &seen) } else { 0.0 };
    let error_line = may_miss.then(|| error_line(&candidates, &basis, error, tolerance));
    let is_for_spectra = spectral && scene.render.model == ModelText::Auto;
    let caveat = if is_for_spectra && error > tolerance { format!("; {BEYOND_TOLERANCE}") } else { String::new() };
    let mut because = vec![format!("model {}: {}; {why}{caveat}", basis.name(), describe_lanes(&basis))];
    because.extend(lines_without_lane(&survey, &basis));
    because.extend(dispersion.map(|d| describe(&d, visible, hero)));
    let basis = if together { basis.kept_together() } else { basis };
    because.extend(describe_desaturation(scene, &basis));
    because.extend(describe_materials(scene, &basis));
    let next = next.map(|next| if together || hero { next.kept_together() } else { next });
    Model { basis, error_line, error, because, next, candidates }
}

/// Returns the index of the first candidate that misses no color by more than is tolerated. Without one, returns that
/// of the candidate that misses least among those with at least `min_lanes` fixed lanes.
fn choose_candidate(candidates: &[Candidate], tolerance: f64, min_lanes: usize) -> usize {
    let within = candidates.iter().position(|candidate| candidate.bound() <= tolerance);
    let many = (0..candidates.len()).filter(|&number| candidates[number].basis.fixed_lanes() >= min_lanes);
    let nearest = many.min_by(|&a, &b| candidates[a].bound().total_cmp(&candidates[b].bound()));
    within.or(nearest).unwrap_or(candidates.len() - 1)
}

/// Describes what a sample carries.
fn describe_lanes(basis: &Basis) -> String {
    let (all, fixed) = (basis.lanes(), basis.fixed_lanes());
    match all - fixed {
        0 if fixed <= 3 => format!("{all} lanes"),
        0 => format!("{all} lanes, one for each wavelength"),
        heroes => {
            format!("{all} lanes: {fixed} fixed wavelengths and {heroes} hero wavelengths, drawn anew for each sample")
        }
    }
}

/// Returns three bands, whatever they miss.
fn three_bands(survey: &Survey) -> Basis {
    let space = survey.color_space;
    match (survey.is_rgb_only(), survey.common_light()) {
        (true, _) => Basis::rgb(space),
        (false, Some(light)) => Basis::prefiltered(space, &light),
        (false, None) => Basis::prefiltered(space, &Emission::new(&1.0.into(), space)),
    }
}

/// The message where no number of lanes is enough.
const BEYOND_TOLERANCE: &str = "some color may be off by more than is tolerated";

fn lane_count_reason(candidates: &[Candidate], chosen: usize, tolerance: f64, plain: bool) -> String {
    match candidates[chosen].bound() {
        _ if plain => {
            "every color is a number or rgb under the film's white, so more lanes would change nothing".into()
        }
        bound if bound <= tolerance => "the fewest lanes that keep every color within the tolerance".into(),
        _ if chosen + 1 == candidates.len() => format!("the most lanes available; {BEYOND_TOLERANCE}"),
        _ => format!("more lanes would be no more accurate; {BEYOND_TOLERANCE}"),
    }
}

/// Returns how far colors may be off in a basis.
fn bound(candidates: &[Candidate], basis: &Basis, survey: &Survey, seen: &Seen) -> f64 {
    let known = candidates.iter().find(|candidate| candidate.basis.name() == basis.name());
    known.map_or_else(|| LANES_SAFETY * error(survey, seen, basis), Candidate::bound)
}

/// Describes all candidates in one line, and the basis with its bound; for heroes, what their fixed lanes miss.
fn error_line(candidates: &[Candidate], basis: &Basis, bound: f64, tolerance: f64) -> String {
    if basis.draws_wavelengths() {
        let bounded = if bound > 1.0 { "some color may be" } else { "colors are" };
        let percent_bound = if bound > 1.0 { percent_bound(bound) } else { format!("at most {}", percent(bound)) };
        return format!("{bounded} off by {percent_bound} ({} is tolerated)", percent(tolerance));
    }
    let mut steps: Vec<String> = candidates
        .iter()
        .map(|candidate| format!("{} {}", candidate.basis.name(), percent_bound(candidate.bound())))
        .collect();
    if !candidates.iter().any(|candidate| candidate.basis.name() == basis.name()) {
        steps.push(format!("{} {}", basis.name(), percent_bound(bound)));
    }
    format!("colors are off by at most ({} is tolerated): {}", percent(tolerance), steps.join(", "))
}

/// Describes emission lines that share the interpolated lanes.
fn lines_without_lane(survey: &Survey, basis: &Basis) -> Option<String> {
    let lines = survey.lines(usize::MAX);
    let line_lanes = lines.iter().filter(|nm| basis.wavelengths_nm().contains(nm)).count();
    (line_lanes < lines.len()).then(|| match line_lanes {
        0 if lines.len() == 1 => "the emission line is interpolated between the lanes".into(),
        0 => format!("{} emission lines are interpolated between the lanes", lines.len()),
        _ => format!(
            "of {} emission lines the {line_lanes} brightest have lanes of their own, the others are interpolated",
            lines.len()
        ),
    })
}

/// Measures how far dispersive glass pulls colors apart; `None` if there is none.
fn dispersion(scene: &Scene<Curve>) -> Option<Dispersion> {
    let has_three_indices =
        |glass: &Dielectric<Curve>| matches!(glass.index.kind, CurveKind::Rgb([r, g, b]) if r != g || g != b);
    // Under white light and with paints of three numbers, three indices suffice. Otherwise each wavelength has its own.
    let is_rgb_only = LazyCell::new(|| Survey::new(scene, true).is_rgb_only());
    let parts_lanes = |glass: &Dielectric<Curve>| disperses(glass) || has_three_indices(glass) && !*is_rgb_only;
    scene.materials.iter().find(|m| m.material.medium().is_some_and(parts_lanes))?;
    let basis = Basis::wavelengths(scene.film.color_space, COLORS_NM.into(), &[]);
    Some(measured_dispersion(&World::new(scene, look_method(scene, basis))))
}

fn describe(dispersion: &Dispersion, visible: bool, hero: bool) -> String {
    let [from, to] = COLORS_NM;
    let pixels = |x: f64| if x < 9.95 { format!("{x:.2}") } else { format!("{x:.0}") };
    let share = match 100.0 * dispersion.seen {
        p if p == 0.0 || p >= 0.5 => format!("{p:.0} %"),
        p => format!("{p:.1e} %"),
    };
    let unseen = format!("no probe ray saw anything through the dispersive glass in {share} of the view");
    let (pulls, lit) = (format!("pulls {from} and {to} nm up to"), pixels(dispersion.lit_pixels));
    let shown = match dispersion.dark {
        true if dispersion.lit_pixels == 0.0 => format!("{unseen}, where dispersion is assumed"),
        true => format!("{unseen}, which {pulls} {lit} pixels apart where it lights surfaces"),
        false => {
            let seen =
                format!("dispersive glass in {share} of the view {pulls} {} pixels", pixels(dispersion.seen_pixels));
            format!("{seen} apart, and up to {lit} pixels where it lights surfaces")
        }
    };
    let consequence = match (visible, hero) {
        (true, true) => "so wavelengths separate",
        (true, false) => "so lanes separate",
        (false, true) => "less than can be seen, but the scene asks for it",
        (false, false) => "less than 0.2 cannot be seen, so lanes stay together",
    };
    format!("dispersion: {shown}; {consequence}")
}

/// Describes how many colors are more saturated than any reflectance.
fn describe_desaturation(scene: &Scene<Curve>, basis: &Basis) -> Option<String> {
    if basis.fixed_lanes() <= 3 {
        return None;
    }
    let mut count = 0;
    for named in &scene.materials {
        named.material.map(&mut |quantity, curve| {
            let is_color = matches!(quantity, Quantity::Reflectance | Quantity::Transmittance | Quantity::Share);
            if let (CurveKind::Rgb(rgb), true) = (&curve.kind, is_color) {
                count += u32::from(basis.upsampler().fit(rgb.map(|x| x * curve.scale)).saturation < 1.0);
            }
        });
    }
    let colors = if count == 1 { "1 rgb color is" } else { &format!("{count} rgb colors are") };
    (count > 0).then(|| format!("{colors} more saturated than a smooth reflectance can be, and moved toward gray"))
}

/// Most materials that are described one by one.
const MAX_MATERIALS: usize = 20;

/// Describes where the data of clear bodies and metals come from, and what is known of films and dyes.
fn describe_materials(scene: &Scene<Curve>, basis: &Basis) -> Vec<String> {
    let mut known = BTreeSet::new();
    let new_lines = |named: &NamedMaterial<Curve>| {
        let lines = describe_material(&named.material, basis);
        let lines = lines.into_iter().map(|line| format!("material {}: {line}", named.name));
        // Each object has its own sheet, which turns with it: equal lines are given once.
        let new: Vec<String> = lines.filter(|line| known.insert(line.clone())).collect();
        (!new.is_empty()).then_some(new)
    };
    let descriptions: Vec<Vec<String>> = scene.materials.iter().filter_map(new_lines).collect();
    let more = match descriptions.len().saturating_sub(MAX_MATERIALS) {
        0 => None,
        1 => Some("1 more material is clear, a metal, coated or fluorescent".to_owned()),
        more => Some(format!("{more} more materials are clear, metals, coated or fluorescent")),
    };
    descriptions.into_iter().take(MAX_MATERIALS).flatten().chain(more).collect()
}

fn describe_material(material: &Material<Curve>, basis: &Basis) -> Vec<String> {
    let dyes: Vec<Dye> = material.dyes().into_iter().map(|dye| dye.dye()).collect();
    let numbers = match material {
        Material::Dielectric(glass) => {
            let table = basis.tabulate(Quantity::Index, &glass.index);
            let (low, high) = table.range();
            let source = index_source(&glass.index).map_or(String::new(), |source| format!(" ({source})"));
            Some(match (table.is_flat(), table.direction()) {
                (true, _) => format!("index {low:.4} in every lane{source}, so lanes stay together"),
                (_, Some(one)) => format!(
                    "index {low:.4} to {high:.4}{source}; all lanes are refracted by {one:.4}, so lanes stay together"
                ),
                _ => format!("index {low:.4} to {high:.4}{source}, so lanes separate"),
            })
        }
        Material::Conductor(metal) => index_source(&metal.n).map(|source| format!("n and k from {source}")),
        _ => None,
    };
    [describe_dyes(&dyes, basis), describe_film(material, basis), numbers].into_iter().flatten().collect()
}
