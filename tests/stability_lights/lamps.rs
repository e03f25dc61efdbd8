//! Rows A6, L1 to L3 and L5.

use std::f64::consts::PI;

use abbe::math::{DVec3, Ray};
use abbe::shape::{Shape, Sphere};

use crate::support::exact::Exact;
use crate::support::larger::larger;
use crate::support::random::Random;
use crate::support::scenes::{
    GROUND, Mean, SINGLE_PATH, SPLITTING, body, environment, mean_and_variance, render_film, render_films, sigma_limit,
    view,
};

/// Lamps that fill a thousandth of what a pixel sees, sampled 1024 times. If random hits find them, they have the noise
/// of counting: sqrt((1 - p) / (p n)) = 0.988 of the mean at most. With next-event estimation they do not.
#[test]
fn a6_a_small_lamp_is_noisy_where_it_is_found_by_chance_and_quiet_where_it_is_aimed_at() {
    const SEEDS: u64 = 64;
    const SHARE: f64 = 1e-3;
    let relative = |text: &str, expected: f64| {
        let seeds = render_films(text, SINGLE_PATH, SEEDS);
        let (mean, variance) = mean_and_variance(seeds.iter().map(|(film, _)| f64::from(film.pixels[0].rgb[1])));
        let error = (variance / SEEDS as f64).sqrt();
        assert!((mean - expected).abs() <= sigma_limit(2) * error + 1e-6 * expected, "{mean} for {expected}");
        variance.sqrt() / mean
    };
    let render = "filter = \"box\"\n[render]\nsamples = 1024\ndiffuse_bounces = 0\n";
    // At distance 1 the view is 2 by 2, and a quad is given by its half edges.
    let half = SHARE.sqrt();
    let lamp = |center: &str, u: &str, v: &str| {
        let quad = format!("quad = {{ center = {center}, u = {u}, v = {v} }}");
        body("lamp", "emissive = { radiance = 1 }", &[&quad])
    };
    let seen = view([0.0; 3], [0.0, 0.0, -1.0], 90.0, 1)
        + render
        + &lamp("[0.31, -0.17, -1]", &format!("[{half:?}, 0, 0]"), &format!("[0, {half:?}, 0]"));
    let by_chance = relative(&seen, SHARE);
    // Far above a white floor, the lamp fills a thousandth of what the floor sees.
    let above = view([0.0, 1.0, 0.1], [0.0; 3], 1e-3, 1)
        + render
        + &body("floor", "diffuse = { reflectance = 1 }", &[GROUND])
        + &lamp("[0, 1000, 0]", "[28, 0, 0]", "[0, 0, 28]");
    // The light of a square on a small surface below it, with a as half its edge over the distance: Hamilton & Morgan
    // 1952, P-5.
    let a: f64 = 28.0 / 1000.0;
    let across = (1.0 + a * a).sqrt();
    let aimed = relative(&above, 4.0 / PI * a / across * libm::atan(a / across));
    println!("A6: deviation {by_chance:.3} of the mean by chance, {aimed:.5} aimed at");
    assert!(by_chance <= 0.988 * 1.0 + 3.0 * 0.988 / (2.0 * SEEDS as f64).sqrt(), "{by_chance}");
    assert!((1e-9..=0.01).contains(&aimed), "{aimed}");
}

/// Returns the solid angle of a sphere over 2 PI: s^2 / (1 + sqrt(1 - s^2)), with 31 digits.
fn one_minus_cos(radius: f64, squared_distance: Exact) -> Exact {
    let s2 = Exact::from(radius) * Exact::from(radius) / squared_distance;
    s2 / (Exact::from(1.0) + (Exact::from(1.0) - s2).sqrt())
}

#[test]
fn l1_lamps_far_away_keep_their_solid_angle_and_their_irradiance() {
    let mut random = Random::new(31);
    let mut worst = 0f64;
    for power in 1..=6 {
        let ratio = libm::pow(10.0, -f64::from(power));
        for _ in 0..1000 {
            let (radius, axis) = (random.between(0.5, 2.0), random.direction());
            let center = axis * (radius / ratio);
            let sphere = Shape::Sphere(Sphere::new(center, radius));
            let sample = sphere.sample(DVec3::ZERO, random.pair()).expect("it is outside");
            let ray = Ray { origin: DVec3::ZERO, direction: sample.direction };
            let intersection = sphere.intersect(&ray, f64::INFINITY);
            // Exactly at the rim, a direction may miss by rounding. A draw there is as rare as the rim is thin.
            let Some(intersection) = intersection else { continue };
            let [x, y, z] = center.to_array().map(|x| Exact::from(x) * Exact::from(x));
            let solid_angle = Exact::from(2.0 * PI) * one_minus_cos(radius, x + y + z);
            let off = (Exact::from(sphere.pdf(&ray, &intersection)) * solid_angle - Exact::from(1.0)).abs().rounded();
            assert!(off <= 1e-14, "R / D = {ratio}: the density is off by {off:e}");
            worst = larger(worst, off);
        }
        // The irradiance of a surface that faces the sphere is PI s^2: the mean of the cosine over the pdf.
        let sphere = Shape::Sphere(Sphere::new(DVec3::Z / ratio, 1.0));
        let (mut sum, mut lost) = (0.0, 0);
        for i in 0..4096_u32 {
            let u = [(f64::from(i) + 0.5) / 4096.0, f64::from(i.reverse_bits()) / 4_294_967_296.0];
            let ray = Ray { origin: DVec3::ZERO, direction: sphere.sample(DVec3::ZERO, u).expect("outside").direction };
            match sphere.intersect(&ray, f64::INFINITY) {
                Some(intersection) => sum += ray.direction.z / sphere.pdf(&ray, &intersection) / 4096.0,
                None => lost += 1,
            }
        }
        assert!((sum / (PI * ratio * ratio) - 1.0).abs() <= 1e-3, "R / D = {ratio}: irradiance {sum:e}");
        assert!(lost <= 1, "R / D = {ratio}: {lost} of 4096 directions miss");
    }
    println!("L1: density off by at most {worst:.1e} of itself");
}

/// Returns a white ball inside an emissive sphere. The ball and everything else are as bright as the sphere: a furnace.
fn inside(radius: f64, at: DVec3) -> String {
    let lamp = format!("sphere = {{ center = [0, 0, 0], radius = {radius:?} }}");
    let ball = format!("sphere = {{ center = {:?}, radius = 0.5 }}", (at - DVec3::Z * 1.5).to_array());
    view(at.to_array(), (at - DVec3::Z).to_array(), 60.0, 16)
        + "[render]\nsamples = 64\n"
        + &body("lamp", "emissive = { radiance = 1 }", &[&lamp])
        + &body("white", "diffuse = { reflectance = 1 }", &[&ball])
}

#[test]
fn l2_whatever_is_inside_a_shining_sphere_is_as_bright_as_the_sphere() {
    let (film, report) = render_film(&inside(4.0, DVec3::new(0.3, -0.2, 1.0)), SPLITTING);
    assert_eq!(report.non_finite, 0);
    let mean = Mean::of(&film);
    mean.assert_near([1.0; 3], 1, "furnace of a sphere");
    assert!((mean.value[1] - 1.0).abs() <= 1e-3, "{mean:?}");
}

/// The sphere is so large that an object inside is one part in 10^8 of it, seen from its center and from beside its
/// wall.
#[test]
fn h3_a_shining_sphere_of_any_size_lights_what_is_inside_alike() {
    for radius in [1e3, 1e8] {
        for place in [0.0, 0.5, 1.0 - 3.0 / radius] {
            let (film, report) = render_film(&inside(radius, DVec3::new(radius * place, 0.0, 0.0)), SPLITTING);
            assert_eq!((report.non_finite, report.unmatched), (0, 0));
            let mean = Mean::of(&film);
            mean.assert_near([1.0; 3], 6, &format!("radius {radius}, place {place}"));
            assert!((mean.value[1] - 1.0).abs() <= 3e-3, "radius {radius}, place {place}: {mean:?}");
        }
    }
}

/// A square on a wall reaches down to the floor. Points of the floor are at ever smaller distances from the wall.
#[test]
fn l3_a_lamp_that_touches_the_floor_lights_it_quietly_up_to_the_edge() {
    const SAMPLES: f64 = 16.0 * 16.0 * 64.0;
    for distance in [0.1f64, 1e-2, 1e-3, 1e-4] {
        let text = view([0.0, 5.0, distance], [0.0, 0.0, distance], 1e-7, 16)
            .replace("vertical_fov", "up = [1, 0, 0]\nvertical_fov")
            + "[render]\nsamples = 64\ndiffuse_bounces = 0\n"
            + &body("floor", "diffuse = { reflectance = 1 }", &[GROUND])
            + &body(
                "lamp",
                "emissive = { radiance = 1, sides = \"front\" }",
                &["quad = { center = [0, 0.5, 0], u = [0.5, 0, 0], v = [0, 0.5, 0] }"],
            );
        // A small surface below the edge of a rectangle at right angles to it: Hamilton & Morgan 1952, P-6, twice for a
        // half.
        let (half, slant) = (0.5, (1.0 + distance * distance).sqrt());
        let expected = (libm::atan(half / distance) - distance / slant * libm::atan(half / slant)) / PI;
        let (film, report) = render_film(&text, SPLITTING);
        assert_eq!(report.non_finite, 0);
        let mean = Mean::of(&film);
        let deviation = mean.worst_relative_error([expected; 3]) * SAMPLES.sqrt();
        println!(
            "L3: {distance}: {} +- {:.1e} for {expected}, a sample deviates by {deviation:.2}",
            mean.value[0], mean.error[0]
        );
        mean.assert_near([expected; 3], 4, &format!("distance {distance}"));
        assert!(3.0 * mean.worst_relative_error([expected; 3]) <= 0.01 && deviation <= 1.0, "{mean:?}");
    }
}

/// A lamp in the plane of the floor sends it no light, whether it is beside the visible point or in the very same
/// place.
#[test]
fn l5_a_lamp_in_the_plane_of_the_floor_leaves_it_dark_and_makes_no_nan() {
    let shapes = [
        "quad = { center = [3, 0, 0], u = [1, 0, 0], v = [0, 0, -1] }",
        "disc = { center = [0, 0, -4], normal = [0, 1, 0], radius = 1 }",
        "triangle = { points = [[-3, 0, 0], [-2, 0, 0], [-2, 0, 1]] }",
        "mesh = { points = [[0, 0, 3], [1, 0, 3], [1, 0, 4], [0, 0, 4]], faces = [[0, 1, 2], [0, 2, 3]] }",
    ];
    for materials in ["diffuse = { reflectance = 1 }", "conductor = { metal = \"Au\", roughness = 0.4 }"] {
        let text = view([0.0, 2.0, 0.1], [0.0; 3], 30.0, 12)
            + "[render]\nsamples = 16\n"
            + &body("floor", materials, &[GROUND])
            + &body("lamp", "emissive = { radiance = 1e6 }", &shapes);
        let (film, report) = render_film(&text, SPLITTING);
        assert_eq!(report.non_finite, 0);
        assert!(film.pixels.iter().all(|pixel| pixel.rgb == [0.0; 3]), "{materials}");
    }
    // Lamp and floor in the same place, under a sky: either may be seen, but nothing else.
    let both = view([0.0, 2.0, 0.1], [0.0; 3], 10.0, 12)
        + &body("floor", "diffuse = { reflectance = 0.5 }", &[GROUND])
        + &body(
            "lamp",
            "emissive = { radiance = 8 }",
            &["quad = { center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, -4] }"],
        )
        + &environment(1.0);
    let (film, report) = render_film(&both, SPLITTING);
    assert_eq!(report.non_finite, 0);
    for pixel in &film.pixels {
        assert!((0.49..=8.01).contains(&pixel.rgb[0]), "{pixel:?}");
    }
}
