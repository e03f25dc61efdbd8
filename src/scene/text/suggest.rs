//! What an author may have meant.

use std::path::Path;

use toml::de::{DeArray, DeValue};

use super::tree::Node;
use crate::error::{ends_in, nearest};
use crate::film::layer_elsewhere;
use crate::scene::share;
use crate::scene::web_color::{of_bytes, of_srgb, web_color};
use crate::spectrum::ColorSpace;

/// What is called by other words in other renderers, and these words; of several that are known, the first is meant.
const ELSEWHERE: [(&str, &[&str]); 34] = [
    ("index", &["ior", "eta", "int_ior"]),
    ("reflectance", &["albedo", "color", "reflection", "reflectivity"]),
    ("rgb", &["color"]),
    ("image", &["texture", "map", "path", "filename"]),
    ("blackbody", &["temperature", "kelvin"]),
    ("samples", &["spectrum", "spp", "samples_per_pixel", "sample_count"]),
    ("toward", &["direction"]),
    ("sun", &["directional", "distant"]),
    ("intensity", &["radiance", "power"]),
    ("irradiance", &["intensity", "illuminance"]),
    ("radiance", &["intensity", "power", "strength", "brightness", "color"]),
    ("look_at", &["target", "to"]),
    ("position", &["from", "eye", "origin", "location"]),
    ("file", &["path", "filename"]),
    ("center", &["position"]),
    ("point", &["position", "center"]),
    ("degrees", &["angle"]),
    ("transform", &["translate", "rotate", "scale", "rotation"]),
    ("diffuse", &["matte", "lambert", "lambertian"]),
    ("conductor", &["metal", "roughconductor"]),
    ("dielectric", &["glass", "roughdielectric"]),
    ("plastic", &["glossy", "roughplastic", "coateddiffuse", "principled"]),
    ("emissive", &["light"]),
    ("max_bounces", &["max_depth"]),
    ("error", &["noise_threshold"]),
    ("scale", &["strength", "multiplier", "intensity"]),
    ("amount", &["factor"]),
    ("quad", &["rectangle", "rect"]),
    ("sphere", &["ball"]),
    ("plane", &["floor", "ground"]),
    ("disc", &["circle"]),
    ("mesh", &["cylinder", "cone", "torus", "model", "obj"]),
    ("checker", &["checkerboard", "chessboard"]),
    ("environment", &["envmap", "infinite", "sky", "skylight", "dome", "hdri", "ambient", "background"]),
];

/// Words of other renderers that no one word here stands for: one of the names that are known beside them, and what to
/// do.
const IN_OTHER_WORDS: [(&[&str], &str, &str); 42] = [
    (&["box", "cuboid"], "cube", "write cube = { center = [0, 1, 0], size = [2, 1, 3] }"),
    (
        &["environment", "sun", "point", "spot", "sky"],
        "include",
        "lights are [[light]]: write that, and below it the kind, such as environment = { radiance = 1 }",
    ),
    (
        &["sphere", "plane", "cube", "quad", "disc", "triangle", "mesh", "shape"],
        "include",
        "surfaces are [[object]]: write that, and below it shape.sphere = { center = [0, 1, 0], radius = 1 }",
    ),
    (&["type", "kind"], "environment", "the kind is a key itself: point = { position = [0, 3, 0], intensity = 10 }"),
    (&["type", "kind"], "shape", "the kind of a shape is a key: shape.sphere = { center = [0, 1, 0], radius = 1 }"),
    (
        &["center", "radius", "size", "normal", "points", "faces", "file", "u", "v"],
        "shape",
        "write it into the braces of a shape: shape.sphere = { center = [0, 1, 0], radius = 1 }",
    ),
    (
        &["color", "albedo", "base_color", "reflectance", "roughness"],
        "diffuse",
        "write a kind around it, such as diffuse = { reflectance = { rgb = [0.7, 0.6, 0.5] } }",
    ),
    (
        &["roughness"],
        "fluorescence",
        "what is `diffuse` is matte; under a coat it is plastic = { reflectance = 0.7, roughness = 0.3 }",
    ),
    (
        &["emission", "emissive", "radiance"],
        "fluorescence",
        "a surface that shines has a material of its own: emissive = { radiance = 10 }",
    ),
    (&["color", "tint"], "intensity", "write intensity = { rgb = [10, 8, 6] } for a light of a color"),
    (&["min", "max", "corner", "corners"], "size", "write its middle as `center`, and size = [2, 1, 3]"),
    (&["resolution", "size"], "color_space", "write width = 640 and height = 360"),
    (
        &["horizontal_fov", "fov_x", "focal_length"],
        "vertical_fov",
        "write vertical_fov, in degrees: 27 sees as much as a lens of 50 mm before film of 36 x 24 mm",
    ),
    (
        &["aperture", "f_stop", "fstop", "focus", "focus_distance", "focal_distance", "dof", "depth_of_field"],
        "lens",
        "write lens = { radius = 0.02, focus_distance = 6 }",
    ),
    (
        &["type", "orthographic", "perspective", "equirectangular"],
        "vertical_fov",
        "write projection = \"orthographic\", \"perspective\" or \"equirectangular\"",
    ),
    (
        &["direction", "forward", "rotation", "rotate", "transform", "matrix"],
        "vertical_fov",
        "write look_at, the point in the middle of the image, and up",
    ),
    (
        &["roll"],
        "vertical_fov",
        "`up` rolls the camera, as up = [0.17, 0.98, 0] does by 10 degrees if it looks along -z",
    ),
    (&["far", "clip_end"], "vertical_fov", "nothing is too far away to be seen: leave it out"),
    (
        &["bounces", "depth"],
        "max_bounces",
        "write max_bounces = 8, or diffuse_bounces for those of matte surfaces alone",
    ),
    (
        &["f_number", "f_stop", "fstop", "aperture"],
        "focus_distance",
        "write `radius`, in scene units: the focal length over twice the f-number",
    ),
    (
        &["area", "quad", "rect", "disc", "sphere", "mesh", "shape", "emissive"],
        "environment",
        "a surface that shines is an [[object]] whose material is `emissive`",
    ),
    (
        &["radiance", "intensity", "irradiance", "power", "color", "strength"],
        "environment",
        "write the kind of light around it, such as environment = { radiance = 1 }",
    ),
    (&["direction", "from"], "angular_diameter", "write `toward`, from the scene to the sun, not the way of its light"),
    (
        &["fov", "field_of_view"],
        "vertical_fov",
        "write vertical_fov, in degrees; elsewhere `fov` may be that of the width or of the shorter side",
    ),
    (
        &["color", "tint"],
        "priority",
        "write transmittance = { rgb = [0.9, 0.5, 0.5] } for the color of its surface, or `absorption` for that of its depth",
    ),
    (&["a", "b", "first", "second"], "amount", "write materials = [\"one\", \"other\"]"),
    (&["alpha"], "roughness", "write `roughness`, the square root of alpha"),
    (&["roughness"], "reflectance", "a rough mirror is of metal: conductor = { metal = \"Al\", roughness = 0.2 }"),
    (
        &["color", "reflectance", "albedo", "tint"],
        "metal",
        "a metal has the color of its kind, such as \"Cu\"; mirror = { reflectance = { rgb = [0.9, 0.6, 0.5] } } has any",
    ),
    (&RELIEF, "reflectance", OF_RELIEF),
    (&RELIEF, "metal", OF_RELIEF),
    (
        &["opacity", "transparency"],
        "fluorescence",
        "holes are a material around this one: mask = { material = \"NAME\", opacity = 0.5 }",
    ),
    (
        &["position", "location"],
        "instances",
        "write the `center` of its shape, or transform = [{ translate = [0, 1, 0] }]",
    ),
    (
        &["smooth"],
        "instances",
        "write it into the braces of a mesh: shape.mesh = { file = \"cup.obj\", smooth = true }",
    ),
    (&["priority"], "instances", "write it into the material: dielectric = { index = 1.5, priority = 1 }"),
    (
        &["rotate", "rotation"],
        "wrap",
        "an image of the sky is turned by `transform` beside `radiance`, any other with its object",
    ),
    (&["color_space", "colorspace", "gamma"], "wrap", "write encoding = \"srgb\" or encoding = \"linear\""),
    (
        &["elevation", "azimuth", "altitude"],
        "angular_diameter",
        "write `toward`, from the scene to the sun: [0, 1, 1] is 45 degrees high",
    ),
    (&["radians"], "degrees", "write `degrees`: a half turn is 180"),
    (
        &["cct", "daylight", "color_temperature"],
        "blackbody",
        "write blackbody = 3000 for what glows, or illuminant = \"D65\" for daylight",
    ),
    (&["diameter"], "radius", "write `radius`, half of it"),
    (
        &["diffuse", "emissive", "dielectric", "conductor", "mirror", "plastic", "thin", "color", "roughness"],
        "shape",
        "write it in a [material.NAME], and material = \"NAME\" here",
    ),
];

/// Keys of an object that stand in its material by mistake, and where they belong.
const RELIEF: [&str; 4] = ["normal_map", "bump_map", "normal", "bump"];
const OF_RELIEF: &str = "write normal_map or bump_map in the [[object]], beside its `material`";

/// Where a key belongs that stands beside a kind of material, if not into that.
pub(super) fn outside_of_material(word: &str) -> Option<&'static str> {
    RELIEF.contains(&word).then_some(OF_RELIEF)
}

/// Keys that no section has, and where what they ask for is said. What camera, film and render know holds one of
/// [`OF_SECTIONS`].
const OF_NO_SECTION: [(&[&str], &str); 9] = [
    (
        &["exposure", "iso", "gamma", "tonemap", "tone_mapping", "brightness"],
        "the EXR holds the light itself; --exposure 2 brightens the picture of --png",
    ),
    (
        &["white_balance", "whitebalance", "white_point"],
        "colors are those of the light: balance them afterwards, or light by numbers, which are white",
    ),
    (&["denoise", "denoiser"], "render the layers albedo and N, and then: python tools/denoise.py out.exr"),
    (&["threads"], "it is an argument of the command: --threads 4"),
    (&["output", "file", "filename"], "it is an argument of the command: --exr out.exr"),
    (&["frame", "frames"], "it is an argument of the command: --frame 1-24"),
    (&["fps", "frame_rate", "frames_per_second"], "write metadata = { frames_per_second = 24 } in [film]"),
    (&["motion_blur", "shutter", "shutter_speed"], "an image shows one moment: there is no motion blur"),
    (
        &["background", "transparent"],
        "A is 0 where no object is; a sky is a [[light]], and visible_to_camera = false beside it hides it",
    ),
];
const OF_SECTIONS: [&str; 3] = ["vertical_fov", "color_space", "diffuse_bounces"];

/// Keys of an object that stand in its shape by mistake, and keys of which a shape has one.
const BESIDE_SHAPE: [&[&str]; 2] =
    [&["material", "transform", "instances", "name", "visible_to_camera"], &["center", "normal", "file", "points"]];

/// Sections whose keys are looked for in others: a key that this one alone has, and those that are mistaken.
const MISTAKEN_SECTIONS: [(&str, &str, &[&str]); 3] = [
    ("camera", "look_at", &["position", "up", "vertical_fov", "lens", "projection", "shift", "polarizer", "near"]),
    ("film", "color_space", &["width", "filter", "crop", "overscan", "layers", "precision", "compression", "stokes"]),
    (
        "render",
        "diffuse_bounces",
        &["samples", "seed", "error", "time", "model", "max_bounces", "adaptive", "caustics", "polarization", "spp"],
    ),
];

/// The known name that was meant by the value or key `word`, or all of them; `key` is the key of a value.
pub(super) fn suggestion(key: &str, word: &str, known: &[&str]) -> String {
    let layer = || (key == "layers").then(|| layer_elsewhere(word)).flatten().map(str::to_owned);
    if let Some(help) = layer().or_else(|| in_other_words(word, known)) {
        return help;
    }
    match meant(key, word, known) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known here: {}", known.join(", ")),
    }
}

/// What to do where no known name is meant by a word, but it is known what is.
fn in_other_words(word: &str, known: &[&str]) -> Option<String> {
    let help = IN_OTHER_WORDS.iter().find(|(words, beside, _)| words.contains(&word) && known.contains(beside));
    let of_spectrum = || {
        let word = if matches!(word, "texture" | "map") { "image" } else { word };
        let is_kind = matches!(word, "image" | "rgb" | "samples" | "blackbody" | "illuminant");
        let of_light = matches!(word, "blackbody" | "illuminant");
        let spectra = [("reflectance", !of_light), ("radiance", true), ("irradiance", true), ("intensity", true)];
        let (key, _) = spectra.into_iter().find(|(key, fits)| is_kind && *fits && known.contains(key))?;
        Some(format!("write {key} = {{ {word} = .. }}"))
    };
    let of_no_section = || {
        let is_section = OF_SECTIONS.iter().any(|own| known.contains(own));
        let (_, help) = OF_NO_SECTION.iter().find(|(words, _)| is_section && words.contains(&word))?;
        Some((*help).to_owned())
    };
    let [of_object, of_shape] = BESIDE_SHAPE;
    let is_within = of_object.contains(&word) && of_shape.iter().any(|key| known.contains(key));
    help.map(|(.., help)| (*help).to_owned())
        .or_else(|| is_within.then(|| "write it beside `shape`, in its [[object]]".into()))
        .or_else(of_spectrum)
        .or_else(|| in_another_section(word, known))
        .or_else(of_no_section)
}

/// Where a key belongs that one section has, and another, or the file outside of all of them, does not know.
fn in_another_section(word: &str, known: &[&str]) -> Option<String> {
    let is_mistakable =
        MISTAKEN_SECTIONS.iter().any(|(section, own, _)| known.contains(own) || known.contains(section));
    let has_it = |own: &str, keys: &[&str]| !known.contains(&own) && (own == word || keys.contains(&word));
    let (section, _, keys) = MISTAKEN_SECTIONS.iter().find(|(_, own, keys)| is_mistakable && has_it(own, keys))?;
    let mut meant = ELSEWHERE.iter().filter(|(here, words)| keys.contains(here) && words.contains(&word));
    let here = meant.next().map_or(word, |(here, _)| here);
    Some(format!("write {here} in [{section}]"))
}

/// The known name that was meant by the value or key `word`, if any is near.
pub(super) fn meant<'a>(key: &str, word: &str, known: &[&'a str]) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let is_part = |name: &str| name.to_lowercase().starts_with(&lower) || name.split('_').any(|part| part == word);
    let part_of = || known.iter().copied().find(|name| is_part(name));
    let elsewhere = || {
        let mut meant = ELSEWHERE.iter().filter(|(_, words)| words.contains(&word)).map(|(here, _)| *here);
        meant.find(|here| known.contains(here))
    };
    let space = || (key == "color_space").then(|| ColorSpace::called(word)).flatten().map(ColorSpace::interop_id);
    nearest(word, known.iter().copied()).or_else(part_of).or_else(elsewhere).or_else(space)
}

/// Tables of which people write the one value that matters most, and its key.
const SHORT: [(&str, &str); 9] = [
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

/// How to write a table in place of which its one value stands.
fn in_short(key: &str, value: &DeValue, written: &str) -> Option<String> {
    let (_, inner) = SHORT.iter().find(|short| short.0 == key)?;
    let is_color = matches!(*inner, "reflectance" | "radiance");
    let whole = |value: String| Some(format!("write {{ {inner} = {value} }}"));
    match value {
        DeValue::Integer(_) | DeValue::Float(_) if is_color || *inner == "index" => whole(written.into()),
        DeValue::String(text) if is_color && ends_in(Path::new(&**text), &["png", "jpg", "jpeg", "exr", "hdr"]) => {
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

/// How to write a point or a direction that is a text.
fn vector(key: &str, text: &str) -> Option<String> {
    let axes = [("x", "1, 0, 0"), ("y", "0, 1, 0"), ("z", "0, 0, 1")];
    let axis = axes.iter().find(|(name, _)| matches!(key, "up" | "normal" | "axis" | "toward") && text == *name);
    let parts: Vec<&str> = text.split([',', ' ', '[', ']', '(', ')']).filter(|part| !part.is_empty()).collect();
    let is_list = parts.len() == 3 && parts.iter().all(|part| part.parse::<f64>().is_ok_and(f64::is_finite));
    axis.map(|(_, list)| format!("write [{list}]")).or_else(|| is_list.then(|| format!("write [{}]", parts.join(", "))))
}

/// How to write a color whose key says that it is sRGB, or is otherwise one of other programs.
pub(super) fn color_elsewhere(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let word = word.to_lowercase();
    if !known.contains(&"rgb") || !COLORS.contains(&&*word) {
        return None;
    }
    let number = |node: &DeValue| match node {
        DeValue::Integer(integer) => integer.as_str().parse().ok(),
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => None,
    };
    let listed = |list: &DeArray| {
        let color = list.iter().map(|node| number(node.get_ref())).collect::<Option<Vec<f64>>>()?;
        let color: [f64; 3] = color.try_into().ok()?;
        if matches!(&*word, "hsv" | "hsl") {
            return None;
        }
        let is_srgb = word == "srgb" && color.iter().all(|x| (0.0..=1.0).contains(x));
        of_bytes(color).or_else(|| is_srgb.then(|| of_srgb(color)))
    };
    let color = match value {
        DeValue::String(text) => web_color(text).or_else(|| web_color(&format!("#{text}"))),
        DeValue::Array(list) => listed(list),
        _ => None,
    };
    let is_other = !matches!(&*word, "color" | "rgba");
    let color = color.or_else(|| is_other.then(|| "[red, green, blue]".into()))?;
    Some(format!("write rgb = {color}, in linear light"))
}

/// Keys of colors in other programs.
const COLORS: [&str; 11] = ["srgb", "hex", "html", "css", "web", "rgb255", "rgb8", "hsv", "hsl", "color", "rgba"];

/// What is wanted where keys are read.
pub(super) const TABLE: &str = "a table, { .. }";

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
        DeValue::String(_) | DeValue::Integer(_) if key == "rgb" && wanted == "a list of 3 numbers" => {
            let color = web_color(value.as_str().unwrap_or(written));
            color.map(|color| format!("write {color}, in linear light")).or_else(|| vector(key, value.as_str()?))
        }
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
            let most = wanted.rsplit(' ').next().and_then(|most| most.parse::<f64>().ok());
            let fits = float >= 0.0 && float.fract() == 0.0 && most.is_none_or(|most| float <= most);
            fits.then(|| format!("write {float}"))
        }
        DeValue::Integer(_) if wanted == "a number" => Some(format!("write it with a decimal point: {written}.0")),
        DeValue::String(text) if wanted == "true or false" && matches!(&**text, "true" | "false") => {
            Some(format!("write it without quotes: {text}"))
        }
        DeValue::String(_) if wanted == TABLE && key == "mesh" => Some(format!("write {{ file = {written} }}")),
        DeValue::String(_) if wanted == TABLE && key.ends_with("_map") => {
            Some(format!("write {{ image = {written}, .. }}"))
        }
        DeValue::String(text) if wanted == "a list of 3 numbers" => vector(key, text),
        DeValue::Integer(_) | DeValue::Float(_) if wanted == "a list of 3 numbers" && key == "axis" => {
            Some("it is a direction in space, such as [1, 0, 0]".into())
        }
        DeValue::Array(list) if wanted == TABLE && key == "abbe" && list.len() == 2 => {
            let (nd, vd) = written.trim_matches(['[', ']']).split_once(',')?;
            Some(format!("write {{ nd = {}, vd = {} }}", nd.trim(), vd.trim()))
        }
        DeValue::Table(table) if wanted == "a list of 3 numbers" && table.contains_key("x") => {
            Some("write [x, y, z]".into())
        }
        _ if wanted == TABLE && SHORT.iter().any(|short| short.0 == key) => in_short(key, value, written),
        _ if wanted == TABLE && key == "rotate" => Some("write { axis = [0, 1, 0], degrees = 30 }".into()),
        DeValue::Array(_) if key == "scale" && wanted == "a number" => {
            Some("`scale` multiplies the values; copies of an image are set by `repeat`".into())
        }
        DeValue::Array(_) if key == "image" => Some("write the name of its file, such as \"wood.png\"".into()),
        DeValue::Table(_) if key == "roughness" => {
            Some("it is the same all over: two materials `mix` by an image".into())
        }
        DeValue::Array(entries) if wanted.starts_with("a number, a catalog name") => spectrum_of(entries, written),
        DeValue::Table(_) if key == "material" => Some("define it as [material.NAME] and write \"NAME\" here".into()),
        DeValue::Table(_) if wanted == "a list" => Some("put it in brackets: [{ .. }]".into()),
        _ => None,
    }
}

/// How to write what a list seems to mean that stands in place of a spectrum.
fn spectrum_of(entries: &DeArray, written: &str) -> Option<String> {
    let are_numbers =
        |list: &DeArray, count: usize| list.len() == count && list.iter().all(|entry| is_number(entry.get_ref()));
    if are_numbers(entries, 3) {
        return Some(format!("write {{ rgb = {written} }} for a color"));
    }
    let is_pair = |entry: &Node| entry.get_ref().as_array().is_some_and(|pair| are_numbers(pair, 2));
    (!entries.is_empty() && entries.iter().all(is_pair))
        .then(|| "write { samples = [[wavelength in nm, value], ..] } for a spectrum".into())
}

/// How to write a list that has so many numbers if commas in them are points.
pub(super) fn with_points(written: &str, count: usize) -> Option<String> {
    let inner = written.strip_prefix('[')?.strip_suffix(']')?;
    let parts: Vec<&str> = inner.split([' ', '\t', ';']).map(|part| part.trim_matches(',')).collect();
    let parts: Vec<String> =
        parts.into_iter().filter(|part| !part.is_empty()).map(|part| part.replace(',', ".")).collect();
    let are_numbers = parts.iter().all(|part| part.parse::<f64>().is_ok());
    (parts.len() == count && are_numbers).then(|| format!("a decimal point is written `.`: [{}]", parts.join(", ")))
}
