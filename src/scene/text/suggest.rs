//! What an author may have meant.

use toml::de::DeValue;

use crate::error::nearest;
use crate::scene::share;
use crate::spectrum::ColorSpace;

/// Words of other renderers, and what is called so here.
const ELSEWHERE: [(&str, &str); 11] = [
    ("ior", "index"),
    ("eta", "index"),
    ("albedo", "reflectance"),
    ("color", "reflectance"),
    ("color", "rgb"),
    ("temperature", "blackbody"),
    ("kelvin", "blackbody"),
    ("spectrum", "samples"),
    ("direction", "toward"),
    ("directional", "sun"),
    ("distant", "sun"),
];

/// The known name that was meant by the value or key `word`, or all of them; `key` is the key of a value.
pub(super) fn suggestion(key: &str, word: &str, known: &[&str]) -> String {
    if matches!(word, "box" | "cuboid") && known.contains(&"cube") {
        return "write cube = { center = [0, 1, 0], size = [2, 1, 3] }".into();
    }
    match meant(key, word, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known here: {}", known.join(", ")),
    }
}

/// The known name that was meant by the value or key `word`, if any is near.
pub(super) fn meant<'a>(key: &str, word: &str, known: &[&'a str]) -> Option<&'a str> {
    let part_of =
        || known.iter().copied().find(|name| name.starts_with(word) || name.split('_').any(|part| part == word));
    let elsewhere = || ELSEWHERE.iter().find(|pair| pair.0 == word && known.contains(&pair.1)).map(|pair| pair.1);
    let space = || (key == "color_space").then(|| ColorSpace::called(word)).flatten().map(ColorSpace::interop_id);
    nearest(word, known.iter().copied()).or_else(part_of).or_else(elsewhere).or_else(space)
}

/// How to write what a value of the wrong type seems to mean.
pub(super) fn remedy(key: &str, value: &DeValue, wanted: &str, written: &str) -> Option<String> {
    let number = wanted == "a number" || wanted.starts_with("a whole number") || wanted.starts_with("at most");
    match value {
        DeValue::String(text) if number && text.parse::<f64>().is_ok_and(f64::is_finite) => {
            Some(format!("write it without quotes: {text}"))
        }
        DeValue::String(text) if number => match share(text) {
            Some(share) => Some(format!("write {share}")),
            _ if key == "column" => Some("columns are counted from 1".into()),
            _ if text.starts_with(|first: char| first.is_ascii_digit()) => {
                Some("a number stands alone, without quotes and unit".into())
            }
            _ if key == "blackbody" => Some(format!("write {{ illuminant = {written} }} for a light by name")),
            _ => None,
        },
        DeValue::Integer(_) | DeValue::Float(_) if key == "illuminant" => {
            Some(format!("write {{ blackbody = {written} }} for a temperature"))
        }
        DeValue::Integer(_) | DeValue::Float(_) if key == "time" && !written.starts_with('-') => {
            Some(format!("write \"{written}s\" for seconds"))
        }
        DeValue::Integer(_) | DeValue::Float(_) if wanted == "a list of 2 numbers" => match key {
            "samples" => Some("write [[wavelength in nm, value], ..]".into()),
            "lines" => Some("write [[wavelength in nm, power], ..]".into()),
            _ => None,
        },
        DeValue::Float(float) if number => {
            let float: f64 = float.as_str().parse().ok()?;
            (float >= 0.0 && float.fract() == 0.0).then(|| format!("write {float}"))
        }
        DeValue::Integer(_) if wanted == "a number" => Some(format!("write it with a decimal point: {written}.0")),
        DeValue::Array(_) if wanted.starts_with("a number, a catalog name") => {
            Some(format!("write {{ rgb = {written} }} for a color"))
        }
        DeValue::Table(_) if key == "material" => Some("define it as [material.NAME] and write \"NAME\" here".into()),
        DeValue::Table(_) if wanted == "a list" => Some("put it in brackets: [{ .. }]".into()),
        _ => None,
    }
}
