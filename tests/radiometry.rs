//! Absolute light: a value of the film times the luminance of its white is a luminance in cd/m^2.
//!
//! ```text
//! cargo test --test all radiometry::
//! ```

use std::f64::consts::PI;

use abbe::spectrum::visible::{color_matching, y_integral};
use abbe::{Options, Scene};

/// Luminous efficacy at the peak, in lm/W (CIE 018:2019).
const EFFICACY: f64 = 683.002;

/// Returns a view of a matte floor from straight above, or of what is there in its place.
fn scene(film: &str, model: &str, rest: &str) -> String {
    format!(
        "camera = {{ position = [0, 1, 0], look_at = [0, 0, 0], vertical_fov = 0.01 }}\n\
         film = {{ width = 2, height = 2{film} }}\n\
         render = {{ samples = 256, model = {model}, meters_per_unit = 0.1 }}\n{rest}\n"
    )
}

const FLOOR: &str = "material.gray.diffuse.reflectance = 0.5\n\
    object = [{ shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }, material = \"gray\" }]\n";

/// Returns the luminance of an image: the white luminance times Y of its mean, in the film's own color space.
fn luminance(text: &str) -> f64 {
    let scene = Scene::parse(text, "").unwrap_or_else(|error| panic!("{error}\n{text}"));
    let white = scene.format.white_luminance.unwrap_or(1.0);
    let image = abbe::render(&scene, &Options::default()).expect("it renders");
    let weights = image.film().color_space.to_xyz()[1];
    let luminance_of = |rgb: [f32; 3]| (0..3).map(|channel| weights[channel] * f64::from(rgb[channel])).sum::<f64>();
    let pixels = image.rgb();
    white * pixels.iter().map(|&rgb| luminance_of(rgb)).sum::<f64>() / pixels.len() as f64
}

#[track_caller]
fn assert_close(found: f64, expected: f64, why: &str) {
    assert!((found / expected - 1.0).abs() < 0.005, "{found} cd/m2 for {expected}: {why}");
}

#[test]
fn a_lamp_is_as_bright_as_its_units_say_in_every_model_and_space() {
    let yellow = color_matching(589.0)[1];
    let lamps = [
        ("120", 120.0),
        ("{ rgb = [2, 2, 2], scale = 3 }", 6.0),
        ("{ blackbody = 2856, luminance = 50 }", 50.0),
        ("{ illuminant = \"FL11\", luminance = 700 }", 700.0),
        ("{ samples = [[300, 0.01], [900, 0.01]] }", 0.01 * EFFICACY * y_integral()),
        ("{ samples = [[300, 1], [900, 1]], scale = 0.02 }", 0.02 * EFFICACY * y_integral()),
        ("{ samples = [[300, 1], [900, 1]], luminance = 30 }", 30.0),
        ("{ lines = [[589, 2]] }", 2.0 * EFFICACY * yellow),
    ];
    for (lamp, expected) in lamps {
        let light = format!("light = [{{ environment = {{ radiance = {lamp} }} }}]");
        for model in ["\"auto\"", "{ bands = 8 }", "\"hero\""] {
            let film = ", radiometry = \"absolute\", white_luminance = 100";
            assert_close(luminance(&scene(film, model, &light)), expected, &format!("{lamp}, {model}"));
        }
        for space in ["lin_ap0_scene", "lin_ciexyzd65_scene"] {
            let film = format!(", radiometry = \"absolute\", color_space = \"{space}\"");
            assert_close(luminance(&scene(&film, "\"auto\"", &light)), expected, &format!("{lamp}, {space}"));
        }
    }
}

#[test]
fn floors_are_lit_as_photometry_says() {
    let film = ", radiometry = \"absolute\", white_luminance = 100";
    // The lights are 2 meters above the floor, in a scene with decimeters as units. The lamp is a square of 1 dm,
    // nearly a point.
    let lamp = "{ center = [0, 20, 0], u = [0, 0, 0.5], v = [0.5, 0, 0] }";
    let square = format!(
        "material.gray.diffuse.reflectance = 0.5\nmaterial.lamp.emissive.radiance = 3000\n\
         object = [{{ shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}, material = \"gray\" }}, \
                   {{ shape.quad = {lamp}, material = \"lamp\" }}]\n"
    );
    for (rest, lux) in [
        (format!("{FLOOR}light = [{{ point = {{ position = [0, 20, 0], intensity = 500 }} }}]"), 500.0 / 4.0),
        (format!("{FLOOR}light = [{{ sun = {{ toward = [0, 1, 0], irradiance = 1000 }} }}]"), 1000.0),
        (
            format!(
                "{FLOOR}light = [{{ spot = {{ position = [0, 20, 0], toward = [0, -1, 0], cone_angle = 60, intensity = \
                 {{ samples = [[300, 0.1], [900, 0.1]] }} }} }}]"
            ),
            0.1 * EFFICACY * y_integral() / 4.0,
        ),
        (square, 3000.0 * 0.01 / 4.0),
    ] {
        assert_close(luminance(&scene(film, "\"auto\"", &rest)), 0.5 * lux / PI, &rest);
    }
}

#[test]
fn white_luminance_divides_every_kind_of_light_alike() {
    let checker = "material.lamp.emissive.radiance = { checker = [3, { rgb = [1, 1, 1] }], repeat = 0.5 }\n\
        object = [{ shape.quad = { center = [0, 0, 0], u = [0, 0, 1], v = [1, 0, 0] }, material = \"lamp\" }]\n";
    let sky = "light = [{ environment = { radiance = 4 } }]";
    for rest in [checker, sky] {
        let [one, hundred] = ["", ", white_luminance = 100"].map(|white| {
            let text = scene(&format!(", radiometry = \"absolute\"{white}"), "\"auto\"", rest);
            luminance(&text)
        });
        assert_close(hundred, one, rest);
        assert_close(luminance(&scene("", "\"auto\"", rest)), one, rest);
    }
}

#[test]
fn relative_light_is_unchanged_and_reports_no_luminance() {
    let light = "light = [{ environment = { radiance = { samples = [[300, 2], [900, 2]] } } }]";
    assert_close(luminance(&scene(", radiometry = \"relative\"", "\"auto\"", light)), 2.0, "a flat spectrum of 2");
    let scene = Scene::parse(&scene("", "\"auto\"", light), "").expect("the scene is valid");
    assert_eq!(scene.format.white_luminance, None);
}
