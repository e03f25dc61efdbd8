//! Names that the catalog does not have, or has for something else.

use std::path::Path;

use super::curve_range::CurveError;
use crate::error::{has_extension, nearest};
use crate::scene::share;
use crate::scene::text::{IMAGES, TABLES};
use crate::scene::web_color::web_color;
use crate::spectrum::data::{self, bare};

pub(super) fn unknown_glass(name: &str) -> CurveError {
    unknown_name(name, "glass", data::known_as())
}

pub(super) fn unknown_metal(name: &str) -> CurveError {
    unknown_name(name, "metal", data::metals().flat_map(|metal| [vec![metal.name], metal.aliases].concat()))
}

pub(super) fn unknown_reflectance(name: &str) -> CurveError {
    if let Some(help) = quoted_text_hint(name).or_else(|| color_hint(name)) {
        return CurveError::new(format!("there is no reflectance named {name:?}")).help(help);
    }
    let full = || data::reflectances().map(|patch| patch.name);
    unknown_name(name, "reflectance", full().map(bare).chain(full()))
}

/// Returns how to write a text in quotes that is not a name: a file, a share in percent, or a number with its unit.
pub(super) fn quoted_text_hint(text: &str) -> Option<String> {
    let has_unit = || text.split_once(' ').is_some_and(|(number, unit)| number.parse::<f64>().is_ok() && is_unit(unit));
    match share(text) {
        Some(share) => Some(format!("write {share}")),
        None if has_unit() => Some("write the number without quotes or unit".into()),
        None if has_extension(Path::new(text), TABLES) => Some(format!("write {{ file = {text:?} }}")),
        None => image_hint(text),
    }
}

/// Returns whether a word is a unit of light.
fn is_unit(word: &str) -> bool {
    let word = word.to_lowercase().replace('\u{b2}', "2").replace('^', "");
    matches!(&*word, "cd" | "cd/m2" | "nit" | "nits" | "lx" | "lux" | "lm" | "lumen" | "lumens" | "w" | "w/m2" | "w/sr")
}

/// Returns how to write an image, given the name of its file.
pub(super) fn image_hint(file: &str) -> Option<String> {
    has_extension(Path::new(file), IMAGES).then(|| format!("write {{ image = {file:?} }}"))
}

/// Returns how to write a color that is given in another program's notation.
pub(super) fn color_hint(text: &str) -> Option<String> {
    web_color(text).map(|color| format!("write {{ rgb = {color} }}, in linear light"))
}

/// Returns how to write a light that is given by its temperature in kelvin, such as `3000K`.
pub(super) fn temperature_hint(text: &str) -> Option<String> {
    let kelvin = text.strip_suffix(['K', 'k'])?.trim();
    let is_light = kelvin.parse().is_ok_and(|kelvin: f64| (1000.0..=40_000.0).contains(&kelvin));
    is_light.then(|| format!("write {{ blackbody = {kelvin} }}"))
}

pub(super) fn unknown_illuminant(name: &str) -> CurveError {
    match illuminant_alias(name) {
        Some(light) => {
            CurveError::new(format!("there is no illuminant named {name:?}")).help(format!("did you mean {light:?}?"))
        }
        None if name.to_lowercase().ends_with("sodium") => {
            let help = "write { lines = [[589.0, 2], [589.6, 1]] } for low pressure, or \"HP1\" for high pressure";
            CurveError::new(format!("there is no illuminant named {name:?}")).help(help)
        }
        None => unknown_name(name, "illuminant", illuminants()),
    }
}

/// Returns the illuminant that has this name elsewhere: FL2 for F2, or D65 for CIE D65.
fn illuminant_alias(name: &str) -> Option<&'static str> {
    let lower = name.to_lowercase();
    let bare = lower.strip_prefix("cie ").unwrap_or(&lower);
    let bare = bare.strip_prefix("illuminant ").unwrap_or(bare);
    let bare = match bare {
        "daylight" => "d65",
        "tungsten" | "incandescent" => "a",
        "equal energy" => "e",
        _ => bare,
    };
    let fluorescent = bare.strip_prefix('f').map(|number| format!("fl{number}"));
    let same = |known: &&str| {
        known.eq_ignore_ascii_case(bare) || fluorescent.as_deref().is_some_and(|fl| known.eq_ignore_ascii_case(fl))
    };
    illuminants().find(same)
}

/// Returns how to write the illuminant whose name this is, exactly or nearly.
pub(super) fn illuminant_hint(name: &str) -> Option<String> {
    match data::illuminant(name) {
        Some(light) => Some(format!("it is an illuminant: write {{ illuminant = \"{}\" }}", light.name)),
        None if catalog_meaning(name).is_some() => None,
        None => Some(format!("did you mean {{ illuminant = \"{}\" }}?", nearest(name, illuminants())?)),
    }
}

fn illuminants() -> impl Iterator<Item = &'static str> {
    data::illuminants().map(|illuminant| illuminant.name)
}

fn unknown_name<'a>(name: &str, kind: &str, names: impl Iterator<Item = &'a str>) -> CurveError {
    let number = name.replace(',', ".").replace('\u{2212}', "-");
    let names: Vec<&str> = names.collect();
    let near = || nearest(name, names.iter().copied()).or_else(|| first_beginning_with(name, &names));
    let help = match (catalog_meaning(name), near()) {
        (Some(other), _) => format!("it is {other}"),
        _ if number.parse().is_ok_and(f64::is_finite) => format!("write the number {number}"),
        (None, Some(near)) => format!("did you mean \"{near}\"?"),
        (None, None) => {
            let colors = if kind == "reflectance" { "; a color is { rgb = [red, green, blue] }" } else { "" };
            format!("`render catalog {kind}` lists the known names{colors}")
        }
    };
    CurveError::new(format!("there is no {kind} named {name:?}")).help(help)
}

/// Returns the first name that begins with these whole words, such as `neutral 8 (.23 D)` for `neutral 8`.
fn first_beginning_with<'a>(words: &str, names: &[&'a str]) -> Option<&'a str> {
    let start = format!("{} ", words.to_lowercase());
    names.iter().copied().find(|name| name.to_lowercase().starts_with(&start))
}

/// Returns what a name stands for in any part of the catalog.
fn catalog_meaning(name: &str) -> Option<String> {
    let glass = || Some(format!("a glass: dielectric = {{ index = \"{}\" }}", data::glass(name)?.name()));
    let metal = || Some(format!("a metal: conductor = {{ metal = \"{}\" }}", data::metal(name)?.name));
    let light = || Some(format!("an illuminant: radiance = {{ illuminant = \"{}\" }}", data::illuminant(name)?.name));
    let patch =
        || Some(format!("a reflectance: diffuse = {{ reflectance = \"{}\" }}", bare(data::reflectance(name)?.name)));
    glass().or_else(metal).or_else(light).or_else(patch)
}
