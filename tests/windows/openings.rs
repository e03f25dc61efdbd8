//! The sky through openings: the same light as without having learned where it is seen, and less noise.

use abbe::film::Film;
use abbe::trace::{Method, World, render};

use crate::support::scenes::{Mean, SINGLE_PATH, SPLITTING, body, method, moments, scene, view};

const SIDE: u32 = 24;

/// A closed room with an opening in its left wall, of half the given height; `more` may close it or stand in it.
fn room(opening: f64, lights: &str, more: &str, samples: u32) -> String {
    let wall = |y: f64, half: f64| format!("quad = {{ center = [-2, {y:?}, 0], u = [0, 0, 2], v = [0, {half:?}, 0] }}");
    let (low, high) = (0.5 * (-1.5 - opening), 0.5 * (1.5 + opening));
    let (below, above) = (wall(low, 0.5 * (1.5 - opening)), wall(high, 0.5 * (1.5 - opening)));
    view([1.6, 0.4, 1.7], [-0.8, -0.8, -0.8], 70.0, SIDE)
        + &format!("[render]\nsamples = {samples}\n")
        + &body(
            "wall",
            "diffuse = { reflectance = 0.6 }",
            &[
                "quad = { center = [0, -1.5, 0], u = [2, 0, 0], v = [0, 0, 2] }",
                "quad = { center = [0, 1.5, 0], u = [2, 0, 0], v = [0, 0, 2] }",
                "quad = { center = [0, 0, -2], u = [2, 0, 0], v = [0, 1.5, 0] }",
                "quad = { center = [0, 0, 2], u = [2, 0, 0], v = [0, 1.5, 0] }",
                "quad = { center = [2, 0, 0], u = [0, 0, 2], v = [0, 1.5, 0] }",
                &below,
                &above,
                "cube = { center = [0, -1.2, 0], size = 0.6 }",
            ],
        )
        + more
        + lights
}

const SKY: &str = "[[light]]\nenvironment = { radiance = 3 }\n";
const SUN: &str = "[[light]]\nsun = { toward = [-2, 1, 0.3], irradiance = 20 }\n";
const LAMP: &str = "[material.lamp]\nemissive = { radiance = 2 }\n[[object]]\nmaterial = \"lamp\"\n\
    shape.sphere = { center = [1, 1, -1], radius = 0.1 }\n";
const PANE: &str = "[material.pane]\nthin = { index = 1.52 }\n[[object]]\nmaterial = \"pane\"\n\
    shape.quad = { center = [-2, 0, 0], u = [0, 0, 2], v = [0, 1.5, 0] }\n";
const HOLES: &str = "[material.blind]\nmask = { material = \"wall\", opacity = 0.5 }\n[[object]]\nmaterial = \"blind\"\n\
    shape.quad = { center = [-2.1, 0, 0], u = [0, 0, 2], v = [0, 1.5, 0] }\n";

fn films(text: &str, learns: bool, single: bool, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    let asked = method(&scene, if single { SINGLE_PATH } else { SPLITTING });
    let world = |seed| {
        let method = Method { seed, ..asked.clone() };
        if learns { World::new(&scene, method) } else { World::untaught(&scene, method) }
    };
    (0..seeds).map(|seed| render(&world(seed), &|_| ()).0).collect()
}

/// The mean over pixels of the variance over seeds.
fn noise(films: &[Film]) -> f64 {
    let pixels = films[0].pixels.len();
    (0..pixels).map(|i| moments(films.iter().map(move |film| f64::from(film.pixels[i].rgb[1]))).1).sum::<f64>()
        / pixels as f64
}

#[test]
fn l7_a_room_is_as_bright_by_what_was_learned_as_without_and_less_noisy() {
    let image = "[[light]]\nenvironment = { radiance = { image = \"scenes/textures/evening.hdr\" } }\n";
    let cases = [
        ("an opening", false, SKY.to_owned(), "", 3.0),
        ("sun and sky through a pane", false, SKY.to_owned() + SUN, PANE, 1.2),
        ("sun and sky through a pane", true, SKY.to_owned() + SUN, PANE, 1.2),
        ("an image and a lamp behind a blind", false, image.to_owned() + LAMP, HOLES, 1.0),
    ];
    for (name, single, lights, more, quieter) in cases {
        let text = room(0.4, &lights, more, 256);
        let (with, without) = (films(&text, true, single, 4), films(&text, false, single, 4));
        let mut learned = Mean::over_seeds(with.iter());
        let plain = Mean::over_seeds(without.iter());
        let gain = noise(&without) / noise(&with);
        println!("{name}, single {single}: {learned:.5?} for {plain:.5?}, {gain:.1} times less noise");
        for band in 0..3 {
            learned.error[band] = libm::hypot(learned.error[band], plain.error[band]);
        }
        assert!(learned.worst_error(plain.value) < 0.03, "{name}: {learned:?}");
        learned.assert_near(plain.value, 12, name);
        assert!(gain > quieter, "{name}: {gain}");
    }
}

#[test]
fn an_open_scene_and_a_closed_room_learn_nothing() {
    let ball = body("ball", "diffuse = { reflectance = 0.5 }", &["sphere = { center = [0, 0, 0], radius = 0.2 }"]);
    let open = view([0.0, 2.0, 5.0], [0.0; 3], 40.0, SIDE) + "[render]\nsamples = 256\n" + &ball + SKY;
    for text in [open, room(0.0, &(SKY.to_owned() + LAMP), "", 256)] {
        let (with, without) = (films(&text, true, false, 1), films(&text, false, false, 1));
        for (a, b) in with[0].pixels.iter().zip(&without[0].pixels) {
            assert_eq!(a.rgb, b.rgb);
        }
    }
}

#[test]
fn a_part_of_a_room_is_the_same_as_in_the_whole() {
    let text = room(0.4, SKY, PANE, 256);
    let image = |text: &str| films(text, true, false, 1).remove(0);
    let full = image(&text);
    let part = image(&text.replace("[film]\n", "[film]\ncrop = [5, 9, 7, 4]\n"));
    assert_eq!(part.pixels.len(), 28);
    for (i, pixel) in (0..).zip(&part.pixels) {
        assert_eq!(pixel, full.at(5 + i % 7, 9 + i / 7));
    }
}
