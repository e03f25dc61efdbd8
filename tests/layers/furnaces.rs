//! In a uniform environment, a body that reflects all light is invisible. Scattering is reciprocal.

use abbe::material::{Interface, Material, Scatter, diffuse_transmittance};
use abbe::spectrum::{Draw, Table};

use crate::support::materials::{self, BASE_MATERIALS, context, direction_at, material};
use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, body, environment, render_film, view};

const COSINES: [f64; 12] = [0.001, 0.003, 0.01, 0.03, 0.06, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0];
const DRAWS: u32 = 1 << 14;

/// Returns what each band shows of a uniform environment of radiance 1.
fn furnace(material: &Material<Table>, cos: f64, index: f64) -> [f64; 3] {
    let draw = Draw::<4>::fixed(3);
    materials::furnace(material, &context(&draw, direction_at(cos, 0.4), index), DRAWS).map(|[shown, _]| shown)
}

#[test]
fn the_closed_form_of_diffuse_transmittance_agrees_with_a_quadrature() {
    for m in [0.4, 0.75, 0.9999, 1.0, 1.0005, 1.001, 1.1, 1.33, 1.5, 2.5, 6.0] {
        // Cosine v^3: points are dense where the reflectance changes most.
        const STEPS: u32 = 200_000;
        let exact: f64 = (0..STEPS)
            .map(|i| (f64::from(i) + 0.5) / f64::from(STEPS))
            .map(|v| {
                6.0 * v * v * v * v * v * if m == 1.0 { 1.0 } else { Interface::new(1.0, m, v * v * v).transmittance }
            })
            .sum::<f64>()
            / f64::from(STEPS);
        let closed = diffuse_transmittance(m);
        assert!((closed - exact).abs() < 1e-7, "{m}: {closed} for {exact}");
    }
}

#[test]
fn a_white_base_under_a_clear_coat_reflects_all_light_at_every_roughness_index_and_angle() {
    let mut worst = [0f64; 2];
    for roughness in [0.0, 0.02, 0.1, 0.3, 0.6, 1.0] {
        for index in ["{ rgb = [1.1, 1.5, 2.5] }", "{ rgb = [1.2, 1.333, 1.8] }"] {
            let text = format!("plastic = {{ reflectance = 1, index = {index}, roughness = {roughness:?} }}");
            let material = material(&text);
            for cos in COSINES {
                for shown in furnace(&material, cos, 1.0) {
                    worst = [worst[0].max(1.0 - shown), worst[1].max(shown - 1.0)];
                    assert!((0.995..=1.001).contains(&shown), "{roughness}, {index}, cos {cos}: {shown}");
                }
            }
        }
    }
    println!("white plastic: at most {:.1e} too little and {:.1e} too much", worst[0], worst[1]);
}

#[test]
fn under_water_a_white_base_reflects_all_light_to_half_a_percent_even_under_a_coat_that_is_the_thinner_medium() {
    for roughness in [0.0, 0.3, 0.8] {
        let text = format!(
            "plastic = {{ reflectance = 1, index = {{ rgb = [1.2, 1.333, 1.6] }}, roughness = {roughness:?} }}"
        );
        let material = material(&text);
        for cos in COSINES {
            for shown in furnace(&material, cos, 1.333) {
                // The coat's table cuts a corner where total reflection sets in.
                assert!((0.995..=1.005).contains(&shown), "{roughness}, cos {cos}: {shown}");
            }
        }
    }
}

#[test]
fn a_colored_base_shows_the_series_of_its_inner_reflections() {
    // A smooth coat lit from all around returns R + T r (1 - R') / (1 - r R'), with R' from inside.
    for r in [0.0, 0.2, 0.5, 0.9] {
        let material = material(&format!("plastic = {{ reflectance = {r:?} }}"));
        let all = diffuse_transmittance(1.5);
        let kept = 1.0 - all / 2.25;
        for cos in [0.05, 0.4, 1.0] {
            let once = Interface::new(1.0, 1.5, cos);
            let expected = once.reflectance + once.transmittance * r * (1.0 - kept) / (1.0 - r * kept);
            let shown = furnace(&material, cos, 1.0)[0];
            assert!((shown - expected).abs() < 1e-3, "{r}, cos {cos}: {shown} for {expected}");
        }
    }
}

#[test]
fn light_goes_both_ways_alike() {
    let (draw, mut random) = (Draw::<4>::fixed(3), Random::new(7));
    for text in [
        "plastic = { reflectance = { rgb = [0.9, 0.5, 0.1] }, index = { rgb = [1.3, 1.5, 1.9] } }",
        "plastic = { reflectance = { rgb = [0.9, 0.5, 0.1] }, index = { rgb = [1.3, 1.5, 1.9] }, roughness = 0.15 }",
        "plastic = { reflectance = 0.8, roughness = 0.7 }",
        "mix = { materials = [\"rough\", \"silver\"], amount = { rgb = [0.1, 0.5, 0.9] } }",
        "mask = { material = \"rough\", opacity = 0.3 }",
    ] {
        let material = material(text);
        for _ in 0..2000 {
            let mut direction = || (random.number().max(1e-4), random.number() * std::f64::consts::TAU);
            let ((a, around_a), (b, around_b)) = (direction(), direction());
            let (wo, wi) = (direction_at(a, around_a), direction_at(b, around_b));
            let [there, back] = [(wo, wi), (wi, wo)]
                .map(|(wo, wi)| material.evaluate(&context(&draw, wo, 1.0), wi).expect("both lie above the surface").0);
            for lane in 0..3 {
                let [there, back] = [f64::from(there[lane]) / b, f64::from(back[lane]) / a];
                // A cosine near the horizon keeps 12 of 16 digits, and lanes keep 7.
                assert!((there - back).abs() <= 2e-6 * (there + back), "{text}: {there}, {back} at {a}, {b}");
            }
        }
    }
}

#[test]
fn what_is_made_of_lossless_parts_loses_nothing() {
    for text in [
        "mix = { materials = [\"white\", \"mirror\"], amount = { rgb = [0, 0.3, 1] } }",
        "mix = { materials = [\"mirror\", \"pane\"], amount = { rgb = [0.2, 0.5, 0.9] } }",
        "mix = { materials = [\"white\", \"smooth\"], amount = { rgb = [0.2, 0.5, 0.9] } }",
        "mix = { materials = [\"rough\", \"silver\"], amount = { rgb = [0.2, 0.5, 0.9] } }",
        "mask = { material = \"rough\", opacity = { rgb = [0, 0.4, 1] } }",
        "mask = { material = \"pane\", opacity = 0.7 }",
    ] {
        let material = material(text);
        for cos in [0.02, 0.3, 1.0] {
            let shown = furnace(&material, cos, 1.0);
            assert!(shown.iter().all(|shown| (0.995..=1.001).contains(shown)), "{text}, cos {cos}: {shown:?}");
        }
    }
}

#[test]
fn lossless_balls_are_invisible_in_an_even_environment() {
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let mixed = "mix = { materials = [\"white\", \"mirror\"], amount = { rgb = [0.2, 0.5, 0.9] } }";
    let nested = "mix = { materials = [\"holes\", \"rough\"], amount = 0.5 }\n\
        [material.holes]\nmask = { material = \"mirror\", opacity = 0.6 }";
    for (name, material) in [("plastic", "plastic = { reflectance = 1 }"), ("mix", mixed), ("nested", nested)] {
        for transport in [SINGLE_PATH, SPLITTING] {
            let text = view([0.0, 0.0, 9.0], [0.0; 3], 16.0, 32)
                + "[render]\nsamples = 256\n"
                + BASE_MATERIALS
                + &body("tested", material, &[ball])
                + &environment(1.0);
            let mean = Mean::of(&render_film(&text, transport).0);
            println!("{name}: {mean:.5?}");
            for band in 0..3 {
                let off = (mean.value[band] - 1.0).abs();
                assert!(off <= 0.001 + 4.0 * mean.error[band] && mean.error[band] < 0.002, "{name}: {mean:?}");
            }
        }
    }
    // Without random choices: a mix of mirror and pane, lit only by the environment.
    let mirrors = "mix = { materials = [\"mirror\", \"pane\"], amount = 0.25 }";
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 10.0, 8) + BASE_MATERIALS + &body("tested", mirrors, &[ball]);
    let (film, report) = render_film(&(text + &environment(1.0)), EVERY_BRANCH);
    let even = film.pixels.iter().all(|pixel| pixel.rgb.iter().all(|x| (x - 1.0).abs() < 1e-5));
    assert!(even && report.dropped < 1e-6, "{report:?}");
}
