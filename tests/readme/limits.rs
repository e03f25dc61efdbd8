//! The numbers in the section "Limits" of the reference are those of the code.

use super::{BALL, FILM, VIEW, mistakes, page, scene_around, scene_with};

/// Writes a scene that contains a number.
type SceneWriter = fn(&str) -> String;

/// The beginning of each row of the first table, and a scene that contains a number there.
const NUMBERS: [(&str, SceneWriter); 35] = [
    ("`film.width`", |x| scene_around(&fov("30"), &format!("width = {x}, height = 1"), "", "")),
    ("`filter`: the `radius`", |x| film(&format!("filter = {{ tent = {{ radius = {x} }} }}"))),
    ("`filter`: the `sigma`", |x| film(&format!("filter = {{ gaussian = {{ sigma = {x} }} }}"))),
    ("`white_luminance`", |x| film(&format!("radiometry = \"absolute\", white_luminance = {x}"))),
    ("`frames_per_second`", |x| film(&format!("metadata = {{ frames_per_second = {x} }}"))),
    ("`spectral`: `from`", |x| film(&format!("spectral = {{ from = {x}, to = {x} }}"))),
    ("`spectral`: `step`", |x| film(&format!("spectral = {{ step = {x} }}"))),
    ("`samples`, of", |x| render(&format!("samples = {x}"))),
    ("`seed`", |x| render(&format!("seed = {x}"))),
    ("`error`", |x| render(&format!("error = {x}"))),
    ("`max_bounces`", |x| render(&format!("max_bounces = {x}, diffuse_bounces = {x}"))),
    ("`meters_per_unit`", |x| render(&format!("meters_per_unit = {x}"))),
    ("`vertical_fov`", |x| camera(&fov(x))),
    ("`shift`", |x| camera(&format!("{}, shift = [{x}, 0]", fov("30")))),
    ("`focus_distance`", |x| camera(&format!("{}, lens = {{ radius = 1, focus_distance = {x} }}", fov("30")))),
    ("`sensor_width`", |x| camera(&format!("{}, sensor_width = {x}", fov("30")))),
    ("`axis` of", |x| camera(&format!("{}, polarizer = {{ axis = {x} }}", fov("30")))),
    ("coordinates", |x| light(&format!("point = {{ position = [{x}, 0, 0], intensity = 1 }}"))),
    ("lengths", |x| shape(&format!("sphere = {{ center = [0, 0, 0], radius = {x} }}"))),
    ("shares", |x| material(&format!("diffuse = {{ reflectance = {x} }}"))),
    ("light", |x| material(&format!("emissive = {{ radiance = {x} }}"))),
    ("the first wavelength", |x| material(&format!("diffuse = {{ reflectance = {{ samples = [[{x}, 1]] }} }}"))),
    ("the wavelengths of `lines`", |x| material(&format!("emissive = {{ radiance = {{ lines = [[{x}, 1]] }} }}"))),
    ("`blackbody`", |x| material(&format!("emissive = {{ radiance = {{ blackbody = {x} }} }}"))),
    ("the `index`", |x| material(&format!("dielectric = {{ index = {x} }}"))),
    ("`n` of a metal", |x| material(&format!("conductor = {{ n = {x}, k = 1 }}"))),
    ("`k`", |x| material(&format!("conductor = {{ n = 1, k = {x} }}"))),
    ("`thickness_nm`", |x| material(&format!("thin = {{ index = 1.33, thickness_nm = {x} }}"))),
    ("`retardance`", |x| material(&format!("retarder = {{ axis = [1, 0, 0], retardance = {x} }}"))),
    ("`retardation_nm`", |x| material(&format!("retarder = {{ axis = [1, 0, 0], retardation_nm = {x} }}"))),
    ("`roughness`", |x| material(&format!("plastic = {{ reflectance = 0.5, roughness = {x} }}"))),
    ("`priority`", |x| material(&format!("dielectric = {{ index = 1.5, priority = {x} }}"))),
    ("`repeat`", |x| material(&format!("diffuse = {{ reflectance = {{ checker = [0, 1], repeat = {x} }} }}"))),
    ("`angular_diameter`", |x| {
        light(&format!("sun = {{ toward = [0, 1, 0], angular_diameter = {x}, irradiance = 1 }}"))
    }),
    ("`cone_angle`", |x| {
        light(&format!("spot = {{ position = [0, 3, 0], toward = [0, -1, 0], cone_angle = {x}, intensity = 1 }}"))
    }),
];

/// The beginning of each row of the second table, the file in which the code defines the number, and its name there.
const COUNTS: [(&str, &str, &str); 17] = [
    ("pixels of the film", "src/film/decoder_guard.rs", "MAX_PIXELS"),
    ("bytes of the layers", "src/rendering/options.rs", "MAX_LAYER_BYTES"),
    ("bands of a spectral image", "src/spectrum/wavelength_bands.rs", "MAX_COUNT"),
    ("samples of a pixel", "src/plan/stopping.rs", "MAX_SAMPLES"),
    ("lanes of a ray", "src/spectrum/table.rs", "MAX_LANES"),
    ("hero wavelengths", "src/spectrum/draw.rs", "MAX_HEROES"),
    ("layers of a coating", "src/material/stack.rs", "MAX_LAYERS"),
    ("clear materials", "src/trace/media.rs", "MAX_MEDIA"),
    ("materials that one", "src/scene/compile/material_parts.rs", "MAX_PARTS"),
    ("materials within", "src/scene/compile/material_parts.rs", "MAX_DEPTH"),
    ("pixels of an image", "src/film/decoder_guard.rs", "MAX_TEXELS"),
    ("bytes of a scene", "src/scene/text/include.rs", "MAX_BYTES"),
    ("files that include", "src/scene/text/include.rs", "MAX_DEPTH"),
    ("bytes of an OpenEXR file", "src/film/exr_file.rs", "MAX_BYTES"),
    ("corners of a face", "src/shape/ear_clipping.rs", "MAX_CORNERS"),
    ("triangles of a glTF file", "src/shape/gltf.rs", "MAX_TRIANGLES"),
    ("threads", "src/rendering/options.rs", "MAX_THREADS"),
];

/// Rows of the tables whose scenes would need a file.
const ROWS_WITH_FILES: [&str; 1] = ["`strength` of a normal map"];

fn fov(degrees: &str) -> String {
    format!("{VIEW}, vertical_fov = {degrees}")
}

fn camera(camera: &str) -> String {
    scene_around(camera, FILM, "", "")
}

fn film(film: &str) -> String {
    scene_around(&fov("30"), &format!("{FILM}, {film}"), "", "")
}

fn render(render: &str) -> String {
    scene_around(&fov("30"), FILM, render, "")
}

fn shape(shape: &str) -> String {
    scene_with(&format!("[[object]]\nshape.{shape}\nmaterial = \"a\"\n"))
}

fn material(material: &str) -> String {
    scene_with(&format!("[material.it]\n{material}\n{BALL}material = \"it\"\n"))
}

fn light(light: &str) -> String {
    scene_with(&format!("[[light]]\n{light}\n"))
}

/// Returns the cells of the rows of a table with the given head.
fn table<'p>(page: &'p str, head: &str) -> Vec<Vec<&'p str>> {
    let rows = page.lines().skip_while(|line| !line.starts_with(head)).skip(2).take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches(['|', ' ']).split(" | ").collect()).collect()
}

/// Returns a number a little beyond another, as written in a scene, or none if that one is infinite.
fn just_beyond(number: &str, up: bool) -> Option<String> {
    if let Some(number) = ["above ", "below "].into_iter().find_map(|word| number.strip_prefix(word)) {
        return Some(number.to_owned());
    }
    let (sign, digits) = (if up { 1 } else { -1 }, number.trim_start_matches('-'));
    if digits.chars().all(|digit| digit.is_ascii_digit()) {
        return Some((number.parse::<i128>().expect("a number") + sign).to_string());
    }
    let value: f64 = number.parse().expect("a number");
    let moved = value + f64::from(sign as i32) * 1e-3 * value.abs();
    value.is_finite().then(|| format!("{moved:e}"))
}

#[test]
fn numbers_at_the_limits_are_accepted_and_those_beyond_are_refused() {
    let page = page("scenes/REFERENCE.md");
    let mut rows = table(&page, "| a number | from | to |");
    rows.retain(|row| !ROWS_WITH_FILES.iter().any(|known| row[0].starts_with(known)));
    assert_eq!(rows.len(), NUMBERS.len());
    for (row, (start, scene)) in rows.iter().zip(&NUMBERS) {
        assert!(row[0].starts_with(start), "{row:?}: {start}");
        for (limit, up) in [(row[1], false), (row[2], true)] {
            if !limit.contains(' ') {
                assert_eq!(mistakes(&scene(limit)), [""; 0], "{row:?}");
            }
            if let Some(wrong) = just_beyond(limit, up) {
                assert_ne!(mistakes(&scene(&wrong)), [""; 0], "{row:?}: {wrong}");
            }
        }
    }
}

#[test]
fn there_may_be_as_many_as_the_code_says() {
    let page = page("scenes/REFERENCE.md");
    let rows = table(&page, "| what | at most | more of them |");
    assert_eq!(rows.len(), COUNTS.len());
    for (row, (start, path, name)) in rows.iter().zip(&COUNTS) {
        assert!(row[0].starts_with(start), "{row:?}: {start}");
        let code = super::page(path);
        let lines = code.lines().filter_map(|line| line.split_once(&format!("const {name}: ")));
        let numbers: Vec<u64> =
            lines.map(|(_, rest)| number(rest.split_once(" = ").expect("it has a value").1)).collect();
        assert_eq!(numbers, [row[1].parse::<u64>().expect("a number")], "{row:?}: {path}");
    }
}

/// Evaluates a whole number of the code, such as `1 << 12;`.
fn number(text: &str) -> u64 {
    let text = text.trim_end_matches(';').replace('_', "");
    let parts: Vec<u64> = text.split(" << ").map(|part| part.parse().expect("a number")).collect();
    parts.into_iter().reduce(|number, bits| number << bits).expect("there is a number")
}
