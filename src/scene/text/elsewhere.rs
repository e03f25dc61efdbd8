//! What is called otherwise in other programs, and what to write here.

use std::path::Path;

use toml::de::{DeArray, DeValue};

use super::named_file::{IMAGES, TABLES};
use crate::error::ends_in;
use crate::scene::web_color::{of_bytes, of_srgb, web_color};

/// What is called by other words in other renderers, and these words; of several that are known, the first is meant.
const ELSEWHERE: [(&str, &[&str]); 55] = [
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

/// Words of other renderers that no one word here stands for: one of the names that are known beside them, and what to
/// do.
const IN_OTHER_WORDS: [(&[&str], &str, &str); 71] = [
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
        &["file", "mesh", "points", "faces"],
        "shape",
        "write it into the braces of a mesh: shape.mesh = { file = \"cup.obj\" }",
    ),
    (
        &["center", "radius", "size", "normal", "u", "v"],
        "shape",
        "write it into the braces of a shape: shape.sphere = { center = [0, 1, 0], radius = 1 }",
    ),
    (
        &["color", "albedo", "base_color", "reflectance", "roughness"],
        "diffuse",
        "write a kind around it, such as diffuse = { reflectance = { rgb = [0.7, 0.6, 0.5] } }",
    ),
    (
        &["roughness", "coating", "index", "specular", "gloss"],
        "fluorescence",
        "a diffuse surface is matte; under a coat it is plastic = { reflectance = 0.7, roughness = 0.3 }",
    ),
    (
        &["emission", "emissive", "radiance"],
        "fluorescence",
        "a surface that shines has a material of its own: emissive = { radiance = 10 }",
    ),
    (
        &["lumens", "lumen", "lm", "flux", "luminous_flux"],
        "intensity",
        "write `intensity`, in cd of absolute light: of a point its lumens over 4 pi, of a spot over its solid angle",
    ),
    (&IES, "intensity", OF_IES),
    (&IES, "environment", OF_IES),
    (&["color", "tint"], "intensity", "write intensity = { rgb = [10, 8, 6] } for a light of a color"),
    (&["min", "max", "corner", "corners"], "size", "write its middle as `center`, and size = [2, 1, 3]"),
    (&["width", "height", "depth"], "size", "write size = [2, 1, 3]: along x, y and z"),
    (&["radius", "half_size"], "size", "write `size`, twice it"),
    (
        &["resolution", "resolution_x", "resolution_y", "size", "aspect", "aspect_ratio"],
        "color_space",
        "write width = 640 and height = 360",
    ),
    (&["bit_depth", "bits"], "color_space", "write precision = \"half\" for 16 bits; it is 32 if absent"),
    (&["wavelengths", "bands"], "diffuse_bounces", "write model = { bands = 16 }"),
    (
        &["horizontal_fov", "fov_horizontal", "fov_x", "fovx", "xfov", "hfov", "focal_length"],
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
    (&["ortho_scale"], "vertical_fov", "write `height`, that of the view; `ortho_scale` is that of its longer side"),
    (&["far", "clip_end"], "vertical_fov", "nothing is too far away to be seen: leave it out"),
    (
        &["bounces", "depth"],
        "max_bounces",
        "write max_bounces = 8, or diffuse_bounces for those of matte surfaces alone",
    ),
    (
        &["f_number", "f_stop", "fstop", "aperture", "focal_length"],
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
    (&["a", "b", "c"], "points", "write points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]"),
    (&["hidden", "invisible"], "visible_to_camera", "write visible_to_camera = false"),
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
        &["object", "part", "group", "submesh", "node"],
        "smooth",
        "a file is one mesh: save what is to have a material of its own as another file",
    ),
    (
        &["smooth", "shade_smooth", "auto_smooth"],
        "instances",
        "write it into the braces of a mesh: shape.mesh = { file = \"cup.obj\", smooth = true }",
    ),
    (&["cast_shadow", "cast_shadows", "casts_shadows"], "instances", "every object throws a shadow: leave it out"),
    (&["scale", "rotate", "translate"], "smooth", "write it beside `shape`, as in transform = [{ scale = 2 }]"),
    (&["priority"], "instances", "write it into the material: dielectric = { index = 1.5, priority = 1 }"),
    (
        &["rotate", "rotation"],
        "wrap",
        "an image of the sky is turned by `transform` beside `radiance`, any other with its object",
    ),
    (&["exposure"], "wrap", "write `scale`, which multiplies the light: 4 is two stops"),
    (&["color_space", "colorspace", "gamma"], "wrap", "write encoding = \"srgb\" or encoding = \"linear\""),
    (
        &["elevation", "azimuth", "altitude"],
        "angular_diameter",
        "write `toward`, from the scene to the sun: [0, 1, 1] is 45 degrees high",
    ),
    (&["radians"], "degrees", "write `degrees`: a half turn is 180"),
    (&["x", "y", "z"], "degrees", "write { axis = [0, 1, 0], degrees = 30 } for a turn about y"),
    (
        &["scale", "multiplier"],
        "radiance",
        "write it into the braces of a spectrum: radiance = { image = \"sky.exr\", scale = 2 }",
    ),
    (
        &["cct", "daylight", "color_temperature"],
        "blackbody",
        "write blackbody = 3000 for what glows, or illuminant = \"D65\" for daylight",
    ),
    (&["diameter", "size"], "radius", "write `radius`, half of it"),
    (
        &["falloff", "softness", "inner_angle", "inner_cone_angle", "inner_cone", "beam_width", "hotspot"],
        "blend",
        "write `blend`, the outer share of `cone_angle` over which light falls to nothing, such as 0.15",
    ),
    (
        &["falloff", "attenuation", "decay"],
        "intensity",
        "light falls by the square of the distance from where it starts: leave it out",
    ),
    (
        &["radius", "shape"],
        "intensity",
        "it is as small as a point: a lamp of a size is an [[object]] whose material is `emissive`",
    ),
    (
        &["size", "width", "height", "normal", "corner", "corners", "points"],
        "v",
        "a quad has a middle and two halves of edges: write center = [0, 1, 0], u = [1, 0, 0], v = [0, 1, 0]",
    ),
    (&["ior", "eta", "n", "value"], "cauchy", "a number stands without braces: index = 1.5"),
    (&["name", "glass", "material"], "cauchy", "a glass stands by its name alone: index = \"N-BK7\""),
    (&["nd", "vd"], "cauchy", "write { abbe = { nd = 1.5168, vd = 64.17 } }"),
    (
        &["a", "b", "c"],
        "cauchy",
        "write { cauchy = [A, B] } of n = A + B / wavelength^2, or { sellmeier = { b = [..], c = [..] } }",
    ),
    (
        &["nd", "vd", "abbe", "abbe_number", "dispersion"],
        "priority",
        "write index = { abbe = { nd = 1.5168, vd = 64.17 } }",
    ),
    (&["name"], "illuminant", "a light by name is { illuminant = \"D65\" }"),
    (&["name"], "checker", "a name stands without braces, such as \"dark skin\""),
    (&["value"], "checker", "a number stands without braces"),
    (
        &["diffuse", "emissive", "dielectric", "conductor", "mirror", "plastic", "thin", "color", "roughness"],
        "shape",
        "write it in a [material.NAME], and material = \"NAME\" here",
    ),
];

/// Measured distributions of light.
const IES: [&str; 5] = ["ies", "ies_profile", "profile", "ldt", "goniometric"];
const OF_IES: &str = "no light is read from such files: a spot has a `cone_angle`, a `blend` and an `intensity`";

/// Keys of an object that stand in its material by mistake, and where they belong.
const RELIEF: [&str; 4] = ["normal_map", "bump_map", "normal", "bump"];
const OF_RELIEF: &str = "write normal_map or bump_map in the [[object]], beside its `material`";

/// What a word of other renderers is called here.
pub(super) fn called_here(word: &str) -> impl Iterator<Item = &'static str> {
    ELSEWHERE.iter().filter(move |(_, words)| words.contains(&word)).map(|(here, _)| *here)
}

/// Kinds of materials, each with a key of its own: what stands beside it and is a word of others is told as within it.
const OF_KINDS: [(&str, &str); 4] =
    [("diffuse", "fluorescence"), ("mirror", "reflectance"), ("conductor", "metal"), ("dielectric", "priority")];

/// Where a key belongs that stands beside a kind of material, if not into that.
pub(super) fn outside_of_material(kind: &str, word: &str) -> Option<&'static str> {
    let of_other = || {
        let (_, own) = OF_KINDS.iter().find(|(known, _)| *known == kind)?;
        let (.., help) = IN_OTHER_WORDS.iter().find(|(words, beside, _)| words.contains(&word) && beside == own)?;
        Some(*help)
    };
    if RELIEF.contains(&word) { Some(OF_RELIEF) } else { of_other() }
}

/// Keys that no section has, and where what they ask for is said. What camera, film and render know holds one of
/// [`OF_SECTIONS`].
const OF_NO_SECTION: [(&[&str], &str); 13] = [
    (
        &["exposure", "iso", "gamma", "tonemap", "tone_mapping", "view_transform", "look", "brightness"],
        "the EXR holds the light itself; --exposure 2 brightens the picture of --png",
    ),
    (
        &["white_balance", "whitebalance", "white_point"],
        "colors are those of the light: balance them afterwards, or light by numbers, which are white",
    ),
    (&["denoise", "denoiser"], "render the layers albedo and N, and then: python tools/denoise.py out.exr"),
    (&["resolution", "resolution_x", "resolution_y"], "write width = 640 and height = 360 in [film]"),
    (&["unit", "units"], "write radiometry = \"absolute\" in [film] for cd/m2, and meters_per_unit in [render]"),
    (&["threads"], "it is an argument of the command: --threads 4"),
    (
        &["clamp", "clamping", "max_radiance", "firefly_filter"],
        "no light is cut off, which would make the image too dark: leave it out",
    ),
    (&["integrator", "renderer"], "light is followed as the scene needs it: leave it out"),
    (&["output", "format", "file", "filename"], "it is an argument of the command: --exr out.exr"),
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
    [&["material", "transform", "instances", "name", "visible_to_camera"], &["center", "normal", "points"]];

/// Sections whose keys are looked for in others: a key that this one alone has, and those that are mistaken.
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

/// Keys of spectra that may be an image, and those of lights.
const OF_IMAGES: [&str; 2] = ["reflectance", "radiance"];
const OF_LIGHTS: [&str; 3] = ["radiance", "irradiance", "intensity"];
const SPECTRA: [&str; 4] = ["reflectance", "radiance", "irradiance", "intensity"];

/// Keys of planes in other programs, and what to do.
const OF_PLANES: [(&[&str], &str); 2] = [
    (
        &["x", "y", "z", "d", "height", "level", "elevation", "offset", "distance"],
        "a plane has a point and a normal: write point = [0, 0, 0], normal = [0, 1, 0]",
    ),
    (
        &["size", "width", "length", "radius", "u", "v"],
        "a plane has no end: what has edges is quad = { center = [0, 0, 0], u = [0, 0, 5], v = [5, 0, 0] }",
    ),
];
/// What to do where no known name is meant by a word, but it is known what is.
pub(super) fn in_other_words(word: &str, known: &[&str]) -> Option<String> {
    let help = IN_OTHER_WORDS.iter().find(|(words, beside, _)| words.contains(&word) && known.contains(beside));
    let of_spectrum = || {
        let word = match word {
            "texture" | "map" => "image",
            "temperature" | "kelvin" => "blackbody",
            other => other,
        };
        let keys: &[&str] = match word {
            "image" => &OF_IMAGES,
            "rgb" | "samples" => &SPECTRA,
            "blackbody" | "illuminant" => &OF_LIGHTS,
            _ => &[],
        };
        let key = keys.iter().find(|key| known.contains(key))?;
        Some(format!("write {key} = {{ {word} = .. }}"))
    };
    let of_no_section = || {
        let is_section = OF_SECTIONS.iter().any(|own| known.contains(own));
        let (_, help) = OF_NO_SECTION.iter().find(|(words, _)| is_section && words.contains(&word))?;
        Some((*help).to_owned())
    };
    let of_plane = || {
        let is_plane = known.contains(&"point") && known.contains(&"normal");
        let (_, help) = OF_PLANES.iter().find(|(words, _)| is_plane && words.contains(&word))?;
        Some((*help).to_owned())
    };
    let [of_object, of_shape] = BESIDE_SHAPE;
    let is_within = of_object.contains(&word) && of_shape.iter().any(|key| known.contains(key));
    help.map(|(.., help)| (*help).to_owned())
        .or_else(|| is_within.then(|| "write it beside `shape`, in its [[object]]".into()))
        .or_else(of_spectrum)
        .or_else(of_plane)
        .or_else(|| in_another_section(word, known))
        .or_else(of_no_section)
}

/// Where a key belongs that one section has, and another, or the file outside of all of them, does not know.
fn in_another_section(word: &str, known: &[&str]) -> Option<String> {
    let is_mistakable =
        MISTAKEN_SECTIONS.iter().any(|(section, own, _)| known.contains(own) || known.contains(section));
    let has_it = |own: &str, keys: &[&str]| !known.contains(&own) && (own == word || keys.contains(&word));
    let (section, _, keys) = MISTAKEN_SECTIONS.iter().find(|(_, own, keys)| is_mistakable && has_it(own, keys))?;
    let here = called_here(word).find(|here| keys.contains(here)).unwrap_or(word);
    Some(format!("write {here} in [{section}]"))
}
/// How to write what a key of other programs says by its value.
pub(super) fn value_elsewhere(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let of_file = || file_elsewhere(word, value.as_str()?, known);
    color_elsewhere(word, value, known).or_else(of_file).or_else(|| entry_elsewhere(word, value, known))
}

/// Entries of lists, one of their keys, and keys of which such an entry has one.
const ENTRIES: [(&str, &str, &[&str]); 2] =
    [("object", "instances", &["shape"]), ("light", "environment", &["environment", "point", "spot", "sun"])];

/// How to write an object or a light that stands as a table of its name, as materials do.
fn entry_elsewhere(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
    let table = value.as_table()?;
    let is_meant = |(_, own, keys): &&(&str, &str, &[&str])| {
        known.contains(own) && keys.iter().any(|key| table.contains_key(*key))
    };
    let (entry, ..) = ENTRIES.iter().find(is_meant)?;
    Some(format!("write [[{entry}]], and name = \"{word}\" below it"))
}

/// How to write the file of an image or a table of which a spectrum is made.
fn file_elsewhere(word: &str, file: &str, known: &[&str]) -> Option<String> {
    let is_file = matches!(word, "file" | "filename" | "path" | "image" | "texture" | "map");
    let kinds: [(&str, &[&str], &[&str]); 2] = [("image", IMAGES, &OF_IMAGES), ("file", TABLES, &SPECTRA)];
    let (kind, _, keys) = kinds.into_iter().find(|(_, endings, _)| is_file && ends_in(Path::new(file), endings))?;
    let key = || keys.iter().find(|key| known.contains(key));
    match known.contains(&kind) {
        true => Some(format!("write {kind} = {file:?}")),
        false => Some(format!("write {} = {{ {kind} = {file:?} }}", key()?)),
    }
}

/// How to write a color whose key says that it is sRGB, or is otherwise one of other programs.
fn color_elsewhere(word: &str, value: &DeValue, known: &[&str]) -> Option<String> {
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
        if matches!(&*word, "hsv" | "hsl" | "lab" | "xyz" | "xyy") {
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
const COLORS: [&str; 14] =
    ["srgb", "hex", "html", "css", "web", "rgb255", "rgb8", "hsv", "hsl", "lab", "xyz", "xyy", "color", "rgba"];
