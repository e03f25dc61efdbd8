use std::f64::consts::PI;

use crate::support::scenes::{EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, body, environment, render_film, view};

#[test]
fn each_diffuse_bounce_adds_its_own_share() {
    // All points of a diffuse ball receive the same light, and each bounce returns its reflectance. A lamp in the
    // middle also absorbs what falls on it: a fraction equal to the ratio of the areas.
    const ROOM: &str = "sphere = { center = [0, 0, 0], radius = 2 }";
    let white = body("white", "diffuse = { reflectance = 0.6 }", &[ROOM]);
    let point = "[[light]]\npoint = { position = [0, 0, 0], intensity = 3 }\n".to_owned();
    let ball = body("lamp", "emissive = { radiance = 5 }", &["sphere = { center = [0, 0, 0], radius = 0.8 }"]);
    let lost = 0.8 * 0.8 / 4.0;
    for (light, irradiance, kept) in [(point, 3.0 / 4.0, 0.6), (ball, PI * 5.0 * lost, 0.6 * (1.0 - lost))] {
        // Light gathered after n bounces leaves one more surface than it bounced off.
        let limits = [0, 1, 2, 5].into_iter().flat_map(|n| [(n, "diffuse_bounces", n), (n, "max_bounces", n + 1)]);
        for (bounces, key, limit) in limits {
            // The camera is beside the center and looks away from it.
            let text = view([1.2, 0.3, 0.2], [2.4, 0.6, 0.4], 20.0, 60)
                + &format!("[render]\nsamples = 8\n{key} = {limit}\n")
                + &white
                + &light;
            let sum: f64 = (0..=bounces).map(|bounce| libm::pow(kept, f64::from(bounce))).sum();
            let expected = 0.6 / PI * irradiance * sum;
            let mean = Mean::of(&render_film(&text, SPLITTING).0);
            mean.assert_near([expected; 3], 16, &format!("{key} = {limit}"));
            assert!(mean.worst_relative_error([expected; 3]) <= 0.01, "{mean:?}");
        }
    }
}

#[test]
fn a_diffuse_body_in_an_even_sky_shows_its_reflectance() {
    let ball = body("white", "diffuse = { reflectance = 0.5 }", &["sphere = { center = [0, 0, 0], radius = 1 }"]);
    let text = view([0.5, 0.4, 4.0], [0.0; 3], 20.0, 60) + "[render]\nsamples = 4\n" + &ball + &environment(1.0);
    for transport in [SPLITTING, SINGLE_PATH] {
        Mean::of(&render_film(&text, transport).0).assert_near([0.5; 3], 2, "diffuse ball");
    }
}

#[test]
fn light_in_an_absorbing_medium_is_absorbed_on_its_way_to_a_surface() {
    // A diffuse room around a light, filled with a medium of index 1: the transmittance is e^(-absorption r) on the
    // path from the light, and again on the path to the camera in the middle.
    let room = body("white", "diffuse = { reflectance = 0.6 }", &["sphere = { center = [0, 0, 0], radius = 2 }"]);
    let haze =
        body("haze", "dielectric = { index = 1, absorption = 0.5 }", &["sphere = { center = [0, 0, 0], radius = 3 }"]);
    let lights = [
        ("[[light]]\npoint = { position = [0, 0, 0], intensity = 3 }\n".to_owned(), 3.0 / 4.0, 2.0),
        (
            body("lamp", "emissive = { radiance = 5 }", &["sphere = { center = [0, 0, 0], radius = 0.01 }"]),
            PI * 5.0 * 2.5e-5,
            1.99,
        ),
    ];
    for (light, irradiance, way) in lights {
        let text = view([0.1, 0.0, 0.0], [1.0, 0.0, 0.0], 1e-5, 30)
            + "[render]\nsamples = 16\ndiffuse_bounces = 0\n"
            + &room
            + &haze
            + &light;
        let expected = 0.6 / PI * irradiance * libm::exp(-0.5 * way) * libm::exp(-0.5 * 1.9);
        let mean = Mean::of(&render_film(&text, SPLITTING).0);
        assert!((mean.value[0] / expected - 1.0).abs() <= 0.01, "{mean:?} for {expected}");
    }
}

#[test]
fn longer_paths_through_glass_are_left_out_and_reported() {
    // A uniform sky seen at normal incidence through a plate of n = 1.5. Two surfaces transmit (1 - R)^2, and more of
    // them the rest of what crosses. Light that the front reflects leaves one surface.
    let plate = body("glass", "dielectric = { index = 1.5 }", &["cube = { center = [0, 0, 0], size = [90, 90, 1] }"]);
    let (r, t) = (0.04, 0.96);
    for (limit, expected) in [(0, 0.0), (1, r), (2, r + t * t), (3, r + t * t + t * r * t), (40, 1.0)] {
        let text = view([0.0, 0.0, 5.0], [0.0; 3], 1.0, 1)
            + "filter = \"center\"\n"
            + &format!("[render]\nmax_bounces = {limit}\n")
            + &plate
            + &environment(1.0);
        let (film, report) = render_film(&text, EVERY_BRANCH);
        let found = f64::from(film.pixels[0].rgb[0]);
        assert!((found - expected).abs() < 1e-5, "{limit} bounces: {found} for {expected}");
        assert!((report.stopped - (1.0 - expected)).abs() < 1e-5, "{limit} bounces: {} stopped", report.stopped);
    }
}
