//! Caustics of skies whose light enters through openings, compared with camera paths alone.

use abbe::light::Opening;
use abbe::math::{Bounds, DVec3};
use abbe::trace::{BrightPlace, BrightPlaces, MapPasses, Method};

use super::agreement::{assert_methods_agree, camera_and_film, glass, scene_and_method};
use crate::support::scenes::{body, environment, object, quad};

/// Returns a room of 6 x 4 x 6 above the floor, with a square hole in the middle of the roof.
fn room(half: f64) -> String {
    let strip = 0.5 * (3.0 - half);
    let walls = [
        quad([0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0, 0.0, -3.0]),
        quad([3.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]),
        quad([-3.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]),
        quad([0.0, 2.0, 3.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        quad([0.0, 2.0, -3.0], [3.0, 0.0, 0.0], [0.0, 2.0, 0.0]),
        quad([half + strip, 4.0, 0.0], [strip, 0.0, 0.0], [0.0, 0.0, 3.0]),
        quad([-half - strip, 4.0, 0.0], [strip, 0.0, 0.0], [0.0, 0.0, 3.0]),
        quad([0.0, 4.0, half + strip], [half, 0.0, 0.0], [0.0, 0.0, strip]),
        quad([0.0, 4.0, -half - strip], [half, 0.0, 0.0], [0.0, 0.0, strip]),
    ];
    body("floor", "diffuse = { reflectance = 0.4 }", &walls.each_ref().map(String::as_str))
}

/// Returns a hole in the roof that faces -y.
fn hole(center: [f64; 3], half: f64) -> Opening {
    Opening { center: DVec3::from(center), half: [DVec3::X * half, DVec3::Z * half] }
}

const CAMERA: &str = "position = [1.8, 2.6, 1.8]\nlook_at = [0, 0, 0]\nvertical_fov = 50";
const BALL: &str = "sphere = { center = [0.2, 1, 0.1], radius = 0.5 }";

/// Returns a scene with a method whose bounces are aimed at the given openings.
fn scene_aimed_at(text: &str, openings: &[Opening]) -> (abbe::scene::Scene<abbe::spectrum::Curve>, Method) {
    let (scene, method) = scene_and_method(text);
    let within = Bounds { min: DVec3::new(-3.1, -0.1, -3.1), max: DVec3::new(3.1, 4.1, 3.1) };
    let place = |&Opening { center, half }: &Opening| BrightPlace { center, half, radiance: 1.0 };
    let places = openings.iter().map(place).collect();
    let bright = BrightPlaces { within, places, elsewhere: 0.1, missed: 0.0, are_openings: true };
    (scene, Method { bright: Some(bright), light_vertices: false, light_pass: None, ..method })
}

fn sky(folder: &std::path::Path) -> String {
    let file = folder.join("sky.exr");
    let at = |x: usize, y: usize| match (x, y) {
        (20..=24, 1..=3) => (60.0, 42.0, 24.0),
        _ => (0.3, 0.01 * (x + y) as f32, 0.4),
    };
    exr::prelude::write_rgb_file(&file, 64, 32, at).unwrap();
    format!("[[light]]\nenvironment = {{ radiance = {{ image = {file:?} }} }}\n")
}

/// Photons contribute exactly the light that enters through an opening, whatever lies in front of it and behind it, and
/// however much of the hole it covers.
#[test]
fn a_glass_ball_in_a_room_with_a_hole() {
    let folder = tempfile::tempdir().unwrap();
    let image = sky(folder.path());
    let even = environment(2.0);
    let scene = |light: &str, more: &str| {
        camera_and_film(CAMERA, "") + &room(0.5) + &glass("index = 1.5") + &object("glass", BALL) + light + more
    };
    let metal = body(
        "metal",
        "conductor = { metal = \"Ag\", roughness = 0.15 }",
        &["sphere = { center = [-0.9, 0.5, 0], radius = 0.4 }"],
    );
    let pane =
        body("pane", "thin = { index = 1.5 }", &["quad = { center = [0, 4, 0], u = [0.6, 0, 0], v = [0, 0, 0.6] }"]);
    let above = object("glass", "sphere = { center = [0, 4.8, 0], radius = 0.6 }");
    let about = object("glass", "cube = { center = [0, 4, 0], size = [1.4, 0.2, 1.4] }");
    let whole = hole([0.0, 4.0, 0.0], 0.5);
    let half = hole([0.2, 4.0, 0.0], 0.3);
    let high = hole([0.5, 6.0, 0.0], 1.5);
    let low = hole([0.0, 2.5, 0.0], 1.5);
    let cases = [
        ("an even sky", scene(&even, ""), vec![whole]),
        ("a part of the hole", scene(&even, ""), vec![half]),
        ("one above the other", scene(&even, ""), vec![half, high]),
        ("a rectangle within the room", scene(&even, ""), vec![low]),
        ("an image with a bright part", scene(&image, ""), vec![whole]),
        ("metal that is nearly smooth", scene(&even, &metal), vec![whole]),
        ("a pane in the hole", scene(&even, &pane), vec![whole]),
        ("a ball above the hole", scene(&even, &above), vec![whole]),
        ("a slab in the hole", scene(&even, &about), vec![whole]),
    ];
    for (what, text, openings) in &cases {
        assert_methods_agree(what, &scene_aimed_at(text, openings), [8, 32], None);
    }
    let map = Some(MapPasses { count: 8, photons: 8192, radius: 0.1, chance: 1.0 });
    assert_methods_agree("gathered", &scene_aimed_at(&scene(&even, ""), &[whole]), [8, 32], map);
}
