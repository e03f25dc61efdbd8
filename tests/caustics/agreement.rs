//! The light pass changes no image. Each image is rendered with it and without it, under lamps large enough for random
//! paths to hit.

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::Scene;
use abbe::spectrum::Curve;
use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use crate::support::larger::larger;
use crate::support::scenes::{SPLITTING, films_of, mean_and_variance, object, scene, sigma_limit};

/// Pixels along each side of the images, and blocks along each side that are compared.
const SIDE: usize = 24;
const BLOCKS: usize = 4;
const SEEDS: u64 = 16;

/// Returns the camera and the film. `film` may add a filter.
pub fn camera_and_film(camera: &str, film: &str) -> String {
    format!("[camera]\n{camera}\n[film]\nwidth = {SIDE}\nheight = {SIDE}\n{film}\n")
}

pub const ABOVE: &str = "position = [2.5, 3.5, 2.5]\nlook_at = [0, 0, 0]\nvertical_fov = 30";
pub const FLOOR: &str = "[material.floor]\ndiffuse = { reflectance = 0.8 }\n[[object]]\nmaterial = \"floor\"\n\
                     shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n";
pub const LAMP: &str = "[material.lamp]\nemissive = { radiance = 5 }\n";

pub fn glass(text: &str) -> String {
    format!("[material.glass]\ndielectric = {{ {text} }}\n")
}

/// Compiles a scene and returns it with the method that is planned for it.
pub fn scene_and_method(text: &str) -> (Scene<Curve>, Method) {
    let scene = scene(text);
    let method = plan(&scene).method;
    (scene, method)
}

/// Renders with several seeds, either with the light pass, which may have a map, or without it.
fn films(
    (scene, method): &(Scene<Curve>, Method),
    pass: bool,
    map: Option<MapPasses>,
    samples: u32,
    seeds: u64,
) -> Vec<Film> {
    let lights = (0..scene.lights.len()).collect();
    // Photons are sent through the same openings that bounces are aimed at.
    let openings = method.bright.as_ref().map_or(Vec::new(), |bright| bright.openings().openings);
    let photons = u64::from(samples) * (SIDE * SIDE) as u64;
    let to = Smoothness::ALL.to_vec();
    let light_pass = pass.then_some(LightPass { photons, lights, openings, to, map });
    let setup = Method { samples, transport: SPLITTING, light_pass, ..method.clone() };
    films_of(scene, &setup, 0..seeds)
}

/// Returns the mean of every block and band, with the variance of that mean.
pub fn blocks(planned: &(Scene<Curve>, Method), pass: bool, map: Option<MapPasses>, samples: u32) -> Vec<(f64, f64)> {
    let films = films(planned, pass, map, samples, SEEDS);
    let mut found = Vec::new();
    for (block, band) in (0..BLOCKS * BLOCKS).flat_map(|block| (0..3).map(move |band| (block, band))) {
        let wide = SIDE / BLOCKS;
        let corner = [block % BLOCKS * wide, block / BLOCKS * wide];
        let inside = |i: usize| (corner[1] + i / wide) * SIDE + corner[0] + i % wide;
        let of_film = |film: &Film| {
            (0..wide * wide).map(|i| f64::from(film.pixels[inside(i)].rgb[band])).sum::<f64>() / (wide * wide) as f64
        };
        let (mean, variance) = mean_and_variance(films.iter().map(of_film));
        found.push((mean, variance / SEEDS as f64));
    }
    found
}

/// Compares all blocks with the light pass and without it, at the same number of samples.
pub fn assert_agree(what: &str, text: &str, samples: u32) {
    assert_agree_with_map(what, text, [samples; 2], None);
}

/// Compares all blocks with the light pass, which may have a map, and without it. The two numbers of samples differ:
/// the noisier side takes more, which resolves the difference best in the least time.
pub fn assert_agree_with_map(what: &str, text: &str, samples: [u32; 2], map: Option<MapPasses>) {
    assert_methods_agree(what, &scene_and_method(text), samples, map);
}

/// Compares all blocks of a scene under a given method with the light pass and without it.
pub fn assert_methods_agree(what: &str, planned: &(Scene<Curve>, Method), samples: [u32; 2], map: Option<MapPasses>) {
    let with = blocks(planned, true, map, samples[0]);
    let without = blocks(planned, false, None, samples[1]);
    // Means of 16 films have the tails of Student's t with 30 degrees of freedom. So far out they are 1.25 times as
    // wide as those of the normal distribution.
    let limit = 1.25 * sigma_limit(with.len());
    let (mut worst, mut squares, mut quieter) = (0.0_f64, 0.0, 0);
    for (a, b) in with.iter().zip(&without) {
        let rounding = 1e-6 * (a.0 + b.0);
        let z = (a.0 - b.0).abs() / ((a.1 + b.1).sqrt() + rounding);
        worst = larger(worst, z);
        squares += z * z;
        quieter += i32::from(a.1 < b.1);
    }
    let sums = [&with, &without].map(|found| found.iter().map(|x| x.0).sum::<f64>());
    let error = with.iter().zip(&without).map(|(a, b)| a.1 + b.1).sum::<f64>().sqrt();
    let whole = (sums[0] - sums[1]) / error;
    let gain = without.iter().map(|x| x.1).sum::<f64>() / with.iter().map(|x| x.1).sum::<f64>();
    println!(
        "{what}: worst z {worst:.2} of {limit:.2}, mean square {:.2}, whole {whole:.2} of {:.2} %, variance {gain:.2} x, quieter {quieter}, mean {:.5} {:.5}",
        squares / with.len() as f64,
        100.0 * error / sums[1],
        sums[0] / with.len() as f64,
        sums[1] / with.len() as f64
    );
    assert!(worst < limit, "{what}: {worst} standard errors apart");
    // The bands of a block are correlated, so the sum of all blocks has a few times the error of independent ones.
    assert!(whole.abs() < 3.0 * 3.0_f64.sqrt(), "{what}: the whole is {whole} standard errors apart");
    let [shown, hidden] = [true, false].map(|pass| films(planned, pass, map.filter(|_| pass), samples[0], 1));
    assert!(shown[0].pixels != hidden[0].pixels, "{what}: the light pass did nothing");
}

/// Numbers of samples for the caustics of balls, where the light pass has a tenth of the variance or less.
const BALL_SAMPLES: [u32; 2] = [4, 20];

pub const BALL: &str = "sphere = { center = [0, 1.5, 0], radius = 1 }";

#[test]
fn a_floor_in_water_that_the_camera_does_not_see() {
    let water = object("glass", "cube = { center = [0, 0, 0], size = 2 }") + "visible_to_camera = false\n";
    let lamp = object("lamp", "sphere = { center = [0, 4, 0], radius = 0.5 }");
    let text = camera_and_film(ABOVE, "") + FLOOR + &glass("index = 1.33, absorption = 0.5") + &water + LAMP + &lamp;
    assert_agree_with_map("a floor in hidden water", &text, [8, 72], None);
}

#[test]
fn a_glass_ball_under_a_round_lamp() {
    let text = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + &glass("index = 1.5")
        + &object("glass", BALL)
        + &object("lamp", "sphere = { center = [0, 7, 0], radius = 1 }");
    assert_agree_with_map("ball", &text, BALL_SAMPLES, None);
}

/// Squares of three brightnesses on lamps of every kind, each in a scene of its own.
#[test]
fn a_glass_ball_under_lamps_that_show_patterns() {
    let shown =
        "[material.lamp]\nemissive = { radiance = { checker = [{ rgb = [30, 20, 10] }, 0.5], repeat = [3, 2] } }\n";
    let mesh = "mesh = { points = [[1, 0, 1], [-1, 0, 1], [-1, 0, -1], [1, 0, -1]], faces = [[0, 1, 2], [0, 2, 3]], \
                uv = [[0, 0], [1, 0], [1, 1], [0, 1]] }\nmaterial = \"lamp\"\n";
    let at = |transform: &str| format!("transform = [{{ {transform} }}]\n");
    let lamps = [
        object("lamp", "quad = { center = [0, 4, 0], u = [0.8, 0, 0], v = [0, 0.2, 0.7] }"),
        object("lamp", "disc = { center = [0, 4, 0], normal = [0.2, -1, 0], radius = 0.9 }"),
        object("lamp", "sphere = { center = [0, 5, 0], radius = 1 }"),
        object("lamp", "sphere = { center = [0, 5, 0], radius = 1 }") + &at("scale = [1.2, 1, 0.7]"),
        object("lamp", "cube = { center = [0.2, 4.5, 0], size = [1, 0.5, 1.2] }"),
        format!("[[object]]\nshape.{mesh}{}", at("translate = [0, 4, 0]")),
        format!(
            "[[object]]\nshape.{mesh}{}instances = [[{{ translate = [0.8, 4, 0] }}], \
             [{{ scale = [-0.6, 1, 0.9] }}, {{ translate = [-0.6, 4.2, 0.2] }}]]\n",
            at("rotate = { axis = [0, 0, 1], degrees = 10 }")
        ),
    ];
    for (number, lamp) in lamps.iter().enumerate() {
        let text = camera_and_film(ABOVE, "") + FLOOR + shown + &glass("index = 1.5") + &object("glass", BALL) + lamp;
        assert_agree_with_map(&format!("ball under pattern {number}"), &text, BALL_SAMPLES, None);
    }
    // Instances of a lamp with uniform radiance.
    let text = camera_and_film(ABOVE, "") + FLOOR + LAMP + &glass("index = 1.5") + &object("glass", BALL) + &lamps[6];
    assert_agree_with_map("ball under two of a kind", &text, BALL_SAMPLES, None);
}

/// A sky of three bright places and a dim rest, which photons and camera paths share.
#[test]
fn l11_a_glass_ball_under_an_image_of_the_sky_with_lamps_in_it() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sky.exr");
    let at = |x: usize, y: usize| match (x, y) {
        (20..=22, 5..=6) => (30.0, 22.0, 14.0),
        (44, 9) => (9.0, 14.0, 25.0),
        (4..=6, 12) => (8.0, 8.0, 8.0),
        _ => (0.3, 0.01 * (x + y) as f32, 0.4),
    };
    exr::prelude::write_rgb_file(&file, 64, 32, at).unwrap();
    let sky = format!(
        "[[light]]\nenvironment = {{ radiance = {{ image = {file:?}, scale = 0.5 }}, \
         transform = [{{ rotate = {{ axis = [0.2, 1, 0], degrees = 40 }} }}] }}\n"
    );
    let text = camera_and_film(ABOVE, "") + FLOOR + &glass("index = 1.5") + &object("glass", BALL) + &sky;
    assert_agree("a ball under a sky", &text, 8);
    let cup = object("glass", "cube = { center = [0, 0.7, 0], size = 1 }");
    let prism = "[material.glass]\ndielectric = { index = \"N-SF11\" }\n";
    assert_agree("a cube of N-SF11 under a sky", &(camera_and_film(ABOVE, "") + FLOOR + prism + &cup + &sky), 8);
    let camera = "position = [2.5, 3.5, 2.5]\nlook_at = [0, 0.5, 0]\nvertical_fov = 30";
    let map = Some(MapPasses { count: 16, photons: 8192, radius: 0.1, chance: 1.0 });
    let text = camera_and_film(camera, "") + FLOOR + &glass("index = 1.5") + &object("glass", BALL) + &sky;
    assert_agree_with_map("a ball under a sky, gathered", &text, [4, 32], map);
}

#[test]
fn a_mirror_beside_a_lamp_that_lights_the_floor_as_well() {
    let text = camera_and_film(ABOVE, "filter = \"mitchell\"")
        + FLOOR
        + LAMP
        + "[material.mirror]\nmirror = { reflectance = { rgb = [0.9, 0.8, 0.5] } }\n\
           [material.silver]\nconductor = { metal = \"Ag\" }\n"
        + &object("mirror", "quad = { center = [-1, 0.7, 0], u = [0.2, 0.6, 0], v = [0, 0, 0.8] }")
        + &object("silver", "sphere = { center = [0.6, 0.4, -0.9], radius = 0.4 }")
        + &object("lamp", "quad = { center = [1.5, 2, 0], u = [0.4, 0, 0], v = [0, 0, 0.4] }");
    assert_agree("mirror", &text, 16);
}

#[test]
fn a_prism_whose_wavelengths_part() {
    let prism = "mesh = { points = [[-0.6, 0.4, -0.6], [0.6, 0.4, -0.6], [0, 1.4, -0.6], [-0.6, 0.4, 0.6], [0.6, 0.4, 0.6], \
                 [0, 1.4, 0.6]], faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]] }";
    let text = camera_and_film(ABOVE, "")
        + "[render]\nmodel = \"hero\"\n"
        + FLOOR
        + LAMP
        + &glass("index = \"N-SF11\"")
        + &object("glass", prism)
        + &object("lamp", "disc = { center = [-2, 2.5, 0], normal = [2, -2, 0], radius = 0.6 }");
    assert_agree("prism", &text, 16);
}

#[test]
fn absorbing_water_in_a_glass_with_a_lamp_in_the_sky() {
    let text = camera_and_film(
        "position = [2.5, 3.5, 2.5]\nlook_at = [0, 0, 0]\nprojection = \"orthographic\"\nheight = 2.4",
        "",
    ) + FLOOR
        + &glass("index = 1.5, priority = 1")
        + "[material.water]\ndielectric = { index = 1.33, absorption = { rgb = [1.5, 0.4, 0.2] } }\n\
           [material.hollow]\ndielectric = { index = 1.0, priority = 2 }\n"
        + &object("glass", "sphere = { center = [0, 0.9, 0], radius = 0.8 }")
        + &object("hollow", "sphere = { center = [0, 0.9, 0], radius = 0.7 }")
        + &object("water", "cube = { center = [0.3, 0.9, 0], size = [1.4, 0.5, 0.5] }")
        + "[[light]]\nsun = { toward = [0.3, 1, 0.2], angular_diameter = 30, irradiance = 3 }\n";
    assert_agree("water", &text, 16);
}

/// An infinite plane transmits some of the sunlight to a ball below it. Another ball is above it.
#[test]
fn balls_in_the_sun_below_a_plane_with_holes_and_one_above_it() {
    let over = |material: &str| {
        camera_and_film("position = [1.2, 2.4, 2.5]\nlook_at = [-0.5, 0, 0]\nvertical_fov = 50", "")
            + "[material.floor]\ndiffuse = { reflectance = 0.8 }\n"
            + &object("floor", "quad = { center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, -4] }")
            + "[material.paper]\ndiffuse = { reflectance = 0.3 }\n"
            + &glass("index = 1.5")
            + &format!("[material.over]\n{material}\n")
            + &object("over", "plane = { point = [0, 3, 0], normal = [0.1, 1, 0] }")
            + &object("glass", "sphere = { center = [-0.7, 1, 0], radius = 0.7 }")
            + &object("glass", "sphere = { center = [0.9, 4.2, 0], radius = 0.7 }")
            + "[[light]]\nsun = { toward = [0.3, 1, 0.2], angular_diameter = 30, irradiance = 3 }\n"
    };
    assert_agree("below a mask", &over("mask = { material = \"paper\", opacity = 0.5 }"), 16);
    assert_agree("below a pane without end", &over("thin = { index = 1.5 }"), 16);
    assert_agree("below water without end", &over("dielectric = { index = 1.33 }"), 16);
}

#[test]
fn panes_and_boxes_seen_through_a_lens() {
    let lens = "lens = { radius = 0.2, focus_distance = 4 }\nshift = [0.1, -0.2]\nnear = 0.5";
    let text = camera_and_film(&format!("{ABOVE}\n{lens}"), "filter = { gaussian = { sigma = 0.7 } }")
        + FLOOR
        + LAMP
        + &glass("index = { rgb = [1.5, 1.55, 1.6] }")
        + "[material.pane]\nthin = { index = 1.5, transmittance = 0.8 }\n"
        + &object("pane", "quad = { center = [-0.5, 1, 0], u = [0.5, 0.2, 0], v = [0, 0, 0.6] }")
        + &object("glass", "cube = { center = [0.6, 0.5, 0.2], size = [0.5, 0.4, 0.7] }")
        + &object("lamp", "cube = { center = [0, 3, 0], size = 0.8 }");
    assert_agree("panes", &text, 16);
}

#[test]
fn a_bulb_whose_lamp_is_inside_and_a_camera_that_sees_all_around() {
    let text = camera_and_film(
        "position = [0.2, 1.1, 0.9]\nlook_at = [0, 1, 0]\nprojection = \"equirectangular\"",
        "filter = { tent = { radius = 1.5 } }",
    ) + FLOOR
        + LAMP
        + "[material.wall]\ndiffuse = { reflectance = 0.5 }\n[material.ceiling]\nconductor = { metal = \"Al\", roughness = 0.5 }\n"
        + &object("wall", "quad = { center = [0, 1, -1.5], u = [2, 0, 0], v = [0, 2, 0] }")
        + &object("ceiling", "quad = { center = [0, 2.5, 0], u = [2, 0, 0], v = [0, 0, 2] }")
        + &glass("index = 1.5")
        + "[material.hollow]\ndielectric = { index = 1.0, priority = 1 }\n"
        + &object("glass", "sphere = { center = [0, 1, 0], radius = 0.5 }")
        + &object("hollow", "sphere = { center = [0, 1, 0], radius = 0.42 }")
        + &object("glass", "sphere = { center = [1, 0.5, 0.4], radius = 0.3 }")
        + &object("lamp", "sphere = { center = [0, 1, 0], radius = 0.25 }");
    assert_agree("bulb", &text, 32);
}

#[test]
fn a_camera_under_water_and_a_lamp_out_of_round() {
    let lamp = "[[object]]\nmaterial = \"lamp\"\nshape.sphere = { center = [0, 0, 0], radius = 0.4 }\n\
                transform = [{ scale = [1, 0.4, 2] }, { translate = [0.5, 3, 0] }]\n";
    let text = camera_and_film("position = [0.8, 0.8, 1.5]\nlook_at = [0, 0, 0]\nvertical_fov = 50", "")
        + "[render]\nmax_bounces = 5\n"
        + FLOOR
        + LAMP
        + "[material.water]\ndielectric = { index = 1.33, absorption = 0.3 }\n\
           [material.air]\ndielectric = { index = 1.0, priority = 1 }\n"
        + &object("water", "cube = { center = [0, 0.5, 0], size = [5, 1.6, 5] }")
        + &object("air", "sphere = { center = [-0.2, 0.7, 0], radius = 0.3 }")
        + lamp;
    assert_agree("under water", &text, 32);
}
