//! Small lights and their mirror images on the film: some samples of their pixels are aimed at them.
//!
//! ```text
//! cargo test --test all highlights::
//! ```

use std::collections::BTreeSet;
use std::f64::consts::PI;
use std::ops::Range;

use abbe::Options;
use abbe::film::Layer;
use abbe::math::DVec2;
use abbe::plan::plan;
use abbe::trace::Method;

use crate::support::scenes::{Mean, film_of, films_of, render_text_with, scene};

/// Radius of the ball and height of the view in scene units, and pixels along each side.
const RADIUS: f64 = 0.4;
const HEIGHT: f64 = 2.0;
const SIDE: u32 = 8;
/// A small lamp beside the ball.
const LAMP: &str = "[[object]]\nshape.sphere = { center = [1.5, 1, 2], radius = 0.2 }\nmaterial = \"lamp\"\n\
    [material.lamp]\nemissive.radiance = { rgb = [40, 20, 60] }\n";
/// A tube sixteen times as long as wide.
const TUBE: &str = "[[object]]\nshape.quad = { center = [1.5, 1, 2], u = [0.8, 0, 0], v = [0, 0.05, 0] }\n\
    material = \"lamp\"\n[material.lamp]\nemissive.radiance = { rgb = [40, 20, 60] }\n";
/// Irradiance by the sun.
const SUN: f64 = 3.0;

/// Returns a parallel view of a ball, off the middle of the image. `rest` has whatever else the scene needs.
fn view(film: &str, ball: &str, rest: &str) -> String {
    format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], projection = \"orthographic\", height = {HEIGHT} }}\n\
         film = {{ width = {SIDE}, height = {SIDE}{film} }}\nrender = {{ samples = 16 }}\n{rest}\n\
         [material.ball]\n{ball}\n\
         [[object]]\nshape.sphere = {{ center = [0.13, -0.21, 0], radius = {RADIUS} }}\nmaterial = \"ball\"\n"
    )
}

fn sun(toward: [f64; 3], diameter: f64) -> String {
    let rgb = "{ rgb = [1, 2, 0.5], scale = 3 }";
    format!("light = [{{ sun = {{ toward = {toward:?}, angular_diameter = {diameter}, irradiance = {rgb} }} }}]")
}

/// Returns what a mirroring ball makes of the mean of the film, by the light's direction or whatever else.
///
/// Where the normal of a ball turns by an angle, the mirrored direction turns by twice that in the plane of incidence,
/// and by 2 cos(theta) times that across it. An area of the film is R^2 cos(theta) per steradian of normals, and so
/// R^2 / 4 per steradian of mirrored directions, in all directions alike.
fn mirrored(reflectance: f64) -> [f64; 3] {
    let share = RADIUS * RADIUS / 4.0 / (HEIGHT * HEIGHT);
    [1.0, 2.0, 0.5].map(|color| reflectance * SUN * color * share)
}

/// Renders a text with so many samples that even those which just miss the light are several.
fn films(text: &str, seeds: Range<u64>) -> (Method, Mean) {
    let scene = scene(text);
    let method = Method { samples: 256, ..plan(&scene).method };
    let films = films_of(&scene, &method, seeds);
    (method, Mean::over_seeds(&films))
}

#[test]
fn a_mirroring_ball_shows_the_light_of_the_sun_wherever_it_stands_however_small_it_is() {
    let suns = [([0.3, 1.0, 0.8], 0.533), ([-0.6, 0.1, 1.0], 0.05), ([1.0, 0.4, 0.2], 1e-3), ([0.9, 0.2, -0.3], 0.533)];
    for (toward, diameter) in suns {
        let (method, mean) = films(&view("", "mirror.reflectance = 0.8", &sun(toward, diameter)), 0..64);
        assert_eq!(method.highlights.len(), 1, "{toward:?}");
        mean.assert_near(mirrored(0.8), 3 * suns.len(), &format!("toward {toward:?}, {diameter} degrees"));
        // 16384 samples of each pixel: without aim, one in 3000 or fewer would hit the sun.
        assert!(mean.worst_relative_error(mirrored(0.8)) < 0.004, "toward {toward:?}: {:?}", mean.error);
    }
}

#[test]
fn balls_behind_panes_and_in_mirrors_show_the_light_of_the_sun() {
    let ball = "mirror.reflectance = 0.8";
    // The sun is behind the pane, and behind the mirror: the ball does not see them before it.
    let pane = "[material.pane]\nthin.index = 1.5\n[[object]]\nmaterial = \"pane\"\n\
                shape.quad = { center = [0, 0, 2], u = [1.5, 0, 0], v = [0, 1.5, 0] }\n";
    let behind_pane = view("", ball, &sun([0.9, 0.2, -0.3], 0.533)) + pane;
    let mirror = "[material.mirror]\nmirror.reflectance = 0.9\n[[object]]\nmaterial = \"mirror\"\n\
                  shape.quad = { center = [0, 0, 5], u = [1.5, 0, -1.5], v = [0, 1.5, 0] }\n";
    let in_mirror = view("", ball, &sun([0.3, 1.0, 0.8], 0.533)) + mirror;
    let in_mirror = in_mirror.replace("[0, 0, 5], look_at = [0, 0, 0]", "[-5, 0, 5], look_at = [0, 0, 5]");
    // A pane reflects (n - 1)^2 / (n + 1)^2 = 0.04 at each of its faces, back and forth.
    for (text, bounces, factor) in [(behind_pane, 1, 0.96 / 1.04), (in_mirror, 2, 0.9)] {
        let (method, mean) = films(&text, 0..32);
        let found: Vec<u32> = method.highlights.iter().map(|highlight| highlight.bounces).collect();
        assert_eq!(found, [bounces]);
        let expected = mirrored(0.8).map(|band| band * factor);
        mean.assert_near(expected, 6, &format!("{bounces} bounces"));
        assert!(mean.worst_relative_error(expected) < 0.004, "{bounces}: {mean:?}");
    }
}

/// Where a ray leaves a ball of glass: its deflection, and its share of the light.
struct Ejected {
    deflection: f64,
    share: f64,
}

/// Follows a ray that meets a ball of index 1.5 at an angle of incidence. It is mirrored at the first surface if
/// `inside` is `None`, and that many times inside otherwise.
fn ejected(incidence: f64, inside: Option<i32>) -> Ejected {
    let refraction = (incidence.sin() / 1.5).asin();
    let (sum, difference) = (incidence + refraction, incidence - refraction);
    let (s, p) = (difference.sin() / sum.sin(), difference.tan() / sum.tan());
    let reflected = 0.5 * (s * s + p * p);
    // Each polarization keeps to itself inside, and is reflected by its own share each time.
    let through = |inside| 0.5 * [s * s, p * p].map(|r| (1.0 - r) * (1.0 - r) * r.powi(inside)).iter().sum::<f64>();
    match inside {
        None => Ejected { deflection: PI - 2.0 * incidence, share: reflected },
        Some(inside) => {
            let turn = f64::from(inside) * (PI - 2.0 * refraction);
            let deflection = 2.0 * difference + turn;
            Ejected { deflection: deflection.min(2.0 * PI - deflection), share: through(inside) }
        }
    }
}

/// Returns how much of the film a ball of glass fills with the sun, per steradian of the sun and square of the radius.
/// `away` is the angle between the direction of sight and that to the sun.
fn seen_through_glass(away: f64, inside: Option<i32>) -> f64 {
    // Sums over all intervals of incidence in which the deflection passes the angle.
    let steps = 1_000_000;
    let at = |i: i32| f64::from(i) / f64::from(steps) * 0.5 * PI;
    let areas = (1..steps - 1).map(|i| {
        let [a, b] = [at(i), at(i + 1)];
        let [from, to] = [a, b].map(|incidence| ejected(incidence, inside).deflection);
        let is_there = (from - away) * (to - away) <= 0.0;
        let middle = 0.5 * (a + b);
        let film = middle.sin() * (b.sin() - a.sin());
        if is_there { ejected(middle, inside).share * film / (away.sin() * (to - from).abs()) } else { 0.0 }
    });
    areas.sum()
}

#[test]
fn balls_of_glass_show_the_sun_behind_them_and_what_they_mirror_inside() {
    // The camera looks along -z.
    for (toward, max_bounces, chains) in [([0.5, 0.3, -0.8], 2, vec![1, 2]), ([0.19, 0.19, 1.0], 3, vec![1, 3])] {
        let render = format!("render = {{ samples = 16, max_bounces = {max_bounces}, polarization = \"on\" }}");
        let text = view("", "dielectric.index = 1.5", &sun(toward, 0.2)).replace("render = { samples = 16 }", &render);
        let (method, mean) = films(&text, 0..64);
        let found: BTreeSet<u32> = method.highlights.iter().map(|highlight| highlight.bounces).collect();
        assert_eq!(found, BTreeSet::from_iter(chains.iter().copied()), "{:?}", method.highlights);
        let [x, y, z]: [f64; 3] = toward;
        let away = (-z / (x * x + y * y + z * z).sqrt()).acos();
        let ways = [None, Some(0), Some(1)].into_iter().take(max_bounces as usize);
        let area: f64 = ways.map(|inside| seen_through_glass(away, inside)).sum();
        let share = area * RADIUS * RADIUS / (HEIGHT * HEIGHT);
        let expected = [1.0, 2.0, 0.5].map(|color| SUN * color * share);
        mean.assert_near(expected, 6, &format!("{toward:?}"));
        assert!(mean.worst_relative_error(expected) < 0.005, "{toward:?}: {mean:?}");
    }
}

#[test]
fn every_filter_shows_all_light_of_a_highlight() {
    let filters = ["tent", "gaussian", "blackman-harris", "mitchell"];
    for filter in filters {
        let film = format!(", filter = \"{filter}\"");
        let text = view(&film, "mirror.reflectance = 0.8", &sun([0.3, 1.0, 0.8], 0.533));
        let (method, mean) = films(&text, 0..32);
        // The filters of all pixels need not have the sum 1 at each point of the film.
        let (center, shape) = (DVec2::from(method.highlights[0].center), scene(&text).film.filter);
        let middle = |i: u32| DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) + 0.5;
        let sum: f64 = (0..SIDE * SIDE).map(|i| shape.value(center - middle(i))).sum();
        let expected = mirrored(0.8).map(|band| band * sum);
        mean.assert_near(expected, 3 * filters.len(), filter);
        assert!((sum - 1.0).abs() < 0.03 && mean.worst_relative_error(expected) < 0.002, "{filter}: {sum}, {mean:?}");
    }
}

/// A cone of half angle a whose axis is at an angle t to the viewing direction cuts a plane at distance 1 in an ellipse
/// with the half axes sin(a) cos(a) / (cos(t)^2 - sin(a)^2) and sin(a) / sqrt(cos(t)^2 - sin(a)^2).
#[test]
fn small_lights_in_view_have_all_their_light_wherever_they_are_and_behind_panes() {
    let (radius, fov): (f64, f64) = (0.003, 40.0);
    let lamp = |center: [f64; 3]| {
        format!(
            "[[object]]\nshape.sphere = {{ center = {center:?}, radius = {radius} }}\nmaterial = \"lamp\"\n\
             [material.lamp]\nemissive.radiance = {{ rgb = [1, 2, 0.5], scale = 2000 }}\n"
        )
    };
    let perspective = |text: String| {
        let projection = format!("projection = \"orthographic\", height = {HEIGHT}");
        text.replace(&projection, &format!("vertical_fov = {fov}"))
    };
    let matte = "diffuse.reflectance = 0";
    let squared_side = 4.0 * (0.5 * fov).to_radians().tan().powi(2);
    let share_of_cone = |toward: [f64; 3], sin: f64| {
        let [x, y, z] = toward;
        let difference = z * z / (x * x + y * y + z * z) - sin * sin;
        PI * sin * sin * (1.0 - sin * sin).sqrt() / (difference * difference.sqrt() * squared_side)
    };
    let away = [1.1, 0.71, -4.0];
    let sin = radius / away.iter().map(|x| x * x).sum::<f64>().sqrt();
    let sun_toward = [-0.2, 0.31, -1.0];
    let sun_sin = (0.5 * 0.05_f64).to_radians().sin();
    let pane = "[material.pane]\nthin.index = 1.5\n[[object]]\nmaterial = \"pane\"\n\
                shape.quad = { center = [0, 0, 2], u = [1.5, 0, 0], v = [0, 1.5, 0] }\n";
    let in_parallel = PI * radius * radius / (HEIGHT * HEIGHT);
    let cases = [
        (
            "a lamp",
            perspective(view("", matte, "")) + &lamp([away[0], away[1], away[2] + 5.0]),
            share_of_cone(away, sin),
        ),
        (
            "the sun",
            perspective(view("", matte, &sun(sun_toward, 0.05))),
            SUN / (2000.0 * PI * sun_sin * sun_sin) * share_of_cone(sun_toward, sun_sin),
        ),
        ("a lamp in a parallel view", view("", matte, "") + &lamp([0.63, 0.31, 1.0]), in_parallel),
        ("behind a pane", view("", matte, pane) + &lamp([0.63, 0.31, 1.0]), in_parallel * 0.96 / 1.04),
    ];
    for (name, text, share) in &cases {
        let (method, mean) = films(text, 0..32);
        let found: Vec<u32> = method.highlights.iter().map(|highlight| highlight.bounces).collect();
        assert_eq!(found, [0], "{name}");
        let expected = [1.0, 2.0, 0.5].map(|color| 2000.0 * color * share);
        mean.assert_near(expected, 3 * cases.len(), name);
        assert!(mean.worst_relative_error(expected) < 0.004, "{name}: {mean:?}");
    }
}

/// Returns a lamp of a color, seen in a parallel view.
fn lamp_in_view(name: &str, [x, y]: [f64; 2], radius: f64) -> String {
    format!(
        "[[object]]\nshape.sphere = {{ center = [{x}, {y}, 1], radius = {radius} }}\nmaterial = \"{name}\"\n\
         [material.{name}]\nemissive.radiance = {{ rgb = [1, 2, 0.5], scale = 2000 }}\n"
    )
}

#[test]
fn lights_are_seen_in_part_if_their_center_is_hidden() {
    let radius: f64 = 0.003;
    // A screen hides all that is left of an edge.
    for share in [0.2, 0.7] {
        let edge = 0.63 + share * radius;
        let screen = format!(
            "[[object]]\nmaterial = \"ball\"\nshape.quad = {{ center = [{}, 0.31, 2], u = [0.1, 0, 0], v = [0, 0.1, 0] }}\n",
            edge - 0.1
        );
        let text = view("", "diffuse.reflectance = 0", "") + &lamp_in_view("lamp", [0.63, 0.31], radius) + &screen;
        let (method, mean) = films(&text, 0..64);
        assert_eq!(method.highlights.len(), 1, "{share}");
        // The segment of a circle beyond a chord.
        let segment = radius * radius * (share.acos() - share * (1.0 - share * share).sqrt());
        let expected = [1.0, 2.0, 0.5].map(|color| 2000.0 * color * segment / (HEIGHT * HEIGHT));
        mean.assert_near(expected, 6, &format!("{share} of the radius"));
        assert!(mean.worst_relative_error(expected) < 0.03, "{share}: {mean:?}");
    }
}

/// A sample aims at four highlights of a pixel at most.
#[test]
fn pixels_with_many_highlights_show_all_of_them() {
    for filter in ["box", "gaussian"] {
        let radii = (0..9).map(|i| 0.002 + 0.0005 * f64::from(i));
        let lamps = radii.clone().enumerate().map(|(i, radius)| {
            lamp_in_view(&format!("lamp{i}"), [0.53 + 0.02 * (i % 3) as f64, 0.53 + 0.02 * (i / 3) as f64], radius)
        });
        let film = format!(", filter = \"{filter}\"");
        let text = view(&film, "diffuse.reflectance = 0", "") + &lamps.collect::<String>();
        let (method, mean) = films(&text, 0..64);
        assert_eq!(method.highlights.len(), 9);
        let shape = scene(&text).film.filter;
        let middle = |i: u32| DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) + 0.5;
        let sum_at = |film: DVec2| (0..SIDE * SIDE).map(|i| shape.value(film - middle(i))).sum::<f64>();
        let areas =
            method.highlights.iter().zip(radii).map(|(highlight, r)| PI * r * r * sum_at(highlight.center.into()));
        let area: f64 = areas.sum();
        let expected = [1.0, 2.0, 0.5].map(|color| 2000.0 * color * area / (HEIGHT * HEIGHT));
        mean.assert_near(expected, 6, filter);
        assert!(mean.worst_relative_error(expected) < 0.02, "{filter}: {mean:?}");
    }
}

/// A tube is divided into parts about as long as wide, and the bulbs of a mesh are parts wherever they are.
#[test]
fn long_lamps_and_all_bulbs_of_a_mesh_have_their_light() {
    let color = "emissive.radiance = { rgb = [1, 2, 0.5], scale = 2000 }";
    let lamp = |shape: &str| format!("[material.lamp]\n{color}\n[[object]]\nmaterial = \"lamp\"\n{shape}\n");
    // Half edges of a tube that lies aslant.
    let (along, across) = ([0.3, 0.12], [-0.0004, 0.001]);
    let tube = format!(
        "shape.quad = {{ center = [0.45, 0.6, 1], u = [{}, {}, 0], v = [{}, {}, 0] }}",
        along[0], along[1], across[0], across[1]
    );
    // Squares that face the camera, each of two triangles.
    let half = 0.0015;
    let centers = [[-0.8, 0.7], [0.63, 0.31], [0.1, -0.9], [0.11, -0.88]];
    let corner = |[x, y]: [f64; 2], i: usize| {
        let sign = |bit: usize| if bit == 0 { -half } else { half };
        format!("[{}, {}, 1]", x + sign((i ^ i >> 1) & 1), y + sign(i >> 1 & 1))
    };
    let vertices: Vec<String> = centers.iter().flat_map(|center| (0..4).map(|i| corner(*center, i))).collect();
    let faces: Vec<String> =
        (0..4).map(|i| format!("[{}, {}, {}, {}]", 4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3)).collect();
    let mesh = format!("shape.mesh = {{ points = [{}], faces = [{}] }}", vertices.join(", "), faces.join(", "));
    let cases = [
        ("a tube", tube, 4.0 * f64::abs(along[0] * across[1] - along[1] * across[0]), 60..=300),
        ("a mesh", mesh, 4.0 * 4.0 * half * half, 4..=4),
    ];
    for (name, shape, area, parts) in &cases {
        let text = view("", "diffuse.reflectance = 0", "") + &lamp(shape);
        let (method, mean) = films(&text, 0..32);
        assert!(parts.contains(&method.highlights.len()), "{name}: {} highlights", method.highlights.len());
        let expected = [1.0, 2.0, 0.5].map(|color| 2000.0 * color * area / (HEIGHT * HEIGHT));
        mean.assert_near(expected, 3 * cases.len(), name);
        assert!(mean.worst_relative_error(expected) < 0.01, "{name}: {mean:?}");
    }
}

/// Rough and smooth surfaces and lamps of which plain samples find enough to compare.
#[test]
fn aimed_samples_find_what_plain_samples_find() {
    let point = "light = [{ point = { position = [1, 1, 3], intensity = { rgb = [4, 2, 6] } } }]";
    let copper = "conductor = { metal = \"Cu\", roughness = 0.25 }";
    let varnish = "plastic = { reflectance = 0.3, roughness = 0.2 }";
    let cases = [
        ("glass", "dielectric.index = 1.5", sun([0.3, 1.0, 0.8], 4.0)),
        ("a coat", "plastic.reflectance = 0.3", sun([0.3, 1.0, 0.8], 4.0)),
        ("copper", copper, sun([0.3, 1.0, 0.8], 0.533)),
        ("copper by a point", copper, point.to_owned()),
        ("varnish", varnish, sun([0.9, 0.3, 0.1], 0.2)),
        ("a lamp", "mirror.reflectance = 0.8", String::new()),
        ("a tube", "mirror.reflectance = 0.8", String::new()),
        ("copper by a tube", copper, String::new()),
    ];
    for (name, ball, light) in &cases {
        let lamp = match (light.is_empty(), name.ends_with("tube")) {
            (true, true) => TUBE,
            (true, false) => LAMP,
            (false, _) => "",
        };
        let text = view("", ball, light) + lamp;
        let scene = scene(&text);
        let method = plan(&scene).method;
        // In rough copper, the images of some parts are too large.
        let parts = match *name {
            "a tube" => 8..=16,
            "copper by a tube" => 1..=16,
            _ => 1..=1,
        };
        assert!(parts.contains(&method.highlights.len()), "{name}: {} highlights", method.highlights.len());
        let aimed = Mean::over_seeds(&films_of(&scene, &method, 0..32));
        let plain = Method { highlights: Vec::new(), samples: 4096, ..method };
        let plain = Mean::over_seeds(&films_of(&scene, &plain, 100..132));
        aimed.with_joint_error(&plain).assert_near(plain.value, 3 * cases.len(), name);
    }
}

#[test]
fn layers_have_the_light_of_highlights() {
    let text = view(", filter = \"mitchell\"", "plastic.reflectance = 0.3", &sun([0.3, 1.0, 0.8], 0.533));
    let options = Options { layers: Some(Layer::all().to_vec()), threads: Some(1), ..Options::default() };
    let with = render_text_with(&text, &options);
    let sum = |names: &[&str]| -> f64 {
        let layer = |name: &&str| with.layer(&format!("{name}.G")).unwrap_or_else(|| panic!("no layer {name}"));
        names.iter().flat_map(layer).map(f64::from).sum()
    };
    let all: f64 = with.rgb().iter().map(|rgb| f64::from(rgb[1])).sum();
    for parts in [&["emission", "background", "direct", "indirect"][..], &["light_sun"]] {
        assert!((sum(parts) / all - 1.0).abs() < 1e-5, "{parts:?}: {} of {all}", sum(parts));
    }
}

#[test]
fn aimed_samples_change_no_layer_that_has_no_light() {
    let layers = ", layers = [\"residual\", \"N\", \"P\", \"albedo\"]";
    let scene = scene(&view(layers, "plastic.reflectance = 0.3", &sun([0.3, 1.0, 0.8], 0.533)));
    let method = plan(&scene).method;
    let [with, without] = [method.highlights.clone(), Vec::new()]
        .map(|highlights| film_of(&scene, Method { highlights, ..method.clone() }));
    assert!(with.pixels.iter().zip(&without.pixels).any(|(a, b)| a.rgb != b.rgb));
    assert!(with.layers == without.layers && with.layers.len() == 4);
    assert!(with.pixels.iter().zip(&without.pixels).all(|(a, b)| a.alpha == b.alpha && a.depth == b.depth));
}

#[test]
fn large_mirror_images_and_those_that_nothing_shows_are_left_to_all_samples() {
    let left = [
        ("a large sun", view("", "mirror.reflectance = 0.8", &sun([0.3, 1.0, 0.8], 40.0))),
        ("a matte ball", view("", "diffuse.reflectance = 0.8", &sun([0.3, 1.0, 0.8], 0.533))),
        ("a rough ball", view("", "conductor = { metal = \"Cu\", roughness = 0.5 }", &sun([0.3, 1.0, 0.8], 0.533))),
        ("a sun behind", view("", "mirror.reflectance = 0.8", &sun([0.0, 0.01, -1.0], 0.533))),
        (
            "a sample in the middle",
            view(", filter = \"center\"", "mirror.reflectance = 0.8", &sun([0.3, 1.0, 0.8], 0.533)),
        ),
    ];
    for (name, text) in left {
        assert_eq!(plan(&scene(&text)).method.highlights, [], "{name}");
    }
}
