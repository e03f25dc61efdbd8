//! Names in other programs, and what to write here instead.

use std::path::Path;

use toml::de::{DeArray, DeValue};

use super::named_file::{IMAGES, TABLES};
use crate::error::has_extension;
use crate::scene::web_color::{bytes_to_linear, srgb_to_linear, web_color};

/// Names here, each with its names in other renderers. If several of the names here are known, the first is meant.
const ALIASES: [(&str, &[&str]); 55] = [
    ("index", &["ior", "eta", "int_ior"]),
    ("reflectance", &["albedo", "color", "base_color", "reflection", "reflectivity"]),
    ("rgb", &["color"]),
    ("image", &["texture", "map", "path", "filename"]),
    ("blackbody", &["temperature", "kelvin"]),
    ("samples", &["spectrum", "spp", "samples_per_pixel", "sample_count"]),
    ("toward", &["direction"]),
    ("sun", &["directional", "distant"]),
    ("intensity", &["radiance", "power", "strength", "luminous_intensity", "candela"]),
    ("irradiance", &["intensity", "illuminance", "strength", "power"]),
    ("radiance", &["intensity", "power", "strength", "brightness", "luminance", "color"]),
    ("look_at", &["target", "to"]),
    ("near", &["clip_start", "near_clip"]),
    ("vertical_fov", &["fov_y", "fovy", "yfov", "vfov", "fov_vertical"]),
    ("position", &["from", "eye", "origin", "location"]),
    ("file", &["path", "filename"]),
    ("center", &["position", "none", "pinhole"]),
    ("point", &["position", "center"]),
    ("degrees", &["angle"]),
    ("translate", &["move", "position", "offset", "shift"]),
    ("depth", &["strength", "height", "amount"]),
    ("transmittance", &["transmission"]),
    ("film", &["image", "output"]),
    ("render", &["integrator", "sampler", "settings"]),
    ("axis", &["angle"]),
    ("angular_diameter", &["angle", "angular_size"]),
    ("blend", &["penumbra"]),
    ("visible_to_camera", &["camera_visible", "camera_visibility", "primary_visibility"]),
    ("sides", &["two_sided", "twosided", "double_sided"]),
    ("repeat", &["tiling", "tile", "tiles", "uv_scale"]),
    ("points", &["vertices", "positions"]),
    ("faces", &["indices", "triangles"]),
    ("transform", &["translate", "rotate", "scale", "rotation"]),
    ("diffuse", &["matte", "lambert", "lambertian", "absorber", "black"]),
    ("conductor", &["metal", "roughconductor"]),
    ("dielectric", &["glass", "roughdielectric"]),
    ("plastic", &["glossy", "roughplastic", "coateddiffuse", "principled"]),
    ("emissive", &["light"]),
    ("max_bounces", &["max_depth"]),
    ("error", &["noise_threshold"]),
    ("scale", &["strength", "multiplier", "intensity"]),
    ("amount", &["factor", "weight", "weights", "ratio"]),
    ("frames_per_second", &["fps", "frame_rate"]),
    ("thin", &["film", "thin_film", "soap", "pane"]),
    ("spot", &["laser"]),
    ("lines", &["wavelength", "laser"]),
    ("from", &["start"]),
    ("to", &["end"]),
    ("quad", &["rectangle", "rect"]),
    ("sphere", &["ball"]),
    ("plane", &["floor", "ground"]),
    ("disc", &["circle"]),
    ("mesh", &["cylinder", "cone", "torus", "lens", "prism", "pyramid", "model", "obj"]),
    ("checker", &["checkerboard", "chessboard"]),
    ("environment", &["envmap", "infinite", "sky", "skylight", "dome", "hdri", "ambient", "background"]),
];

/// Words of other renderers for which there is no single word here, as the head of the table explains.
const IN_OTHER_WORDS: &str = include_str!("in_other_words.txt");

/// Returns what the table says about a word beside keys for which `is_beside` holds.
fn advice_on(word: &str, is_beside: impl Fn(&str) -> bool) -> Option<&'static str> {
    IN_OTHER_WORDS.lines().find_map(|line| {
        let (words, rest) = line.split_once(" | ")?;
        let (beside, help) = rest.split_once(" | ")?;
        let is_meant = words.split(' ').any(|known| known == word);
        (is_meant && beside.split(' ').any(|keys| keys.split('+').all(&is_beside))).then_some(help)
    })
}

/// Returns the names here for a word of other renderers.
pub(super) fn names_here(word: &str) -> impl Iterator<Item = &'static str> {
    ALIASES.iter().filter(move |(_, words)| words.contains(&word)).map(|(here, _)| *here)
}

/// Kinds of materials, each with a key of its own. A word of other renderers beside a kind is explained as if it stood
/// inside.
const KIND_KEYS: [(&str, &str); 4] =
    [("diffuse", "fluorescence"), ("mirror", "reflectance"), ("conductor", "metal"), ("dielectric", "priority")];

/// Returns where a key belongs that stands beside a kind of material, if it does not belong inside.
pub(super) fn outside_of_material(kind: &str, word: &str) -> Option<&'static str> {
    let own = KIND_KEYS.iter().find(|(known, _)| *known == kind).map(|(_, own)| *own);
    advice_on(word, |key| key == "*" || Some(key) == own)
}

/// Sections whose keys people write elsewhere: a key that only this section has, and the keys that are misplaced.
const MISTAKEN_SECTIONS: [(&str, &str, &[&str]); 3] = [
    ("camera", "look_at", &["position", "up", "vertical_fov", "lens", "projection", "shift", "polarizer", "near"]),
    (
        "film",
        "color_space",
        &["width", "height", "filter", "crop", "overscan", "layers", "precision", "compression", "stokes"],
    ),
    (
        "render",
        "diffuse_bounces",
        &["samples", "seed", "error", "time", "model", "max_bounces", "adaptive", "caustics", "polarization", "spp"],
    ),
];

/// Keys of spectra that may be an image, and keys of lights.
const IMAGE_KEYS: [&str; 2] = ["reflectance", "radiance"];
const LIGHT_KEYS: [&str; 3] = ["radiance", "irradiance", "intensity"];
const SPECTRUM_KEYS: [&str; 4] = ["reflectance", "radiance", "irradiance", "intensity"];

/// Returns what to do about a word that stands for no known name, if it is clear what it means.
pub(super) fn in_other_words(word: &str, known: &[&str]) -> Option<String> {
    let spectrum_help = || {
        let word = match word {
            "texture" | "map" => "image",
            "temperature" | "kelvin" => "blackbody",
            other => other,
        };
        let keys: &[&str] = match word {
            "image" => &IMAGE_KEYS,
            "rgb" | "samples" => &SPECTRUM_KEYS,
            "blackbody" | "illuminant" => &LIGHT_KEYS,
            _ => &[],
        };
        let key = keys.iter().find(|key| known.contains(key))?;
        Some(format!("write {key} = {{ {word} = .. }}"))
    };
    let help = advice_on(word, |key| known.contains(&key)).map(str::to_owned);
    help.or_else(spectrum_help).or_else(|| in_another_section(word, known))
}

/// Returns the section that a key belongs in, if another section, or the file outside of all sections, does not know
/// it.
fn in_another_section(word: &str, known: &[&str]) -> Option<String> {
    let is_mistakable =
        MISTAKEN_SECTIONS.iter().any(|(section, own, _)| known.contains(own) || known.contains(section));
    let belongs_there = |own: &str, keys: &[&str]| !known.contains(&own) && (own == word || keys.contains(&word));
    let (section, _, keys) =
        MISTAKEN_SECTIONS.iter().find(|(_, own, keys)| is_mistakable && belongs_there(own, keys))?;
    let here = names_here(word).find(|here| keys.contains(here)).unwrap_or(word);
    Some(format!("write {here} in [{section}]"))
}

/// Returns how to write a key of other programs that is recognized by its value.
pub(super) fn value_help(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let file_help = || image_or_table_help(word, value.as_str()?, known);
    color_help(word, value, known).or_else(file_help).or_else(|| entry_help(word, value, known))
}

/// Lists of entries, each with one of the keys of an entry, and with keys of which an entry has exactly one.
const ENTRIES: [(&str, &str, &[&str]); 2] =
    [("object", "instances", &["shape"]), ("light", "environment", &["environment", "point", "spot", "sun"])];

/// Returns how to write an object or a light that is written as a table under its name, as materials are.
fn entry_help(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let table = value.as_table()?;
    let is_meant = |(_, own, keys): &&(&str, &str, &[&str])| {
        known.contains(own) && keys.iter().any(|key| table.contains_key(*key))
    };
    let (entry, ..) = ENTRIES.iter().find(is_meant)?;
    Some(format!("write [[{entry}]], and name = \"{word}\" below it"))
}

/// Returns how to write the file of an image or of a table that a spectrum is made of.
fn image_or_table_help(word: &str, file: &str, known: &[&str]) -> Option<String> {
    let is_file = matches!(word, "file" | "filename" | "path" | "image" | "texture" | "map");
    let kinds: [(&str, &[&str], &[&str]); 2] = [("image", IMAGES, &IMAGE_KEYS), ("file", TABLES, &SPECTRUM_KEYS)];
    let (kind, _, keys) =
        kinds.into_iter().find(|(_, endings, _)| is_file && has_extension(Path::new(file), endings))?;
    let key = || keys.iter().find(|key| known.contains(key));
    match known.contains(&kind) {
        true => Some(format!("write {kind} = {file:?}")),
        false => Some(format!("write {} = {{ {kind} = {file:?} }}", key()?)),
    }
}

/// Returns how to write a color whose key says that it is sRGB, or is a key of other programs.
fn color_help(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let word = word.to_lowercase();
    if !known.contains(&"rgb") || !COLORS.contains(&&*word) {
        return None;
    }
    let number = |node: &DeValue| match node {
        DeValue::Integer(integer) => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    };
    let from_list = |list: &DeArray| {
        let color = list.iter().map(|node| number(node.get_ref())).collect::<Option<Vec<f64>>>()?;
        let color: [f64; 3] = color.try_into().ok()?;
        if matches!(&*word, "hsv" | "hsl" | "lab" | "xyz" | "xyy") {
            return None;
        }
        let is_srgb = word == "srgb" && color.iter().all(|x| (0.0..=1.0).contains(x));
        bytes_to_linear(color).or_else(|| is_srgb.then(|| srgb_to_linear(color)))
    };
    let color = match value {
        DeValue::String(text) => web_color(text).or_else(|| web_color(&format!("#{text}"))),
        DeValue::Array(list) => from_list(list),
        _ => None,
    };
    let is_other = !matches!(&*word, "color" | "rgba");
    let color = color.or_else(|| is_other.then(|| "[red, green, blue]".into()))?;
    Some(format!("write rgb = {color}, in linear light"))
}

/// Keys of colors in other programs.
const COLORS: [&str; 14] =
    ["srgb", "hex", "html", "css", "web", "rgb255", "rgb8", "hsv", "hsl", "lab", "xyz", "xyy", "color", "rgba"];

#[cfg(test)]
mod tests {
    use super::IN_OTHER_WORDS;

    #[test]
    fn every_line_of_the_table_has_words_keys_and_what_to_do() {
        for line in IN_OTHER_WORDS.lines().filter(|line| !line.starts_with('#')) {
            let fields: Vec<&str> = line.split('|').map(str::trim).collect();
            assert!(fields.len() == 3 && fields.iter().all(|field| !field.is_empty()), "{line}");
        }
    }
}
