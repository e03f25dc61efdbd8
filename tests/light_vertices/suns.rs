//! Light vertices of suns and lamps, under skies whose light is left to paths from the camera.

use std::f64::consts::PI;

use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::trace::{LightPass, MapPasses, Method, SkyOpenings, Smoothness, SunlitPlaces, World};

use super::{
    LAMP, SEEDS, WHITE, add_light_vertices, assert_same, assert_shows, ball, films, lamp, room, screen, smooth, walls,
};
use crate::support::scenes::{body, environment, quad, scene, view};

const SUN: &str = "[[light]]\nsun = { toward = [1, 0.7, 0.1], irradiance = { rgb = [15, 13, 10] } }\n";

fn sun(more: &str) -> String {
    SUN.replace(" }\n", &format!(", {more} }}\n"))
}

const METAL: &str = "conductor = { metal = \"Au\", roughness = 0.3 }";
const GLOSSY: &str = "plastic = { reflectance = 0.6, index = 1.5, roughness = 0.3 }";
const PLASTIC: &str = "plastic = { reflectance = 0.6, index = 1.5 }";

/// Returns a sun so wide that paths from the camera hit its mirror reflections often enough to estimate a mean.
fn wide_sun() -> String {
    sun("angular_diameter = 40")
}

/// Returns the box without its right wall, except for a strip at its lower edge.
fn open_box(render: &str, more: &[String]) -> String {
    let walls = walls();
    let strip = quad([2.0, 0.3, 0.0], [0.0, 0.0, 2.5], [0.0, 0.3, 0.0]);
    let shapes: Vec<&str> = [0, 1, 3, 4, 5].map(|i| walls[i].as_str()).into_iter().chain([strip.as_str()]).collect();
    view([1.3, 1.6, 2.2], [-0.6, 1.0, -1.0], 75.0, 12)
        + &format!("[render]\nsamples = 8\n{render}\n")
        + &body("wall", WHITE, &shapes)
        + &more.concat()
}

fn cubes() -> String {
    let shapes = [
        "cube = { center = [-0.6, 0.6, -0.9], size = [1, 1.2, 1] }",
        "cube = { center = [0.9, 0.3, 0.2], size = 0.6 }",
    ];
    body("red", "diffuse = { reflectance = { rgb = [0.8, 0.2, 0.1] } }", &shapes)
}

fn pane() -> String {
    let window = quad([2.0, 1.8, 0.0], [0.0, 0.0, 2.5], [0.0, 1.2, 0.0]);
    body("pane", "thin = { index = 1.5 }", &[&window])
}

fn rooms() -> Vec<(&'static str, String)> {
    let with = |more: &[String]| open_box("", more);
    let (sky, sun_alone) = (environment(0.8), SUN.to_owned());
    let plane = "[[object]]\nshape.plane = { point = [0, -0.2, 0], normal = [0, 1, 0] }\nmaterial = \"wall\"\n";
    let holes = "[material.paint]\ndiffuse = { reflectance = 0.5 }\n".to_owned()
        + &body(
            "screen",
            "mask = { material = \"paint\", opacity = 0.4 }",
            &[&quad([1.9, 1.5, 0.0], [0.0, 0.0, 2.3], [0.0, 1.2, 0.0])],
        );
    vec![
        ("a sun", with(&[sun_alone.clone(), cubes()])),
        ("a sun and a sky", with(&[sun_alone.clone(), sky.clone(), cubes()])),
        ("a pane", with(&[sun_alone.clone(), sky.clone(), cubes(), pane()])),
        ("a sun and a lamp", with(&[sun_alone.clone(), lamp(), cubes()])),
        ("a lamp under a sky", with(&[lamp(), sky.clone(), cubes()])),
        ("a sun, a sky and a lamp", with(&[sun_alone.clone(), sky.clone(), lamp(), cubes()])),
        ("parallel light", with(&[sun("angular_diameter = 0"), sky.clone(), cubes()])),
        ("a wide sun", with(&[wide_sun(), sky.clone(), cubes()])),
        (
            "two suns",
            with(&[
                sun_alone.clone(),
                "[[light]]\nsun = { toward = [1, 0.2, -0.3], irradiance = { rgb = [2, 4, 9] } }\n".into(),
                cubes(),
            ]),
        ),
        ("a plane without end", with(&[sun_alone.clone(), sky.clone(), plane.into(), cubes()])),
        ("a mirror", with(&[wide_sun(), sky.clone(), ball("silver", "mirror = { reflectance = 0.9 }")])),
        (
            "rough metal",
            with(&[sun_alone.clone(), ball("metal", "conductor = { metal = \"copper\", roughness = 0.3 }")]),
        ),
        ("plastic", with(&[sun_alone.clone(), ball("plastic", "plastic = { reflectance = 0.6, index = 1.5 }")])),
        ("a smooth mesh", with(&[sun_alone.clone(), smooth("diffuse = { reflectance = { rgb = [0.8, 0.5, 0.2] } }")])),
        ("holes", with(&[sun_alone.clone(), sky.clone(), holes, cubes()])),
        (
            "a mirror on the wall",
            open_box("diffuse_bounces = 1", &[wide_sun(), screen("mirror = { reflectance = 0.9 }")]),
        ),
        ("two diffuse bounces", open_box("diffuse_bounces = 2", &[sun_alone.clone(), sky.clone(), cubes()])),
        ("three bounces", open_box("max_bounces = 3", &[sun_alone, sky, cubes()])),
    ]
}

/// Quarters of images have the same means with and without light vertices, whatever lights there are besides those that
/// light paths start from.
#[test]
fn light_vertices_of_some_lights_change_no_mean() {
    let rooms = rooms();
    for (what, text) in &rooms {
        let worst = assert_same(what, text, &|_| (), &add_light_vertices, rooms.len());
        println!("{what}: at most {worst:.1} sigma");
    }
}

/// A sun's light outside the disc from which light paths start is left to paths from the camera, wherever the disc
/// lies.
#[test]
fn paths_may_start_in_any_part_of_a_suns_light() {
    let text = open_box("", &[SUN.into(), environment(0.5), cubes(), pane()]);
    let parts = [
        ("a small part", [-1.0, 0.4, 0.3], 0.5, None),
        ("half", [0.0, 1.0, -2.5], 2.5, Some(64 * 32 + 32)),
        ("all, mostly elsewhere", [0.0; 3], 20.0, Some(64 * 10 + 30)),
        ("nothing", [0.0, 0.0, 30.0], 1.0, None),
    ];
    for (what, center, radius, cell) in parts {
        let cells = cell.map(|cell| (cell, 1.0)).into_iter().collect();
        let sunlit = SunlitPlaces { light: 0, center: DVec3::from(center), radius, cells };
        let part = |world: &World| world.with_light_vertices(vec![sunlit.clone()], SkyOpenings::default());
        if what == "nothing" {
            let [plain, looked] =
                [None, Some(&part as &dyn Fn(&World) -> World)].map(|with| films(&text, &|_| (), with, 1));
            assert_eq!(plain, looked);
        } else {
            let worst = assert_same(what, &text, &|_| (), &part, 3);
            println!("{what}: at most {worst:.1} sigma");
        }
    }
}

/// Light paths from an image of the sky start at its bright parts, here two lamps in front of a sky that varies from
/// side to side. The rest of its light, and the light outside the disc from which they start, is left to paths from the
/// camera.
#[test]
fn l12_what_is_bright_in_an_image_of_the_sky_lights_a_room() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("sky.exr");
    let at = |x: usize, y: usize| match (x, y) {
        (16..=17, 9..=10) => (400.0, 350.0, 300.0),
        (11, 13) => (150.0, 300.0, 500.0),
        _ => (0.5, 0.01 * (x + y) as f32, 0.7),
    };
    exr::prelude::write_rgb_file(&file, 64, 32, at).unwrap();
    let turn = "{ rotate = { axis = [0, 1, 0], degrees = 5 } }";
    let sky = format!(
        "[[light]]\nenvironment = {{ radiance = {{ image = {file:?}, scale = 0.8 }}, transform = [{turn}] }}\n"
    );
    let part = |cells: Vec<(u32, f32)>, center: [f64; 3], radius: f64| {
        let sunlit = SunlitPlaces { light: 0, center: DVec3::from(center), radius, cells };
        move |world: &World| world.with_light_vertices(vec![sunlit.clone()], SkyOpenings::default())
    };
    let with = |more: &[String]| open_box("", &[std::slice::from_ref(&sky), more].concat());
    let map = LightPass {
        photons: 8192,
        lights: vec![0],
        openings: Vec::new(),
        to: Smoothness::ALL.to_vec(),
        map: Some(MapPasses { count: 2, photons: 8192, radius: 0.5, chance: 0.5 }),
    };
    type AddVertices = Box<dyn Fn(&World) -> World>;
    let rooms: [(&str, String, Option<LightPass>, AddVertices); 10] = [
        ("alone", with(&[cubes()]), None, Box::new(add_light_vertices)),
        ("a pane", with(&[cubes(), pane()]), None, Box::new(add_light_vertices)),
        ("a lamp", with(&[cubes(), lamp()]), None, Box::new(add_light_vertices)),
        ("a sun as well", with(&[cubes(), SUN.into()]), None, Box::new(add_light_vertices)),
        ("a mirror", with(&[ball("silver", "mirror = { reflectance = 0.9 }")]), None, Box::new(add_light_vertices)),
        ("plastic", with(&[ball("plastic", PLASTIC)]), None, Box::new(add_light_vertices)),
        ("plastic and photons", with(&[ball("plastic", PLASTIC)]), Some(map.clone()), Box::new(add_light_vertices)),
        (
            "glass and photons",
            with(&[ball("glass", "dielectric = { index = 1.5 }")]),
            Some(map),
            Box::new(add_light_vertices),
        ),
        ("a small part", with(&[cubes()]), None, Box::new(part(Vec::new(), [-1.0, 0.4, 0.3], 0.5))),
        ("half", with(&[cubes(), pane()]), None, Box::new(part(vec![(2080, 1.0)], [0.0, 1.0, -2.5], 2.5))),
    ];
    for (what, text, pass, add_light_vertices) in &rooms {
        let photons = |method: &mut Method| method.light_pass = pass.clone();
        let worst = assert_same(what, text, &photons, add_light_vertices, rooms.len());
        println!("{what}: at most {worst:.1} sigma");
    }
}

/// Photons contribute the caustics of smooth surfaces, and light vertices contribute the rest.
#[test]
fn light_vertices_of_some_lights_leave_to_photons_what_is_theirs() {
    let map = MapPasses { count: 2, photons: 8192, radius: 0.5, chance: 0.5 };
    let glass = || ball("glass", "dielectric = { index = 1.5 }");
    let bent = || smooth("dielectric = { index = 1.5 }");
    let plastic = || ball("plastic", PLASTIC);
    let frosted = || {
        let cube = "cube = { center = [0.9, 0.5, 0.2], size = 0.8 }";
        body("frosted", "dielectric = { index = 1.5, roughness = 0.3 }", &[cube])
    };
    // Gathered photons are blurred, light at vertices is not.
    let sharp = MapPasses { radius: 0.3, chance: 1.0, ..map };
    let globe = |render: &str| {
        let sphere = |radius: f64| format!("sphere = {{ center = [0, 2, 0], radius = {radius:?} }}");
        let globe = body("globe", "dielectric = { index = 1.5 }", &[&sphere(0.5)]);
        room(WHITE, render, &[globe, body("lamp", LAMP, &[&sphere(0.3)])])
    };
    let rooms = [
        ("glass in the sun", open_box("", &[SUN.into(), environment(0.5), glass()]), vec![0], Some(map)),
        ("a pane", open_box("", &[SUN.into(), environment(0.5), cubes(), pane()]), vec![0], Some(map)),
        ("smooth glass in the sun", open_box("", &[SUN.into(), environment(0.5), bent()]), vec![0], Some(map)),
        ("smooth glass under a lamp", open_box("", &[lamp(), bent(), cubes()]), vec![0], Some(map)),
        ("smooth and rough glass", open_box("", &[lamp(), bent(), frosted()]), vec![0], Some(map)),
        ("photons that are shown", open_box("", &[wide_sun(), environment(0.5), glass()]), vec![0], None),
        ("a lamp in a globe", globe(""), vec![0], Some(sharp)),
        ("a lamp in a globe, two diffuse bounces", globe("diffuse_bounces = 2"), vec![0], Some(sharp)),
        ("a lamp in a globe, four bounces", globe("max_bounces = 4"), vec![0], Some(sharp)),
        ("plastic in the sun", open_box("", &[SUN.into(), environment(0.5), plastic(), cubes()]), vec![0], Some(map)),
        ("plastic under a lamp", open_box("", &[lamp(), plastic(), cubes()]), vec![0], Some(map)),
        ("a smooth mesh of plastic", open_box("", &[SUN.into(), lamp(), smooth(PLASTIC)]), vec![0, 1], Some(map)),
        (
            "plastic, and photons that are shown",
            open_box("", &[wide_sun(), environment(0.5), plastic()]),
            vec![0],
            None,
        ),
        (
            "metal in the sun",
            open_box("", &[SUN.into(), environment(0.5), ball("metal", METAL), cubes()]),
            vec![0],
            Some(map),
        ),
        ("glossy plastic", open_box("", &[lamp(), ball("glossy", GLOSSY), cubes()]), vec![0], Some(map)),
        ("glossy plastic, shown", open_box("", &[lamp(), ball("glossy", GLOSSY), cubes()]), vec![0], None),
        ("a smooth mesh of metal", open_box("", &[SUN.into(), lamp(), smooth(METAL)]), vec![0, 1], Some(map)),
        ("a smooth mesh of glossy plastic", open_box("", &[SUN.into(), lamp(), smooth(GLOSSY)]), vec![0, 1], Some(map)),
        ("metal in a closed room", room(WHITE, "", &[lamp(), ball("metal", METAL)]), vec![0], Some(map)),
        ("glossy plastic in a closed room", room(WHITE, "", &[lamp(), ball("glossy", GLOSSY)]), vec![0], Some(map)),
        (
            "photons of the lamp alone",
            open_box("", &[SUN.into(), lamp(), environment(0.5), glass()]),
            vec![1],
            Some(map),
        ),
    ];
    for (what, text, lights, map) in &rooms {
        let photons = |method: &mut Method| {
            method.light_pass = Some(LightPass {
                photons: 8192,
                lights: lights.clone(),
                openings: Vec::new(),
                to: Smoothness::ALL.to_vec(),
                map: *map,
            });
        };
        let worst = assert_same(what, text, &photons, &add_light_vertices, rooms.len());
        println!("{what}: at most {worst:.1} sigma");
    }
}

/// A disc of radius R in the sun has the radiosity B = rho E cos t. On a small disc at the height h above its center,
/// its irradiance is B R^2 / (R^2 + h^2): Howell, Menguc, Daun & Siegel 2020, *Thermal Radiation Heat Transfer*,
/// configuration factor of an element parallel to a disk.
#[test]
fn what_a_sunlit_disc_sends_has_its_closed_form() {
    for (radius, height) in [(1.0, 1.0), (3.0, 0.5), (0.4, 2.0)] {
        let text = view([0.1, height - 0.3, 0.03], [0.0, height, 0.0], 0.6, 12)
            + "[render]\nsamples = 64\nmax_bounces = 2\n"
            + SUN
            + &body(
                "floor",
                "diffuse = { reflectance = 0.6 }",
                &[&format!("disc = {{ center = [0, 0, 0], normal = [0, 1, 0], radius = {radius:?} }}")],
            )
            + &body(
                "small",
                "diffuse = { reflectance = 0.5 }",
                &[&format!("disc = {{ center = [0, {height:?}, 0], normal = [0, -1, 0], radius = 0.008 }}")],
            );
        let irradiance = 13.0 * 0.7 / (1.0_f64 + 0.49 + 0.01).sqrt();
        let factor = radius * radius / (radius * radius + height * height);
        let expected = 0.5 / PI * 0.6 * irradiance * factor;
        let films = films(&text, &|_| (), Some(&add_light_vertices), 10 * SEEDS);
        assert_shows(&format!("radius {radius}, height {height}"), &films, expected, [1e-4, 0.02]);
    }
}

/// Hardly any path from a lamp that is as far away as a sun lands in the room. A pilot without vertices from it used to
/// find no noise, and a quarter of the light was lost.
#[test]
fn a_lamp_far_away_has_no_light_vertices() {
    for (distance, expected) in [(3.0, true), (1e4, false)] {
        let toward = DVec3::new(1.0, 0.7, 0.1);
        let (center, radius) = (toward * distance, 0.1 * distance);
        let shape = format!("sphere = {{ center = [{}, {}, {}], radius = {radius} }}", center.x, center.y, center.z);
        let text = open_box("", &[body("lamp", "emissive = { radiance = 300 }", &[&shape]), cubes()]);
        let decided = plan(&scene(&text.replace("width = 12\nheight = 12", "width = 384\nheight = 384")));
        assert_eq!(decided.method.light_vertices, expected, "at {distance}: {:?}", decided.because);
    }
}

/// Of the paths from a lamp in a black box, 3 of 1000 leave through a hole of a tenth of its side. All pixels share
/// them: an image used to be brighter or darker by 4 %.
#[test]
fn a_lamp_behind_a_small_hole_has_no_light_vertices() {
    for (half, expected) in [(0.2, true), (0.03, false)] {
        let (middle, strip) = (0.5 * (0.3 + half), 0.5 * (0.3 - half));
        let (x, z) = ([0.3, 0.0, 0.0], [0.0, 0.0, 0.3]);
        let upright = [0.0, 0.3, 0.0];
        let black = [
            quad([0.0, 2.4, -0.4], upright, z),
            quad([0.6, 2.4, -0.4], upright, z),
            quad([0.3, 2.4, -0.7], x, upright),
            quad([0.3, 2.4, -0.1], x, upright),
            quad([0.3, 2.7, -0.4], z, x),
            quad([0.3, 2.1, -0.4 + middle], x, [0.0, 0.0, strip]),
            quad([0.3, 2.1, -0.4 - middle], x, [0.0, 0.0, strip]),
            quad([0.3 + middle, 2.1, -0.4], [strip, 0.0, 0.0], [0.0, 0.0, half]),
            quad([0.3 - middle, 2.1, -0.4], [strip, 0.0, 0.0], [0.0, 0.0, half]),
        ];
        let text = view([1.3, 1.6, 2.2], [-0.6, 1.0, -1.0], 75.0, 384)
            + "[render]\nsamples = 8\n"
            + &body("wall", WHITE, &["cube = { center = [0, 1.5, 0], size = [4, 3, 5] }"])
            + &body("black", "diffuse = { reflectance = 0 }", &black.each_ref().map(String::as_str))
            + &body(
                "lamp",
                "emissive = { radiance = 3000 }",
                &["sphere = { center = [0.3, 2.4, -0.4], radius = 0.05 }"],
            );
        let decided = plan(&scene(&text));
        assert_eq!(decided.method.light_vertices, expected, "a hole of {half}: {:?}", decided.because);
    }
}
