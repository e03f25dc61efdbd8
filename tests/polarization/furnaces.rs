//! Light from all around that is scattered without loss: its amount is preserved, and it stays unpolarized.

use abbe::plan::plan;

use super::{SKY, green_stokes, sheets};
use crate::support::scenes::{films_of, mean_and_variance, one_pixel, scene, sigma_limit};

/// Returns what is seen of a surface that is turned from the viewer under a uniform sky: S0 to S3, each as mean and
/// variance over renders with different seeds.
fn stokes_in_even_sky(material: &str, turned: f64) -> [(f64, f64); 4] {
    stokes_of_objects(&sheets(&[material.to_owned()], turned))
}

/// Returns what is seen of any objects in front of the sky: S0 to S3, each as mean and variance over renders with
/// different seeds.
fn stokes_of_objects(objects: &str) -> [(f64, f64); 4] {
    let mut scene = scene(&(one_pixel("", ", stokes = true") + objects));
    scene.render.samples = Some(SAMPLES);
    // Planning takes longer than rendering a pixel.
    let films = films_of(&scene, &plan(&scene).method, 0..SEEDS);
    std::array::from_fn(|part| mean_and_variance(films.iter().map(|film| green_stokes(film)[part])))
}

/// Each wavelength leaves rough glass in another direction, with its own pdf. The glass is as clear as with lanes that
/// stay together.
#[test]
fn rough_glass_that_parts_wavelengths_leaves_even_light_unpolarized() {
    for (index, model) in [("{ rgb = [1.5, 1.6, 1.7] }", "rgb"), ("\"N-SF66\"", "hero")] {
        for roughness in [0.02, 0.1, 0.4] {
            let objects = format!(
                "{SKY}[render]\nmodel = \"{model}\"\npolarization = \"on\"\n[material.glass]\n\
                 dielectric = {{ index = {index}, roughness = {roughness} }}\n[[object]]\nmaterial = \"glass\"\n\
                 shape.cube = {{ center = [0, 0, 0], size = 1 }}\n\
                 transform = [{{ rotate = {{ axis = [1, 3, 0.3], degrees = 28 }} }}]\n"
            );
            let limit = 1.4 * sigma_limit(6 * 4);
            for (part, (mean, variance)) in stokes_of_objects(&objects).into_iter().enumerate() {
                let expected = if part == 0 { 1.0 } else { 0.0 };
                let error = (variance / SEEDS as f64).sqrt();
                println!("{index}, {roughness}, S{part}: {mean:.5} +- {error:.5}");
                assert!(
                    (mean - expected).abs() <= limit * error + 5e-3,
                    "{index}, {roughness}, S{part}: {mean} +- {error}"
                );
                assert!(error < 0.02, "{index}, {roughness}, S{part}: +- {error}");
            }
        }
    }
}

const SAMPLES: u32 = 1024;
const SEEDS: u64 = 16;

/// Maximum error from the tables of facets.
const TABLES: f64 = 3e-4;

/// A rough coat polarizes what it reflects one way, and what leaves the base through it the other way by the same
/// amount.
#[test]
fn white_plastic_in_light_from_all_around_leaves_it_unpolarized() {
    for roughness in [0.0, 0.02, 0.2, 0.6, 1.0] {
        for turned in [30.0, 60.0, 80.0, 88.0] {
            let plastic = format!("plastic = {{ reflectance = 1, roughness = {roughness} }}");
            let found = stokes_in_even_sky(&plastic, turned);
            // Means of 16 have the tails of Student's t. So far out they are 1.4 times as wide as those of the normal
            // distribution.
            let limit = 1.4 * sigma_limit(5 * 4 * 4);
            for (part, (mean, variance)) in found.into_iter().enumerate() {
                let expected = if part == 0 { 1.0 } else { 0.0 };
                let error = (variance / SEEDS as f64).sqrt();
                println!("{roughness} {turned} S{part}: {mean:.5} +- {error:.5}");
                assert!((mean - expected).abs() < limit * error + TABLES, "{roughness}, {turned} degrees: {found:?}");
            }
        }
    }
}

/// A rough coat contributes nothing to the specular direction of a mirror that it is mixed with.
#[test]
fn a_mirror_mixed_with_rough_white_plastic_leaves_even_light_unpolarized() {
    for materials in [["bare", "coated"], ["coated", "bare"]] {
        let mix = format!(
            "mix = {{ materials = {materials:?}, amount = 0.5 }}\n[material.bare]\nmirror = {{}}\n\
             [material.coated]\nplastic = {{ reflectance = 1, roughness = 0.4 }}"
        );
        let found = stokes_in_even_sky(&mix, 60.0);
        let limit = 1.4 * sigma_limit(2 * 4);
        for (part, (mean, variance)) in found.into_iter().enumerate() {
            let expected = if part == 0 { 1.0 } else { 0.0 };
            let error = (variance / SEEDS as f64).sqrt();
            assert!((mean - expected).abs() < limit * error + TABLES, "{materials:?}, S{part}: {mean} +- {error}");
            assert!(error < 2e-3, "{materials:?}, S{part}: +- {error}");
        }
    }
}
