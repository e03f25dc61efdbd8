//! Row D9: lanes that share a path where one is totally reflected and another is not.

use abbe::material::Interface;
use abbe::math::{DVec2, DVec3};
use abbe::scene::Scene;
use abbe::spectrum::Curve;

use crate::support::larger::larger;
use crate::support::scenes::{
    EVERY_BRANCH, GROUND, Mean, SINGLE_PATH, body, films_of, method, render_film, scene, view,
};

/// N-SF11 at about 700, 550 and 400 nm.
const INDICES: [f64; 3] = [1.77, 1.79, 1.845];
const SIDE: u32 = 512;
const SEEDS: u64 = 4;
const LANES: f32 = 3.0;

/// Returns a view from inside the glass onto its surface, over sin^2 from 0.9 / n^2 of the blue lane to 1.02 / n^2 of
/// the red one. Beyond the surface everything has a radiance of 1. Inside, nothing emits light.
fn text() -> String {
    let [low, high] =
        [(0.9, INDICES[2]), (1.02, INDICES[0])].map(|(share, n): (f64, f64)| libm::asin(share.sqrt() / n));
    let (middle, field) = (0.5 * (low + high), (high - low).to_degrees());
    let (sin, cos) = libm::sincos(middle);
    let flint = format!("dielectric = {{ index = {{ rgb = {INDICES:?} }} }}");
    view([0.0, -1.0, 0.0], [sin, cos - 1.0, 0.0], field, SIDE)
        + &body("flint", &flint, &[GROUND])
        + &body("sky", "emissive = { radiance = 1 }", &["plane = { point = [0, 9, 0], normal = [0, -1, 0] }"])
}

/// Returns the mean of each lane's transmittance times n^2 over the image, by the midpoint rule.
fn expected(scene: &Scene<Curve>) -> [f64; 3] {
    const STEPS: u32 = 1000;
    let place = |step: u32| (f64::from(step) + 0.5) / f64::from(STEPS) * f64::from(SIDE);
    INDICES.map(|n| {
        let cosine = |x: u32, y: u32| scene.camera.ray(DVec2::new(place(x), place(y))).direction.dot(DVec3::Y);
        let row = |y: u32| (0..STEPS).map(|x| Interface::new(n, 1.0, cosine(x, y)).transmittance).sum::<f64>();
        n * n * (0..STEPS).map(row).sum::<f64>() / f64::from(STEPS * STEPS)
    })
}

#[test]
fn d9_lanes_that_disagree_at_the_critical_angle_keep_their_energy() {
    let scene = scene(&text());
    let expected = expected(&scene);
    let films = films_of(&scene, &method(&scene, SINGLE_PATH), 0..SEEDS);
    let mean = Mean::over_seeds(&films);
    println!("D9: {:?} for {expected:?}, sigma {:.2e}", mean.value, mean.worst_relative_error(expected));
    mean.assert_near(expected, 1, "random choice");
    assert!(mean.worst_relative_error(expected) <= 0.003, "sigma is {}", mean.worst_relative_error(expected));

    // With one sample per pixel, a pixel shows the weight of its path.
    let weights = films
        .iter()
        .flat_map(|film| &film.pixels)
        .flat_map(|pixel| (0..3).map(|lane| pixel.rgb[lane] / (INDICES[lane] * INDICES[lane]) as f32));
    let largest = weights.fold(0.0, larger);
    println!("D9: largest weight {largest}");
    assert!(largest <= LANES * (1.0 + 1e-6), "a weight of {largest}");
    assert!(largest > 1.0, "no lane ever stood for others");
}

#[test]
fn d9_splitting_at_the_critical_angle_leaves_nothing_to_chance() {
    let text = text();
    let (film, _) = render_film(&text, EVERY_BRANCH);
    let scene = scene(&text);
    for (at, pixel) in film.pixels.iter().enumerate() {
        let center = DVec2::new((at as u32 % SIDE) as f64 + 0.5, (at as u32 / SIDE) as f64 + 0.5);
        let cosine = scene.camera.ray(center).direction.dot(DVec3::Y);
        for (lane, n) in INDICES.into_iter().enumerate() {
            let exact = n * n * Interface::new(n, 1.0, cosine).transmittance;
            assert!((f64::from(pixel.rgb[lane]) - exact).abs() <= 1e-6, "pixel {at}, lane {lane}");
        }
    }
}
