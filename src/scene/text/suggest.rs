//! Suggestions of what an author may have meant.

use std::path::Path;

use toml::de::{DeArray, DeTable, DeValue};

use super::aliases::{in_other_words, names_here};
use super::named_file::IMAGES;
use super::tree::Node;
use crate::error::{has_extension, nearest};
use crate::film::layer_elsewhere;
use crate::scene::share;
use crate::scene::web_color::web_color;
use crate::spectrum::ColorSpace;

/// Returns the known name that the value or key `word` may mean, or else all of them. `key` is the key of a value.
pub(super) fn suggestion(key: &str, word: &str, known: &[&str]) -> String {
    let layer = || (key == "layers").then(|| layer_elsewhere(word)).flatten().map(str::to_owned);
    if let Some(help) = layer().or_else(|| in_other_words(word, known)) {
        return help;
    }
    match meant_name(key, word, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known here: {}", known.join(", ")),
    }
}

/// Names that other programs give to the brightness of a light, which stands beside its color.
const BRIGHTNESS: [&str; 5] = ["intensity", "strength", "power", "brightness", "multiplier"];

/// Returns what to write for a key that a table does not know: the key that was meant, or what to do if that key is
/// there already.
pub(super) fn suggested_key(word: &str, known: &[&str], table: &DeTable) -> String {
    // A misspelled key, and one with an answer of its own, gets the same answer everywhere.
    let has_answer = nearest(word, known.iter().copied()).is_some() || in_other_words(word, known).is_some();
    let free: Vec<&str> = known.iter().copied().filter(|&key| !table.contains_key(key)).collect();
    let is_another = has_answer || meant_name(word, word, &free).is_some();
    match meant_name(word, word, known).filter(|_| !is_another) {
        None => suggestion(word, word, known),
        Some(near) if BRIGHTNESS.contains(&word) => format!("multiply `{near}` by it"),
        Some(near) => format!("`{near}` is already given here: leave one of them out"),
    }
}

/// Returns the known name that the value or key `word` may mean, if any is near.
pub(super) fn meant_name<'a>(key: &str, word: &str, known: &[&'a str]) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let is_part = |name: &str| name.to_lowercase().starts_with(&lower) || name.split('_').any(|part| part == word);
    let part_of = || known.iter().copied().find(|name| is_part(name));
    let elsewhere = || names_here(word).find(|here| known.contains(here));
    let space = || (key == "color_space").then(|| ColorSpace::from_name(word)).flatten().map(ColorSpace::interop_id);
    // `tile` is a word of other programs for `repeat`, although it differs from `file` by a single letter.
    elsewhere().or_else(|| nearest(word, known.iter().copied())).or_else(part_of).or_else(space)
}

/// Tables for which people write only the value that matters most, and the key of that value.
const SHORTHANDS: [(&str, &str); 9] = [
    ("diffuse", "reflectance"),
    ("plastic", "reflectance"),
    ("mirror", "reflectance"),
    ("emissive", "radiance"),
    ("environment", "radiance"),
    ("dielectric", "index"),
    ("thin", "index"),
    ("conductor", "metal"),
    ("point", "position"),
];

/// Returns how to write a table, if only its main value stands in its place.
fn expand_shorthand(key: &str, value: &DeValue, written: &str) -> Option<String> {
    let (_, inner) = SHORTHANDS.iter().find(|short| short.0 == key)?;
    let is_color = matches!(*inner, "reflectance" | "radiance");
    let whole = |value: String| Some(format!("write {{ {inner} = {value} }}"));
    match value {
        DeValue::Integer(_) | DeValue::Float(_) if is_color || *inner == "index" => whole(written.into()),
        DeValue::String(text) if is_color && has_extension(Path::new(&**text), IMAGES) => {
            whole(format!("{{ image = {written} }}"))
        }
        DeValue::String(_) if matches!(*inner, "reflectance" | "index" | "metal") => whole(written.into()),
        DeValue::Array(list) if list.len() != 3 || list.iter().any(|entry| !is_number(entry.get_ref())) => None,
        DeValue::Array(_) if is_color => whole(format!("{{ rgb = {written} }}")),
        DeValue::Array(_) if *inner == "position" => Some(format!("write {{ position = {written}, intensity = 10 }}")),
        _ => None,
    }
}

fn is_number(value: &DeValue) -> bool {
    matches!(value, DeValue::Integer(_) | DeValue::Float(_))
}

/// Returns how to write a point or a direction that is given as a text.
fn vector(key: &str, text: &str) -> Option<String> {
    let axes = [("x", "1, 0, 0"), ("y", "0, 1, 0"), ("z", "0, 0, 1")];
    let axis = axes.iter().find(|(name, _)| matches!(key, "up" | "normal" | "axis" | "toward") && text == *name);
    let parts: Vec<&str> = text.split([',', ' ', '[', ']', '(', ')']).filter(|part| !part.is_empty()).collect();
    let is_list = parts.len() == 3 && parts.iter().all(|part| part.parse::<f64>().is_ok_and(f64::is_finite));
    axis.map(|(_, list)| format!("write [{list}]")).or_else(|| is_list.then(|| format!("write [{}]", parts.join(", "))))
}

/// What is expected where keys are read.
pub(super) const TABLE: &str = "a table, { .. }";

/// Returns how to write what a value of the wrong type seems to mean.
pub(super) fn remedy(key: &str, value: &DeValue, expected: &str, written: &str) -> Option<String> {
    let number = expected == "a number" || expected.starts_with("a whole number") || expected.starts_with("at most");
    match value {
        DeValue::String(text) if number && text.parse::<f64>().is_ok_and(f64::is_finite) => {
            Some(format!("write it without quotes: {text}"))
        }
        DeValue::String(text) if number => match share(text) {
            Some(share) => Some(format!("write {share}")),
            _ if key == "column" => Some("columns are counted from 1".into()),
            _ if text.starts_with('$') => Some("a variable must be the whole value: there is no arithmetic".into()),
            _ if key == "retardance" => Some("it is in degrees: a quarter wave is 90".into()),
            _ if key == "meters_per_unit" && matches!(&**text, "m" | "cm" | "mm") => {
                let meters = [("m", "1"), ("cm", "0.01"), ("mm", "0.001")].into_iter().find(|unit| unit.0 == &**text);
                meters.map(|(_, meters)| format!("write {meters}"))
            }
            _ if text == "inf" && key == "focus_distance" => Some("write it without quotes: inf".into()),
            _ if text.starts_with(|first: char| first.is_ascii_digit()) => {
                Some("write the number without quotes or unit".into())
            }
            _ if key == "blackbody" => Some(format!("write {{ illuminant = {written} }} for a light by name")),
            _ => None,
        },
        DeValue::String(_) | DeValue::Integer(_) if key == "rgb" && expected == "a list of 3 numbers" => {
            let color = web_color(value.as_str().unwrap_or(written));
            let listed = || value.as_str().map_or_else(|| Some(without_braces(written)), |text| vector(key, text));
            color.map(|color| format!("write {color}, in linear light")).or_else(listed)
        }
        DeValue::Integer(_) | DeValue::Float(_) if key == "illuminant" => {
            Some(format!("write {{ blackbody = {written} }} for a temperature"))
        }
        DeValue::Integer(_) | DeValue::Float(_) if key == "time" && !written.starts_with('-') => {
            Some(format!("write \"{written}s\" for seconds"))
        }
        DeValue::Integer(_) | DeValue::Float(_) if expected == "a list of 2 numbers" => match key {
            "samples" => Some("write [[wavelength in nm, value], ..]".into()),
            "lines" => Some("write [[wavelength in nm, power], ..]".into()),
            "uv" => Some("write [[u, v], ..]".into()),
            "shift" => Some("write [to the right, up]".into()),
            _ => None,
        },
        DeValue::Integer(_) | DeValue::Float(_) if expected == "a list" && key == "faces" => {
            Some("write [[0, 1, 2], ..]".into())
        }
        DeValue::Integer(_) | DeValue::Float(_) if expected == "a list of 3 numbers" => match key {
            "points" | "normals" => Some("write [[x, y, z], ..]".into()),
            "axis" => Some("it is a direction in space, such as [1, 0, 0]".into()),
            "rgb" => Some(without_braces(written)),
            _ => None,
        },
        DeValue::Float(_) if key == "crop" => Some("a crop is in pixels: [left, top, width, height]".into()),
        DeValue::Integer(_) if key == "precision" => match written {
            "16" => Some("write \"half\"".into()),
            "32" => Some("write \"float\"".into()),
            _ => None,
        },
        DeValue::Float(float) if number => {
            let float: f64 = float.as_str().parse().ok()?;
            let most = expected.rsplit(' ').next().and_then(|most| most.parse::<f64>().ok());
            let fits = float >= 0.0 && float.fract() == 0.0 && most.is_none_or(|most| float <= most);
            fits.then(|| format!("write {float}"))
        }
        DeValue::Integer(_) if expected == "a number" => Some(format!("write it with a decimal point: {written}.0")),
        DeValue::String(text) if expected == "true or false" && matches!(&**text, "true" | "false") => {
            Some(format!("write it without quotes: {text}"))
        }
        DeValue::Boolean(false) if expected.contains("\"off\"") => Some("write \"off\"".into()),
        DeValue::Boolean(true) if expected.contains("\"on\"") => Some("write \"on\"".into()),
        DeValue::Boolean(true) if expected.contains("\"auto\"") => Some("write \"auto\", or leave it out".into()),
        DeValue::Integer(_) if expected == "true or false" && matches!(written, "0" | "1") => {
            Some(format!("write {}", written == "1"))
        }
        DeValue::String(_) if expected == TABLE && key == "mesh" => Some(format!("write {{ file = {written} }}")),
        DeValue::String(_) if expected == TABLE && key.ends_with("_map") => {
            Some(format!("write {{ image = {written}, .. }}"))
        }
        DeValue::String(text) if expected == "a list of 3 numbers" => vector(key, text),
        DeValue::Array(list) if expected == TABLE && key == "abbe" && list.len() == 2 => {
            let (nd, vd) = written.trim_matches(['[', ']']).split_once(',')?;
            Some(format!("write {{ nd = {}, vd = {} }}", nd.trim(), vd.trim()))
        }
        DeValue::Table(table) if expected == "a list of 3 numbers" && table.contains_key("x") => {
            Some("write [x, y, z]".into())
        }
        _ if expected == TABLE && SHORTHANDS.iter().any(|short| short.0 == key) => {
            expand_shorthand(key, value, written)
        }
        DeValue::Array(_) if expected == TABLE && key == "sellmeier" => {
            Some("write { b = [1.0396, 0.2318, 1.0105], c = [0.006, 0.02, 103.56] }, c in um^2".into())
        }
        _ if expected == TABLE && key == "rotate" => Some("write { axis = [0, 1, 0], degrees = 30 }".into()),
        DeValue::Array(_) if key == "axis" && expected == "a number" => {
            Some("in degrees: 0 points to the right of the image, 90 to its top".into())
        }
        DeValue::Integer(_) | DeValue::Float(_) if expected == TABLE && key == "polarizer" => {
            Some(format!("write {{ axis = {written} }}"))
        }
        DeValue::Array(_) if key == "scale" && expected == "a number" => {
            Some("`scale` multiplies the values; copies of an image are set by `repeat`".into())
        }
        DeValue::Array(_) if key == "image" => Some("write the name of its file, such as \"wood.png\"".into()),
        DeValue::Table(_) if key == "roughness" => {
            Some("it is uniform: to vary it, `mix` two materials by an image".into())
        }
        DeValue::Array(entries) if expected.starts_with("a number, a catalog name") => {
            spectrum_remedy(entries, written)
        }
        DeValue::Table(_) if key == "material" => Some("define it as [material.NAME] and write \"NAME\" here".into()),
        DeValue::Table(_) if key == "checker" => Some("write checker = [0.1, 0.8], and `repeat` beside it".into()),
        DeValue::Table(_) if expected == "a list" => Some("put it in brackets: [{ .. }]".into()),
        _ => None,
    }
}

/// Returns how to write one number in place of three.
fn without_braces(written: &str) -> String {
    format!("for the same number in all three, write it without braces: {written}")
}

/// Returns how to write what a list in place of a spectrum seems to mean.
fn spectrum_remedy(entries: &DeArray, written: &str) -> Option<String> {
    let are_numbers =
        |list: &DeArray, count: usize| list.len() == count && list.iter().all(|entry| is_number(entry.get_ref()));
    if are_numbers(entries, 3) {
        return Some(format!("write {{ rgb = {written} }} for a color"));
    }
    let is_pair = |entry: &Node| entry.get_ref().as_array().is_some_and(|pair| are_numbers(pair, 2));
    (!entries.is_empty() && entries.iter().all(is_pair))
        .then(|| "write { samples = [[wavelength in nm, value], ..] } for a spectrum".into())
}

/// Returns how to write a list that has `count` numbers if commas within them are decimal points.
pub(super) fn with_decimal_points(written: &str, count: usize) -> Option<String> {
    let inner = written.strip_prefix('[')?.strip_suffix(']')?;
    let parts: Vec<&str> = inner.split([' ', '\t', ';']).map(|part| part.trim_matches(',')).collect();
    let parts: Vec<String> =
        parts.into_iter().filter(|part| !part.is_empty()).map(|part| part.replace(',', ".")).collect();
    let are_numbers = parts.iter().all(|part| part.parse::<f64>().is_ok());
    (parts.len() == count && are_numbers).then(|| format!("use `.` as the decimal point: [{}]", parts.join(", ")))
}
