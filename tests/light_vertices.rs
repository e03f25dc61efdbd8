//! Indirect light found with vertices of light paths: compared with a closed form, and with paths from the camera alone
//! in rooms of many kinds.
//!
//! ```text
//! cargo test --test all light_vertices::
//! ```

mod openings;
mod suns;

use std::f64::consts::PI;

use abbe::film::{Film, Layer};
use abbe::plan::plan;
use abbe::trace::{Effort, Method, SkyOpenings, World, pilot_noise, prepare, render, with_light_vertices};

use crate::support::larger::larger;
use crate::support::scenes::{
    SPLITTING, body, environment, film_of, mean_and_variance, method, quad, scene, sigma_limit, view,
};

const WHITE: &str = "diffuse = { reflectance = 0.7 }";
const LAMP: &str = "emissive = { radiance = { rgb = [9, 8, 6] } }";

/// Returns the six walls of a closed box, 4 x 3 x 5, that stands on the floor.
fn walls() -> [String; 6] {
    [
        quad([0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.5]),
        quad([0.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.5]),
        quad([2.0, 1.5, 0.0], [0.0, 0.0, 2.5], [0.0, 1.5, 0.0]),
        quad([-2.0, 1.5, 0.0], [0.0, 0.0, 2.5], [0.0, 1.5, 0.0]),
        quad([0.0, 1.5, -2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
        quad([0.0, 1.5, 2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
    ]
}

/// Returns the box seen from inside, with more objects in it.
fn room(wall: &str, render: &str, more: &[String]) -> String {
    let walls = walls();
    view([1.3, 1.6, 2.2], [-0.6, 1.0, -1.0], 75.0, 12)
        + &format!("[render]\nsamples = 8\n{render}\n")
        + &body("wall", wall, &walls.each_ref().map(String::as_str))
        + &more.concat()
}

fn lamp() -> String {
    body("lamp", LAMP, &[&quad([0.3, 2.9, -0.4], [0.5, 0.0, 0.0], [0.0, 0.0, 0.4])])
}

/// Returns a lamp that lights only the ceiling.
fn ceiling_lamp() -> String {
    let material = "emissive = { radiance = { rgb = [30, 25, 20] }, sides = \"front\" }";
    body("lamp", material, &[&quad([-0.8, 1.8, -0.4], [0.5, 0.0, 0.0], [0.0, 0.0, -0.4])])
}

/// Returns a screen in front of most of a side wall.
fn screen(material: &str) -> String {
    body("screen", material, &[&quad([-1.9, 1.5, 0.0], [0.0, 0.0, 2.3], [0.0, 1.4, 0.0])])
}

fn ball(name: &str, material: &str) -> String {
    body(name, material, &["sphere = { center = [-0.6, 0.9, -0.8], radius = 0.8 }"])
}

/// Returns an octahedron with the normals of a ball.
fn smooth(material: &str) -> String {
    let points = "[[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]";
    let faces = "[[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]";
    format!(
        "[material.smooth]\n{material}\n[[object]]\nmaterial = \"smooth\"\n\
         shape.mesh = {{ points = {points}, faces = {faces}, normals = {points} }}\n\
         transform = [{{ translate = [-0.5, 1.2, -0.7] }}]\n"
    )
}

/// Returns rooms in which light paths start from all lights.
fn rooms() -> Vec<(&'static str, String)> {
    let with = |more: &[String]| room(WHITE, "", more);
    let boxes = body(
        "red",
        "diffuse = { reflectance = { rgb = [0.8, 0.2, 0.1] } }",
        &[
            "cube = { center = [-0.6, 0.6, -0.9], size = [1, 1.2, 1] }",
            "cube = { center = [0.9, 0.3, 0.2], size = 0.6 }",
        ],
    );
    let small = |position: &str| format!("[[light]]\n{position}, intensity = {{ rgb = [3, 4, 5] }} }}\n");
    let lamps: String = (0..12)
        .map(|i| {
            let (x, z) = (f64::from(i % 4) - 1.5, f64::from(i / 4) - 1.0);
            format!(
                "[[light]]\npoint = {{ position = [{x:?}, 2.5, {z:?}], intensity = {:?} }}\n",
                0.2 + 0.1 * f64::from(i)
            )
        })
        .collect();
    let wall_with_gap = body("wall", WHITE, &[&quad([-0.4, 1.5, -0.2], [0.0, 0.0, 2.1], [0.0, 1.5, 0.0])])
        .replace("[material.wall]\ndiffuse = { reflectance = 0.7 }\n", "");
    let beyond = body("lamp", LAMP, &["sphere = { center = [-1.5, 1.5, -1.4], radius = 0.3 }"]);
    let masked = "[material.paint]\ndiffuse = { reflectance = 0.5 }\n".to_owned()
        + &body(
            "screen",
            "mask = { material = \"paint\", opacity = 0.4 }",
            &[&quad([0.0, 1.5, -0.6], [1.2, 0.0, 0.0], [0.0, 1.2, 0.0])],
        );
    let floor = "[[object]]\nshape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\nmaterial = \"wall\"\n\
                 [[object]]\nshape.plane = { point = [0, 3, 0], normal = [0, -1, 0] }\nmaterial = \"wall\"\n";
    let open = view([1.3, 1.6, 2.2], [-0.6, 1.0, -1.0], 75.0, 12)
        + "[render]\nsamples = 32\n[material.wall]\ndiffuse = { reflectance = 0.7 }\n"
        + floor
        + &lamp()
        + &boxes;
    let scaled = |factor: f64| {
        let mut text = String::new();
        for line in with(&[lamp(), boxes.clone()]).lines() {
            text += line;
            text += "\n";
            if line.starts_with("shape.") {
                text += &format!("transform = [{{ scale = {factor:e} }}]\n");
            }
        }
        let place = [1.3, 1.6, 2.2].map(|x: f64| x * factor);
        let at = [-0.6, 1.0, -1.0].map(|x: f64| x * factor);
        text.replace("position = [1.3, 1.6, 2.2]", &format!("position = {place:?}"))
            .replace("look_at = [-0.6, 1.0, -1.0]", &format!("look_at = {at:?}"))
    };
    vec![
        ("boxes", with(&[lamp(), boxes.clone()])),
        ("dark walls", room("diffuse = { reflectance = 0.15 }", "", &[lamp(), boxes.clone()])),
        ("white walls", room("diffuse = { reflectance = 0.95 }", "", &[lamp()])),
        ("a point", with(&[small("point = { position = [0, 2, 0]"), boxes.clone()])),
        (
            "a spot",
            with(&[small("spot = { position = [0, 2.5, 0], toward = [-0.2, -1, 0.1], cone_angle = 50"), boxes.clone()]),
        ),
        (
            "a lamp with a pattern",
            with(&[
                body(
                    "lamp",
                    "emissive = { radiance = { checker = [{ rgb = [30, 20, 10] }, 0.2], repeat = [3, 2] } }",
                    &[&quad([0.3, 2.9, -0.4], [0.5, 0.0, 0.0], [0.0, 0.0, 0.4])],
                ),
                boxes.clone(),
            ]),
        ),
        (
            "a ball of light",
            with(&[body("lamp", LAMP, &["sphere = { center = [0.8, 2.2, -0.8], radius = 0.3 }"]), boxes.clone()]),
        ),
        (
            "the tip of a ball of light",
            with(&[body("lamp", LAMP, &["sphere = { center = [0, 62.8, 0], radius = 60 }"]), boxes.clone()]),
        ),
        (
            "a cube of light",
            with(&[body("lamp", LAMP, &["cube = { center = [0.8, 2.2, -0.8], size = 0.5 }"]), boxes.clone()]),
        ),
        (
            "lamps of two colors",
            with(&[
                lamp(),
                body(
                    "blue",
                    "emissive = { radiance = { rgb = [1, 3, 9] }, sides = \"front\" }",
                    &[&quad([1.9, 1.0, 0.0], [0.0, 0.0, -0.4], [0.0, 0.4, 0.0])],
                ),
                boxes.clone(),
            ]),
        ),
        ("twelve points", with(&[lamps, boxes.clone()])),
        ("a glass ball", with(&[lamp(), ball("glass", "dielectric = { index = 1.5 }")])),
        (
            "a glass ball that absorbs",
            with(&[lamp(), ball("glass", "dielectric = { index = 1.5, absorption = { rgb = [0.2, 0.8, 2] } }")]),
        ),
        ("a mirror", with(&[lamp(), ball("silver", "mirror = { reflectance = 0.9 }")])),
        ("rough metal", with(&[lamp(), ball("metal", "conductor = { metal = \"copper\", roughness = 0.3 }")])),
        ("plastic", with(&[lamp(), ball("plastic", "plastic = { reflectance = 0.6, index = 1.5 }")])),
        (
            "rough plastic",
            with(&[lamp(), ball("plastic", "plastic = { reflectance = 0.6, index = 1.5, roughness = 0.3 }")]),
        ),
        ("plastic walls", room("plastic = { reflectance = 0.6, index = 1.5 }", "", &[lamp(), ball("paint", WHITE)])),
        (
            "a mix",
            with(&[
                lamp(),
                "[material.silver]\nmirror = { reflectance = 0.9 }\n".to_owned(),
                ball("mix", "mix = { materials = [\"wall\", \"silver\"], amount = 0.4 }"),
            ]),
        ),
        ("a screen with holes", with(&[lamp(), masked])),
        (
            "a pane",
            with(&[
                lamp(),
                body("pane", "thin = { index = 1.5 }", &[&quad([0.0, 1.5, -0.6], [1.2, 0.0, 0.0], [0.0, 1.2, 0.0])]),
            ]),
        ),
        ("a smooth mesh", with(&[lamp(), smooth("diffuse = { reflectance = { rgb = [0.8, 0.5, 0.2] } }")])),
        ("a smooth mesh of rough metal", with(&[lamp(), smooth("conductor = { metal = \"gold\", roughness = 0.4 }")])),
        ("a smooth mesh of glass", with(&[lamp(), smooth("dielectric = { index = 1.5 }")])),
        ("a smooth mesh of silver", with(&[lamp(), smooth("mirror = { reflectance = 0.9 }")])),
        ("a smooth mesh of plastic", with(&[lamp(), smooth("plastic = { reflectance = 0.6, index = 1.5 }")])),
        ("rough glass", with(&[lamp(), ball("frosted", "dielectric = { index = 1.5, roughness = 0.3 }")])),
        (
            "rough glass before a mirror",
            with(&[
                lamp(),
                screen("mirror = { reflectance = 0.9 }"),
                ball("frosted", "dielectric = { index = 1.5, roughness = 0.3 }"),
            ]),
        ),
        (
            "two diffuse bounces by smooth glass",
            room(WHITE, "diffuse_bounces = 2", &[lamp(), smooth("dielectric = { index = 1.5 }")]),
        ),
        ("three bounces", room(WHITE, "max_bounces = 3", &[lamp(), ball("glass", "dielectric = { index = 1.5 }")])),
        ("two bounces", room(WHITE, "max_bounces = 2", &[lamp(), boxes.clone()])),
        ("one diffuse bounce", room(WHITE, "diffuse_bounces = 1", &[lamp(), boxes.clone()])),
        (
            "two diffuse bounces",
            room(WHITE, "diffuse_bounces = 2", &[lamp(), ball("silver", "mirror = { reflectance = 0.9 }")]),
        ),
        (
            "one diffuse bounce by a mirror",
            room(WHITE, "diffuse_bounces = 1", &[ceiling_lamp(), screen("mirror = { reflectance = 0.95 }")]),
        ),
        (
            "two diffuse bounces by rough metal",
            room(
                WHITE,
                "diffuse_bounces = 2",
                &[ceiling_lamp(), screen("conductor = { metal = \"gold\", roughness = 0.4 }")],
            ),
        ),
        (
            "one diffuse bounce by smooth plastic",
            room(
                WHITE,
                "diffuse_bounces = 1",
                &[
                    ceiling_lamp(),
                    screen("plastic = { reflectance = 0.3, index = 2.5 }"),
                    body(
                        "cover",
                        "plastic = { reflectance = 0.2, index = 3 }",
                        &[&quad([-0.8, 2.9, -0.4], [0.9, 0.0, 0.0], [0.0, 0.0, 0.9])],
                    ),
                ],
            ),
        ),
        ("a gap", with(&[wall_with_gap, beyond])),
        ("planes without end", open),
        ("a room of a picometer", scaled(1e-12)),
        ("a room of a trillion", scaled(1e12)),
        (
            "a ball in water",
            with(&[
                lamp(),
                body(
                    "water",
                    "dielectric = { index = 1.333, absorption = { rgb = [0.5, 0.1, 0.05] } }",
                    &["cube = { center = [-0.6, 0.8, -0.8], size = [2, 1.5, 2] }"],
                ),
                body("paint", WHITE, &["sphere = { center = [-0.6, 0.8, -0.8], radius = 0.5 }"]),
            ]),
        ),
        (
            "a lamp in a globe",
            with(&[
                body("globe", "dielectric = { index = 1.5 }", &["sphere = { center = [0, 2, 0], radius = 0.5 }"]),
                body("lamp", LAMP, &["sphere = { center = [0, 2, 0], radius = 0.3 }"]),
            ]),
        ),
    ]
}

/// Returns a world with light vertices if it has light that can be followed.
fn add_light_vertices(world: &World) -> World {
    with_light_vertices(world, &SkyOpenings::default()).unwrap_or_else(|| world.clone())
}

/// Returns how many times as long the same error takes without light vertices.
fn gain(world: &World) -> Option<f64> {
    pilot_noise(&add_light_vertices(world)).gain_over(&pilot_noise(world), &[]).map(Effort::judged)
}

/// Renders images by a method that `change` modifies, either without light vertices or with those that `with` adds.
fn films(text: &str, change: &dyn Fn(&mut Method), with: Option<&dyn Fn(&World) -> World>, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    let film = |seed: u64| {
        let mut setup = Method { seed, ..method(&scene, SPLITTING) };
        change(&mut setup);
        let plain = prepare(&scene, setup);
        render(&with.map_or(plain.clone(), |with| with(&plain)), &|_| ()).0
    };
    (0..seeds).map(film).collect()
}

/// Returns the mean of a quarter of an image in a band. Its standard error is taken from seed to seed, because pixels
/// share light paths.
fn quarter_mean(films: &[Film], quarter: usize, band: usize) -> (f64, f64) {
    let quarter_of = |film: &Film| {
        let half = film.width as usize / 2;
        let in_quarter = |i: &usize| (i % (2 * half)) / half + 2 * (i / (2 * half) / half) == quarter;
        let pixels = (0..film.pixels.len()).filter(in_quarter);
        pixels.map(|i| f64::from(film.pixels[i].rgb[band])).sum::<f64>() / (half * half) as f64
    };
    let (mean, variance) = mean_and_variance(films.iter().map(quarter_of));
    (mean, (variance / films.len() as f64).sqrt())
}

const SEEDS: u64 = 16;

/// Asserts that quarters of images have the same means with and without light vertices, and that the images differ.
fn assert_same(
    what: &str,
    text: &str,
    change: &dyn Fn(&mut Method),
    with: &dyn Fn(&World) -> World,
    claims: usize,
) -> f64 {
    let [plain, resampled] = [None, Some(with)].map(|with| films(text, change, with, SEEDS));
    assert!(plain[0] != resampled[0], "{what}: no light vertices are looked at");
    let mut worst = 0.0_f64;
    for (quarter, band) in (0..4).flat_map(|quarter| (0..3).map(move |band| (quarter, band))) {
        let [(a, error_a), (b, error_b)] = [&plain, &resampled].map(|films| quarter_mean(films, quarter, band));
        let error = libm::hypot(error_a, error_b);
        let off = (a - b).abs() / error;
        assert!(
            // Means of 16 films have the heavier tails of Student's t distribution.
            off < 1.25 * sigma_limit(12 * claims),
            "{what}: quarter {quarter}, band {band}: {b} for {a} +- {error:.1e}, off by {off:.1} sigma"
        );
        worst = larger(worst, off);
    }
    worst
}

/// Light whose wavelengths part before a light vertex counts as dispersed, like light that parts before the camera.
#[test]
fn light_vertices_know_what_is_dispersed() {
    let glass = body(
        "glass",
        "dielectric = { index = { rgb = [1.4, 1.6, 1.8] } }",
        &["cube = { center = [0.3, 2.2, -0.4], size = [1.6, 0.4, 1.6] }"],
    );
    let text = room(WHITE, "model = \"rgb\"", &[lamp(), glass]);
    let text =
        text.replace("height = 12\n", "height = 12\nlayers = [\"dispersed\"]\n").replace("samples = 8", "samples = 32");
    let share = |with: Option<&dyn Fn(&World) -> World>| {
        let films = films(&text, &|_| {}, with, SEEDS);
        mean_and_variance(films.iter().map(|film| {
            let layer = film.layers.iter().find(|layer| layer.layer == Layer::Dispersed).expect("it was asked for");
            let mean = |numbers: &mut dyn Iterator<Item = f32>| numbers.map(f64::from).sum::<f64>();
            mean(&mut layer.values.iter().copied()) / mean(&mut film.pixels.iter().flat_map(|pixel| pixel.rgb))
        }))
    };
    let [plain, resampled] = [share(None), share(Some(&add_light_vertices))];
    let error = ((plain.1 + resampled.1) / SEEDS as f64).sqrt();
    println!("dispersed: {} and {} +- {error:.1e}", plain.0, resampled.0);
    assert!(plain.0 > 0.1 && error < 0.02 * plain.0, "{plain:?}");
    assert!((plain.0 - resampled.0).abs() < 1.25 * sigma_limit(1) * error, "{resampled:?} for {plain:?}");
}

/// Quarters of images of all rooms have the same means with light vertices and without.
#[test]
fn light_vertices_change_no_mean() {
    let rooms = rooms();
    for (what, text) in &rooms {
        let gain = gain(&prepare(&scene(text), method(&scene(text), SPLITTING)));
        let worst = assert_same(what, text, &|_| (), &add_light_vertices, rooms.len());
        println!("{what}: at most {worst:.1} sigma, gain {:.1}", gain.expect("there is noise"));
    }
}

/// Twelve bands of measured paint are as accurate as three numbers.
#[test]
fn light_vertices_carry_all_bands() {
    let text = room(
        "diffuse = { reflectance = \"orange yellow\" }",
        "",
        &[
            body(
                "lamp",
                "emissive = { radiance = { illuminant = \"FL11\", scale = 4 } }",
                &[&quad([0.3, 2.9, -0.4], [0.5, 0.0, 0.0], [0.0, 0.0, 0.4])],
            ),
            ball("paint", "diffuse = { reflectance = \"blue sky\" }"),
        ],
    );
    let basis = plan(&scene(&text)).method.basis;
    assert!(basis.fixed_lanes() > 4 && !basis.draws_wavelengths(), "{}", basis.name());
    assert_same("twelve bands", &text, &|method| method.basis = basis.clone(), &add_light_vertices, 1);
}

/// Asserts that quarters of images show a closed form in the second band, within the noise and an allowed fraction of
/// it. The noise must be less than another fraction.
fn assert_shows(what: &str, films: &[Film], expected: f64, [allowed, noise]: [f64; 2]) {
    for quarter in 0..4 {
        let (mean, error) = quarter_mean(films, quarter, 1);
        println!("{what}: {mean:.6} +- {error:.1e} for {expected:.6}");
        assert!((mean - expected).abs() < sigma_limit(12) * error + allowed * expected, "{what}: {mean}");
        assert!(error < noise * expected, "{what}: {error}");
    }
}

/// An integrating sphere of radius r with a point light of intensity I at its center has the radiance (rho / pi) (I /
/// r^2) / (1 - rho) everywhere: Goebel 1967, *Generalized Integrating-Sphere Theory*, equation 1, for a sphere without
/// ports.
#[test]
fn an_integrating_sphere_shows_its_closed_form() {
    for reflectance in [0.3, 0.8, 0.98] {
        let text = view([1.2, 0.3, 0.0], [-2.0, 0.1, 0.4], 60.0, 12)
            + "[render]\nsamples = 64\n[[light]]\npoint = { position = [0, 0, 0], intensity = 2 }\n"
            + &body(
                "paint",
                &format!("diffuse = {{ reflectance = {reflectance:?} }}"),
                &["sphere = { center = [0, 0, 0], radius = 2 }"],
            );
        let expected = reflectance / PI * (2.0 / 4.0) / (1.0 - reflectance);
        let films = films(&text, &|_| (), Some(&add_light_vertices), SEEDS);
        assert_shows(&format!("reflectance {reflectance}"), &films, expected, [1e-6, 0.01]);
    }
}

/// Light that light paths cannot find is left to paths from the camera.
#[test]
fn rooms_with_light_that_light_paths_miss_have_no_light_vertices() {
    let with = |more: &[String]| room(WHITE, "", more);
    let scenes = [
        ("a sky alone", with(&[environment(1.0)])),
        ("a sun that no bounce sees", with(&["[[light]]\nsun = { toward = [0, 1, 0], irradiance = 1 }\n".into()])),
        ("a pane that looks smoother than it is", with(&[lamp(), smooth("thin = { index = 1.5 }")])),
        ("nothing shines", with(&[])),
    ];
    for (what, text) in &scenes {
        let scene = scene(text);
        let world = prepare(&scene, Method { samples: 4, ..method(&scene, SPLITTING) });
        assert!(with_light_vertices(&world, &SkyOpenings::default()).is_none(), "{what}");
        let forced = world.with_light_vertices(Vec::new(), SkyOpenings::default());
        assert!(render(&forced, &|_| ()).0 == render(&world, &|_| ()).0, "{what}: it is another film");
    }
}

/// Parts of an image equal the whole, with any number of threads and in passes of any size.
#[test]
fn parts_of_an_image_are_the_same_as_the_whole() {
    let text = room(WHITE, "", &[lamp(), ball("glass", "dielectric = { index = 1.5 }")]);
    let whole = films(&text, &|_| (), Some(&add_light_vertices), 1).remove(0);
    let crop = abbe::film::Window { left: 5, top: 4, width: 3, height: 2 };
    for (threads, crop, overscan) in [(1, Some(crop), 0), (2, Some(crop), 0), (3, Some(crop), 3), (1, None, 3)] {
        let mut part = scene(&text);
        (part.film.crop, part.film.overscan) = (crop, abbe::film::Overscan::even(overscan));
        let setup = Method { light_vertices: true, ..method(&part, SPLITTING) };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let part = pool.install(|| film_of(&part, setup));
        let mut compared = 0;
        for (i, pixel) in (0_i32..).zip(&part.pixels) {
            let [x, y] = [part.corner[0] + i % part.width as i32, part.corner[1] + i / part.width as i32];
            if (0..12).contains(&x) && (0..12).contains(&y) {
                assert_eq!(pixel.rgb, whole.at(x as u32, y as u32).rgb, "{threads} threads, pixel {x}, {y}");
                compared += 1;
            }
        }
        assert_eq!(compared, if crop.is_some() { 6 } else { 144 });
    }
}

/// The plan uses light vertices where they pay off, and not where all light comes directly from lamps.
#[test]
fn the_plan_weighs_light_vertices() {
    let larger = |text: &str| text.replace("width = 12\nheight = 12", "width = 384\nheight = 384");
    let closed = larger(&room(WHITE, "", &[lamp()]));
    let planned = plan(&scene(&closed));
    assert!(planned.method.light_vertices, "{:?}", planned.because);
    assert!(planned.because.iter().any(|line| line.contains("light vertices")), "{:?}", planned.because);
    let black = larger(&room("diffuse = { reflectance = 0.01 }", "", &[lamp()]));
    assert!(!plan(&scene(&black)).method.light_vertices);
    let direct = larger(&room(WHITE, "diffuse_bounces = 0", &[lamp()]));
    assert!(!plan(&scene(&direct)).method.light_vertices);
    assert!(!plan(&scene(&room(WHITE, "", &[lamp()]))).method.light_vertices, "too small");
}

/// A faint lamp would have only a few vertices, and its layer would be too bright or too dark as a whole.
#[test]
fn layers_of_faint_lamps_have_no_light_vertices() {
    let planned = |times: f64, layers: &str| {
        let faint = body(
            "faint",
            &format!("emissive = {{ radiance = {} }}", 8.0 * times),
            &[&quad([-1.2, 2.9, 1.4], [0.5, 0.0, 0.0], [0.0, 0.0, 0.4])],
        );
        let size = format!("width = 384\nheight = 384\nlayers = [{layers}]");
        plan(&scene(&room(WHITE, "", &[lamp(), faint]).replace("width = 12\nheight = 12", &size)))
    };
    for (times, layers, expected) in
        [(0.1, "", true), (0.1, "\"lights\"", false), (0.5, "\"lights\"", true), (0.0, "\"lights\"", true)]
    {
        let planned = planned(times, layers);
        assert_eq!(planned.method.light_vertices, expected, "{times} {layers}: {:?}", planned.because);
    }
}

/// One light path in twenty starts anywhere on a huge lamp, of which only the tip is seen, and ends far outside of the
/// room. Such vertices must not take the place of visible ones: gains of 1.0 to 1.6 were 2.3 to 2.6 without them,
/// depending on the seed. Since the rays of gathered photons count on both sides, the gains are 1.9 to 2.1.
#[test]
fn vertices_far_outside_of_a_room_are_seldom_tried() {
    let text = std::fs::read_to_string("scenes/smallpt.toml").expect("it comes with Abbe");
    let planned = plan(&scene(&text));
    assert!(planned.method.light_vertices, "{:?}", planned.because);
    let small = scene(&text.replace("width = 1024\nheight = 768", "width = 256\nheight = 192"));
    for seed in 0..3 {
        let plain = Method { seed, light_vertices: false, ..planned.method.clone() };
        let gain = gain(&prepare(&small, plain));
        println!("smallpt, seed {seed}: gain {gain:?}");
        assert!(gain.is_some_and(|gain| gain > 1.75), "{gain:?}");
    }
}
