//! Small lights that the lens blurs: some samples look at them through the part of the lens that sees them.
//!
//! ```text
//! cargo test --test all lens_lights::
//! ```

use std::f64::consts::PI;

use abbe::math::{DMat2, DVec2, DVec3, sample_disk};
use abbe::plan::plan;
use abbe::trace::Method;

use crate::support::scenes::{Mean, films_of, scene};

/// Radius of the lens and distance in focus, in scene units, and pixels along each side.
const LENS: f64 = 0.4;
const FOCUS: f64 = 4.0;
const SIDE: u32 = 48;

/// Returns a view along -z from z = 5, through a lens.
fn view(camera: &str, film: &str, rest: &str) -> String {
    format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], {camera}, \
         lens = {{ radius = {LENS}, focus_distance = {FOCUS} }} }}\n\
         film = {{ width = {SIDE}, height = {SIDE}{film} }}\nrender = {{ samples = 16 }}\n{rest}\n\
         [material.lamp]\nemissive.radiance = {{ rgb = [1, 2, 0.5], scale = 1000 }}\n\
         [material.wall]\ndiffuse.reflectance = 0\n"
    )
}

const PERSPECTIVE: &str = "vertical_fov = 20";
const PARALLEL: &str = "projection = \"orthographic\", height = 4";

fn bulb(center: [f64; 3], radius: f64) -> String {
    format!("[[object]]\nmaterial = \"lamp\"\nshape.sphere = {{ center = {center:?}, radius = {radius} }}\n")
}

/// Returns a square around the axis of the view that lets no light pass.
fn wall(z: f64, half: f64) -> String {
    format!(
        "[[object]]\nmaterial = \"wall\"\n\
         shape.quad = {{ center = [0, 0, {z}], u = [{half}, 0, 0], v = [0, {half}, 0] }}\n"
    )
}

/// Returns how much a lamp of radiance 1 and a small area across the view makes of the mean of the film, by the mean of
/// the importance of its place over the lens.
fn share(text: &str, center: [f64; 3], area: f64) -> f64 {
    let camera = &scene(text).camera;
    let u = |i: u32| [(f64::from(i) + 0.5) / 1e4, (f64::from(i) * 0.618_034).fract()];
    let importance = |i: u32| camera.see(center.into(), u(i)).expect("it is before the camera").importance;
    area * (0..10_000).map(importance).sum::<f64>() / 1e4 / f64::from(SIDE * SIDE)
}

fn rgb(factor: f64) -> [f64; 3] {
    [1.0, 2.0, 0.5].map(|color| 1000.0 * color * factor)
}

fn films(text: &str) -> (Method, Mean) {
    let scene = scene(text);
    let method = Method { samples: 64, ..plan(&scene).method };
    let films = films_of(&scene, &method, 0..32);
    (method, Mean::over_seeds(&films))
}

#[test]
fn bulbs_out_of_focus_have_all_their_light_wherever_they_are() {
    let radius = 0.004;
    let (far, near, aside) = ([0.2, 0.3, -3.0], [-0.1, 0.05, 3.0], [0.9, -0.8, -3.0]);
    let pane = "[material.pane]\nthin.index = 1.5\n[[object]]\nmaterial = \"pane\"\n\
                shape.quad = { center = [0, 0, 0], u = [9, 0, 0], v = [0, 9, 0] }\n";
    let at = |camera: &str, film: &str, center| (view(camera, film, &bulb(center, radius)), center, 1.0);
    let (behind, center, _) = at(PARALLEL, "", far);
    let cases = [
        ("far", at(PERSPECTIVE, "", far)),
        ("near", at(PERSPECTIVE, "", near)),
        ("aside", at(PERSPECTIVE, "", aside)),
        ("parallel", at(PARALLEL, "", far)),
        ("a filter", at(PERSPECTIVE, ", filter = \"mitchell\"", far)),
        // Rays of the parallel view lie within 1.5 degrees of the pane's normal.
        ("behind a pane", (behind + pane, center, 0.96 / 1.04)),
    ];
    for (name, (text, center, factor)) in &cases {
        let (method, mean) = films(text);
        assert_eq!(method.lens_lights.len(), 1, "{name}");
        let expected = rgb(factor * share(text, *center, PI * radius * radius));
        mean.assert_near(expected, 3 * cases.len(), name);
        assert!(mean.worst_relative_error(expected) < 0.003, "{name}: {mean:?}, {expected:?}");
    }
}

/// A disc of the film has the light, evenly: a share of the lens sees all of it.
#[test]
fn a_blurred_bulb_is_an_even_disc() {
    let (center, radius) = ([0.1, 0.2, -3.0], 0.002);
    let text = view(PERSPECTIVE, "", &bulb(center, radius));
    let scene = scene(&text);
    let method = Method { samples: 64, ..plan(&scene).method };
    let film = &films_of(&scene, &method, 0..1)[0];
    let to_bulb = DVec3::from(center) - DVec3::new(0.0, 0.0, 5.0);
    let depth = -to_bulb.z;
    let middle = scene.camera.see(center.into(), [0.5; 2]).expect("it is before the camera").film;
    let blur = 0.5 * scene.camera.blur(depth) * f64::from(SIDE);
    let on_lens = radius / f64::abs(1.0 - depth / FOCUS);
    let expected = rgb((on_lens / LENS).powi(2) * to_bulb.length() / depth);
    let (mut inside, mut outside) = (0, 0);
    for (i, pixel) in (0..).zip(&film.pixels) {
        let from_middle = (DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) + 0.5 - middle).length();
        if from_middle < blur - 1.0 {
            // Directions to the bulb differ by up to a degree over the lens.
            assert!((f64::from(pixel.rgb[1]) / expected[1] - 1.0).abs() < 0.1, "{:?} for {expected:?}", pixel.rgb);
            inside += 1;
        } else if from_middle > blur + 1.0 {
            assert_eq!(pixel.rgb, [0.0; 3]);
            outside += 1;
        }
    }
    assert!(inside > 20 && outside > 20, "{inside}, {outside}");
}

#[test]
fn aimed_samples_find_what_samples_of_the_whole_lens_find() {
    let sun = "light = [{ sun = { toward = [0.1, 0.15, -1], angular_diameter = 1.2, irradiance = 3 } }]";
    let tube = "[[object]]\nmaterial = \"lamp\"\n\
                shape.quad = { center = [0, 0.2, -4], u = [0.6, 0.1, 0], v = [0, 0.04, 0] }\n";
    let many: String = (0..9).map(|i| bulb([0.12 * f64::from(i % 3), 0.12 * f64::from(i / 3), -3.0], 0.03)).collect();
    let sun_behind = sun.replace("[0.1, 0.15, -1], angular_diameter = 1.2", "[0.5, 0.8, 0.7], angular_diameter = 4");
    let ball = |material: &str| {
        let shape = "shape.sphere = { center = [0, 0, -3], radius = 0.8 }";
        format!("\n[material.ball]\n{material}\n[[object]]\nmaterial = \"ball\"\n{shape}\n")
    };
    let in_part = bulb([0.2, 0.3, -3.0], 0.04) + &wall(2.0, 0.12);
    let cases = [
        ("a bulb", view(PERSPECTIVE, "", &bulb([0.2, 0.3, -3.0], 0.04)), 1..=1),
        ("a bulb hidden in part", view(PERSPECTIVE, "", &in_part), 1..=1),
        ("a parallel view", view(PARALLEL, "", &bulb([0.2, 0.3, -3.0], 0.04)), 1..=1),
        ("the sun", view(PERSPECTIVE, "", sun), 1..=1),
        ("a tube", view(PERSPECTIVE, "", tube), 5..=16),
        ("many bulbs", view(PERSPECTIVE, "", &many), 9..=9),
        (
            "the sun in a chrome ball",
            view(PERSPECTIVE, "", &(sun_behind.clone() + &ball("mirror.reflectance = 0.9"))),
            1..=1,
        ),
        ("the sun in a glass ball", view(PERSPECTIVE, "", &(sun_behind + &ball("dielectric.index = 1.5"))), 1..=4),
    ];
    for (name, text, count) in &cases {
        let scene = scene(text);
        let method = plan(&scene).method;
        assert!(count.contains(&method.lens_lights.len()), "{name}: {} lights", method.lens_lights.len());
        let aimed = Mean::over_seeds(&films_of(&scene, &method, 0..32));
        let plain = Method { lens_lights: Vec::new(), samples: 256, ..method };
        let plain = Mean::over_seeds(&films_of(&scene, &plain, 100..132));
        aimed.with_joint_error(&plain).assert_near(plain.value, 3 * cases.len(), name);
    }
}

#[test]
fn lights_in_focus_or_large_or_hidden_are_left_to_all_samples() {
    let left = [
        ("in focus", view(PERSPECTIVE, "", &bulb([0.2, 0.3, 1.0], 0.004))),
        ("large", view(PERSPECTIVE, "", &bulb([0.2, 0.3, -3.0], 0.3))),
        ("behind a wall", view(PERSPECTIVE, "", &(bulb([0.2, 0.3, -3.0], 0.004) + &wall(0.0, 3.0)))),
        ("out of view", view(PERSPECTIVE, "", &bulb([5.0, 0.3, -3.0], 0.004))),
    ];
    for (name, text) in left {
        assert_eq!(plan(&scene(&text)).method.lens_lights, [], "{name}");
    }
    // The film of the pinhole has a highlight instead.
    let pinhole =
        view(PERSPECTIVE, "", &bulb([0.2, 0.3, -3.0], 0.004)).replace(&format!("radius = {LENS}"), "radius = 0");
    let method = plan(&scene(&pinhole)).method;
    assert_eq!((method.lens_lights.len(), method.highlights.len()), (0, 1));
}

/// Discs of the lens cover all of a light, at any distance and angle: what lies beyond would be noise.
#[test]
fn no_light_is_left_to_the_samples_of_the_whole_lens() {
    let centers = [[0.2, 0.3, -3.0], [-0.45, 0.4, 2.0], [1.3, -1.3, -3.0], [0.05, 0.05, 4.0]];
    for (camera, center) in
        [PERSPECTIVE, PARALLEL].into_iter().flat_map(|camera| centers.map(|center| (camera, center)))
    {
        let radius = 0.002 * (5.0 - center[2]);
        let scene = scene(&view(camera, "", &bulb(center, radius)));
        let method = plan(&scene).method;
        let [light] = &method.lens_lights[..] else { panic!("{center:?}: {:?}", method.lens_lights) };
        let mut hits = 0;
        let [to_lens, radii] = [light.per_pixel, light.radii].map(|columns| {
            let [x, y] = columns.map(DVec2::from);
            DMat2::from_cols(x, y)
        });
        let to_film = to_lens.inverse();
        for i in 0..200_000 {
            let [a, b, c, d] = [0.618_034, 0.754_878, 0.569_840, 0.819_173].map(|step| (f64::from(i) * step).fract());
            let place = sample_disk([a, b]) * LENS;
            // Points of the film that see places near the bulb through this point of the lens.
            let near = radii * (2.0 * DVec2::new(c, d) - 1.0) * 2.0;
            let film = DVec2::from(light.center) + to_film * (place + near);
            let ray = scene.camera.ray_from_lens(film, place);
            let to_bulb = DVec3::from(center) - ray.origin;
            if to_bulb.cross(ray.direction).length() < radius {
                let middle = to_lens * (film - DVec2::from(light.center));
                assert!((radii.inverse() * (place - middle)).length() < 1.0, "{camera}, {center:?}");
                hits += 1;
            }
        }
        assert!(hits > 5000, "{hits}");
    }
}
