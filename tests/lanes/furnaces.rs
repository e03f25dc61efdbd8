//! Lossless bodies in a uniform sky: radiance is 1 outside and n^2 inside, in every band.

use crate::support::larger::larger;
use crate::support::scenes::{EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, body, environment, render_film, view};
use abbe::trace::Transport;

/// Returns a view from outside. All camera rays hit the body, from so many sides that no symmetry helps.
fn outside_view(bodies: &str, samples: u32) -> String {
    let head = view([1.3, 0.9, 4.1], [0.05, 0.02, 0.1], 14.0, 64);
    head + &format!("[render]\nsamples = {samples}\n") + bodies + &environment(1.0)
}

const INDICES: [&str; 7] =
    ["1.1", "1.5", "2", "2.5", "{ rgb = [1.1, 1.5, 2.5] }", "{ rgb = [1.3, 1.31, 1.32] }", "{ rgb = [2.5, 1.1, 1] }"];

/// Returns a ball, a turned cube, an ellipsoid, and nested bodies whose priorities decide.
fn bodies(index: &str) -> Vec<(&'static str, String)> {
    let clear = |extra: &str| format!("dielectric = {{ index = {index}{extra} }}");
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let turned = |shape: &str, steps: &str| {
        let object = format!("[[object]]\nshape.{shape}\nmaterial = \"clear\"\ntransform = [{steps}]\n");
        body("clear", &clear(""), &[]) + &object
    };
    let water = "dielectric = { index = 1.333, priority = 2 }";
    let within = "sphere = { center = [0.2, 0.1, 0], radius = 0.6 }";
    let across = "sphere = { center = [0.5, 0.4, 0.6], radius = 0.5 }";
    vec![
        ("ball", body("clear", &clear(""), &[ball])),
        (
            "cube",
            turned("cube = { center = [0, 0, 0], size = 1.7 }", "{ rotate = { axis = [1, 2, 3], degrees = 40 } }"),
        ),
        ("ellipsoid", turned(ball, "{ scale = [1.3, 0.8, 1] }, { rotate = { axis = [1, 0, 2], degrees = 25 } }")),
        ("water within", body("clear", &clear(", priority = 1"), &[ball]) + &body("water", water, &[within])),
        ("bodies across", body("clear", &clear(", priority = 3"), &[ball]) + &body("water", water, &[across])),
    ]
}

#[test]
fn a_lossless_body_in_an_even_sky_is_invisible_in_every_band() {
    let transports = [(SPLITTING, 10), (SINGLE_PATH, 4)];
    let claims = INDICES.len() * bodies("1").len() * transports.len();
    let mut worst = 0f64;
    for index in INDICES {
        for (name, bodies) in bodies(index) {
            for (transport, samples) in transports {
                let (film, report) = render_film(&outside_view(&bodies, samples), transport);
                assert_eq!((report.non_finite, report.unmatched), (0, 0));
                assert!(film.pixels.iter().all(|pixel| pixel.alpha == 1.0), "{name}: a ray passes by");
                let mean = Mean::of(&film);
                mean.assert_near([1.0; 3], claims, &format!("{name} of index {index}, {transport:?}"));
                let error = mean.worst_relative_error([1.0; 3]);
                if matches!(transport, Transport::Random { split, .. } if split < 1.0) {
                    assert!(error <= 1e-3, "{name} of index {index}: sigma is {error}");
                    worst = larger(worst, error);
                }
            }
        }
    }
    println!("furnaces: sigma at most {worst:.1e}");
}

#[test]
fn every_branch_together_makes_each_pixel_of_a_furnace_1() {
    for index in INDICES {
        for (name, bodies) in bodies(index).into_iter().take(3) {
            let (film, report) = render_film(
                &outside_view(&bodies, 1),
                Transport::Deterministic { cutoff: 1e-9, max_sample_surfaces: u64::MAX },
            );
            // Chains of total reflection inside the cube end at the last surface, and what they carry is counted.
            for (at, pixel) in film.pixels.iter().enumerate() {
                for x in pixel.rgb {
                    assert!((x - 1.0).abs() <= 1e-5, "{name} of index {index}: pixel {at} is {x}");
                }
            }
            assert!(report.dropped + report.stopped <= 1e-6, "{name} of index {index}: {report:?}");
        }
    }
}

#[test]
fn a_camera_inside_glass_sees_an_even_sky_n_squared_bright() {
    let indices = [1.2, 1.5, 2.4];
    let clear = format!("dielectric = {{ index = {{ rgb = {indices:?} }} }}");
    // From the inner 40 % of the radius, every direction leads out of the ball.
    for position in [[0.0; 3], [0.3, -0.1, 0.2], [-0.2, 0.25, 0.2]] {
        let ball = body("clear", &clear, &["sphere = { center = [0, 0, 0], radius = 1 }"]);
        let text = view(position, [0.4, 0.9, -0.7], 120.0, 100) + &ball + &environment(1.0);
        let squares = indices.map(|n| n * n);
        for transport in [EVERY_BRANCH, SPLITTING] {
            let mean = Mean::of(&render_film(&text, transport).0);
            mean.assert_near(squares, 6, &format!("from {position:?}"));
            assert!(mean.worst_relative_error(squares) <= 1e-3, "{mean:?}");
        }
    }
}
