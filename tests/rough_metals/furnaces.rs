//! Row G6: in a uniform environment, a surface that reflects all light is invisible.

use abbe::material::{Material, Roughness};
use abbe::math::DVec3;
use abbe::spectrum::{Draw, Table};

use crate::support::larger::larger;
use crate::support::materials::{self, LOSSLESS, context, direction_at, hammersley_points, material};
use crate::support::scenes::{Mean, SINGLE_PATH, SPLITTING, body, environment, render_film, view};

const ROUGHNESSES: [f64; 9] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0];
const COSINES: [f64; 14] = [0.001, 0.003, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9, 1.0];
const DRAWS: u32 = 1 << 16;

fn conductor(metal: &str, roughness: f64) -> Material<Table> {
    material(&format!("conductor = {{ {metal}, roughness = {roughness:?} }}"))
}

const BALL: &str = "sphere = { center = [0, 0, 0], radius = 1 }";

/// Returns what a metal below a medium of the given index shows of a uniform environment of radiance 1.
fn furnace(material: &Material<Table>, cos: f64, index: f64) -> [f64; 3] {
    let draw = Draw::<4>::fixed(3);
    materials::furnace(material, &context(&draw, direction_at(cos, 0.4), index), DRAWS).map(|[shown, _]| shown)
}

#[test]
fn g6_a_lossless_metal_reflects_all_light_at_every_roughness_and_angle() {
    for roughness in ROUGHNESSES {
        let material = conductor(LOSSLESS, roughness);
        let shown = COSINES.map(|cos| furnace(&material, cos, 1.0)[0]);
        println!("G6: roughness {roughness}: {shown:.5?}");
        for (cos, shown) in COSINES.into_iter().zip(shown) {
            assert!((0.995..=1.001).contains(&shown), "roughness {roughness}, cos {cos}: {shown}");
        }
    }
}

#[test]
fn the_table_of_what_is_reflected_once_agrees_with_a_finer_quadrature() {
    let mut worst = 0f64;
    for value in ROUGHNESSES.into_iter().skip(1) {
        let roughness = Roughness::new(value);
        let surface = roughness.surface().expect("it is rough");
        for step in 1..60 {
            let cos = libm::pow(f64::from(step) / 59.0, 3.0);
            let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            // Points are dense toward upright facets, which block most.
            let blocked: f64 = hammersley_points(DRAWS)
                .map(|[v, around]| {
                    let h = surface.facets().visible_normal(wo, [around, 1.0 - v * v]);
                    2.0 * v * surface.facets().unshadowed_and_shadowed(wo, h * (2.0 * wo.dot(h)) - wo)[1]
                })
                .sum();
            let exact = blocked / f64::from(DRAWS);
            worst = larger(worst, (surface.missing_energy(cos) - exact).abs());
        }
    }
    println!("table off by at most {worst:.1e}");
    assert!(worst < 6e-4, "{worst:e}");
}

#[test]
fn no_metal_reflects_more_than_comes_and_the_rougher_the_deeper_its_color() {
    for metal in ["metal = \"Au\"", "metal = \"Cu\"", "metal = \"Al\"", "n = 2.9, k = 3.1"] {
        let surfaces = [0.0, 0.3, 0.6, 1.0].map(|roughness| conductor(metal, roughness));
        for index in [1.0, 1.5] {
            for cos in [0.02, 0.3, 1.0] {
                let shown = surfaces.each_ref().map(|surface| furnace(surface, cos, index));
                println!("{metal} under {index}, cos {cos}: {shown:.4?}");
                assert!(shown.as_flattened().iter().all(|x| (0.0..1.0).contains(x)), "{metal}: {shown:?}");
            }
            let [smooth, .., rough] =
                surfaces.each_ref().map(|surface| furnace(surface, 1.0, index)).map(|x| x[2] / x[0]);
            if metal.contains("Au") || metal.contains("Cu") {
                assert!(rough < smooth, "{metal}: blue over red {rough}, smooth {smooth}");
            }
        }
    }
}

#[test]
fn a_lossless_ball_is_invisible_in_an_even_environment() {
    for roughness in [0.02, 0.1, 0.3, 0.6, 1.0] {
        let metal = format!("conductor = {{ {LOSSLESS}, roughness = {roughness:?} }}");
        // A ball that fills the view, and one of which only the rim is visible.
        let views = [([0.0, 0.0, 9.0], [0.0; 3], 10.0), ([0.0, 0.0, 9.0], [0.99, 0.0, 0.0], 0.1)];
        for (position, target, fov) in views {
            for (bounces, transport) in [("", SINGLE_PATH), ("", SPLITTING), ("diffuse_bounces = 0\n", SINGLE_PATH)] {
                let text = view(position, target, fov, 32)
                    + &format!("[render]\nsamples = 64\n{bounces}")
                    + &body("metal", &metal, &[BALL])
                    + &environment(1.0);
                let mean = Mean::of(&render_film(&text, transport).0);
                println!("roughness {roughness}: {} +- {:.1e}", mean.value[0], mean.error[0]);
                assert!((mean.value[0] - 1.0).abs() <= 0.001 + 4.0 * mean.error[0], "{roughness}: {mean:?}");
                assert!(mean.error[0] < 0.001, "{roughness}: {mean:?}");
            }
        }
    }
}

#[test]
fn lossless_metals_stay_invisible_beside_each_other_and_inside_glass() {
    let metal = format!("conductor = {{ {LOSSLESS}, roughness = 0.5 }}");
    let pair = ["sphere = { center = [0, 0, 0], radius = 1 }", "sphere = { center = [1.5, 0.5, 0.8], radius = 0.8 }"];
    let glass = body(
        "glass",
        "dielectric = { index = { rgb = [1.3, 1.5, 1.8] } }",
        &["cube = { center = [0, 0, 0], size = 2.4 }"],
    );
    let scenes = [("two metals", body("metal", &metal, &pair)), ("in glass", body("metal", &metal, &[BALL]) + &glass)];
    for (name, bodies) in scenes {
        for transport in [SINGLE_PATH, SPLITTING] {
            let text = view([2.0, 3.0, 8.0], [0.5, 0.2, 0.3], 8.0, 32)
                + "[render]\nsamples = 600\n"
                + &bodies
                + &environment(1.0);
            let mean = Mean::of(&render_film(&text, transport).0);
            println!("{name}: {mean:.5?}");
            for band in 0..3 {
                let off = (mean.value[band] - 1.0).abs();
                assert!(off <= 0.001 + 4.0 * mean.error[band], "{name}: {mean:?}");
                assert!(mean.error[band] < 0.003, "{name}: {mean:?}");
            }
        }
    }
}
