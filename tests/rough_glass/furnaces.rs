//! Bodies of rough glass are invisible in a uniform environment.

use abbe::film::Film;
use abbe::spectrum::Basis;
use abbe::trace::{Method, Transport};

use crate::support::scenes::{
    EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, body, environment, film_of, method, render_film, scene, sigma_limit,
    view,
};

const BALL: &str = "sphere = { center = [0, 0, 0], radius = 1 }";
const SKY: &str = "[[light]]\nenvironment = { radiance = 0.1 }\n";
const WATER: &str = "dielectric = { index = 1.333, priority = -1 }";

/// Returns bodies for a view that sees nothing else, each with its name and its number of samples.
fn scenes() -> Vec<(String, String, u32)> {
    let glass = |index: &str, roughness: f64| format!("dielectric = {{ index = {index}, roughness = {roughness:?} }}");
    let mut scenes = Vec::new();
    for (index, roughness, samples) in
        [("1.5", 0.1, 16), ("1.5", 0.4, 32), ("1.5", 1.0, 64), ("2.4", 0.6, 128), ("1.1", 0.5, 32)]
    {
        let ball = body("glass", &glass(index, roughness), &[BALL]);
        scenes.push((format!("ball of {index}, roughness {roughness}"), ball, samples));
    }
    for roughness in [0.15, 0.7] {
        let ball = body("glass", &glass("{ rgb = [1.3, 1.5, 1.8] }", roughness), &[BALL]);
        scenes.push((format!("dispersive ball, roughness {roughness}"), ball, 64));
    }
    let pool = body("water", WATER, &["cube = { center = [0, 0, 0], size = 2.4 }"]);
    let ball = body("glass", &glass("1.6", 0.5), &[BALL]) + &pool;
    scenes.push(("ball in water".to_owned(), ball, 64));
    scenes
}

#[test]
fn rough_glass_is_invisible_in_an_even_environment() {
    let scenes = scenes();
    for (name, bodies, samples) in &scenes {
        for (transport, times) in [(SPLITTING, 1.0), (SINGLE_PATH, 2.0)] {
            let text = view([1.3, 0.9, 4.1], [0.05, 0.02, 0.1], 14.0, 16)
                + &format!("[render]\nsamples = {samples}\n")
                + bodies
                + &environment(1.0);
            let (film, report) = render_film(&text, transport);
            assert_eq!((report.non_finite, report.unmatched), (0, 0), "{name}");
            let mean = Mean::of(&film);
            println!("{name}: {:.5?} +- {:.1e}", mean.value, mean.worst_relative_error([1.0; 3]));
            // The tables lose or gain 3e-4 at each of a few surfaces: see `sides`. This test judges whole surfaces or
            // lanes.
            for band in 0..3 {
                let off = (mean.value[band] - 1.0).abs();
                assert!(off <= 1e-3 + 3.5 * mean.error[band], "{name}: {mean:?}");
                assert!(mean.error[band] <= times * 6e-3, "{name}: {mean:?}");
            }
        }
    }
}

#[test]
fn lanes_that_part_or_stay_together_at_rough_glass_lose_nothing() {
    // The lanes of N-SF11 part at low roughness and stay together at high roughness. Heroes count where they part.
    for roughness in [0.03, 0.3, 0.8] {
        let glass = format!("dielectric = {{ index = \"N-SF11\", roughness = {roughness:?} }}");
        let text = view([1.3, 0.9, 4.1], [0.05, 0.02, 0.1], 14.0, 16)
            + "[render]\nsamples = 64\n"
            + &body("glass", &glass, &[BALL])
            + &environment(1.0);
        let scene = scene(&text);
        let emission = abbe::spectrum::Emission::new(&1.0.into(), scene.film.color_space);
        let basis = Basis::bands(scene.film.color_space, 12, &[]).with_heroes(4, &[emission]);
        for split in [0.05, 1.0] {
            let transport = Transport::Random { split, roulette: 0.05 };
            let method = Method { basis: basis.clone(), ..method(&scene, transport) };
            let film = film_of(&scene, method);
            let mean = Mean::of(&film);
            println!("N-SF11, roughness {roughness}: {:.4?} +- {:.4?}", mean.value, mean.error);
            for band in 0..3 {
                let off = (mean.value[band] - 1.0).abs();
                assert!(off <= 1.5e-3 + 4.0 * mean.error[band], "roughness {roughness}: {mean:?}");
                assert!(mean.error[band] < 0.02, "roughness {roughness}: {mean:?}");
            }
        }
    }
}

#[test]
fn between_equal_indices_rough_glass_is_not_there() {
    let lamp = body(
        "lamp",
        "emissive = { radiance = { rgb = [3, 2, 1] } }",
        &["quad = { center = [0, 0, -4], u = [3, 0, 0], v = [0, 3, 0] }"],
    );
    let text =
        |bodies: &str| view([0.3, 0.2, 4.0], [0.0; 3], 30.0, 32) + "filter = \"center\"\n" + bodies + &lamp + SKY;
    let pool = body("water", WATER, &["cube = { center = [0, 0, 0], size = 2.4 }"]);
    let ball = body("ball", "dielectric = { index = 1.333, roughness = 0.6 }", &[BALL]);
    let [with, without] = [pool.clone() + &ball, pool].map(|bodies| render_film(&text(&bodies), EVERY_BRANCH).0);
    // No ray is deflected and none is lost. Only the order of roundings may differ.
    for (with, without) in with.pixels.iter().zip(&without.pixels) {
        for (a, b) in with.rgb.into_iter().zip(without.rgb) {
            assert!((a - b).abs() < 32.0 * f32::EPSILON * b, "{a} for {b}");
        }
    }
}

/// Light leaves a body of n = 9.9 after some 170 surfaces on average. None of them may gain or lose light. The spread
/// of the pixels has to reflect the noise, so more than a few of them must carry it.
#[test]
fn very_dense_rough_glass_neither_gains_nor_loses_seen_from_outside_and_from_inside() {
    let mut cases = Vec::new();
    let roughest = [0.1, 0.5, 0.77, 0.9, 0.99];
    for (index, roughnesses) in [(2.4, &[0.3, 0.99][..]), (4.0, &[0.1, 0.5, 0.99]), (9.9, &roughest)] {
        let outside = view([1.3, 0.9, 4.1], [0.05, 0.02, 0.1], 14.0, 16);
        let inside = view([0.3, -0.1, 0.2], [0.4, 0.9, -0.7], 120.0, 16);
        for &roughness in roughnesses {
            let glass = format!("dielectric = {{ index = {index:?}, roughness = {roughness:?} }}");
            let rest = "[render]\nsamples = 16\n".to_owned() + &body("glass", &glass, &[BALL]) + &environment(1.0);
            let what = format!("n {index}, roughness {roughness}");
            cases.push((format!("{what}, outside"), outside.clone() + &rest, SPLITTING, 1.0));
            cases.push((format!("{what}, inside"), inside.clone() + &rest, SINGLE_PATH, index * index));
        }
    }
    for (what, text, transport, expected) in &cases {
        let (film, report) = render_film(text, *transport);
        let mean = Mean::of(&film);
        let (value, error) = (mean.value[1] / expected, mean.error[1] / expected);
        let (z, carried, lost) = ((value - 1.0) / error, noisy_pixels(&film), report.stopped);
        println!("{what}: {value:.5} +- {error:.1e}, z {z:.2}, by {carried:.0} pixels, {lost} stopped");
        // The rounding of a few hundred factors in 32 bits.
        let limit = sigma_limit(cases.len()) * error + 256.0 * f64::from(f32::EPSILON);
        assert!((value - 1.0).abs() <= limit && error < 0.05, "{what}: {mean:?}");
        assert!(error < 1e-5 || carried >= 4.0, "{what}: {carried} pixels carry the noise");
    }
}

/// Returns how many pixels carry the noise: (sum d^2)^2 / sum d^4 for their deviations d. That is a third of them if
/// the noise is normal. It is a few of them if a tail is so long that the spread of the pixels does not reflect their
/// error. With fewer than four, the spread is off by half.
fn noisy_pixels(film: &Film) -> f64 {
    let green = || film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1]));
    let mean = green().sum::<f64>() / film.pixels.len() as f64;
    let [squares, fourths] = [2.0, 4.0].map(|power| green().map(|x| libm::pow(x - mean, power)).sum::<f64>());
    squares * squares / fourths
}
