//! Surfaces so large that the camera sees only a small part of their caustics: seas and infinite mirrors.

use abbe::math::DVec2;
use abbe::plan::plan;
use abbe::trace::MapPasses;

use super::agreement::{FLOOR, LAMP, assert_agree, assert_agree_with_map, camera_and_film, glass};
use crate::support::scenes::{film_of, mean_and_variance, object, scene};

/// A camera just above the water, with the horizon in sight.
const SHORE_CAMERA: &str = "position = [0, 2, 5]\nlook_at = [0, 0.3, 0]\nvertical_fov = 50";
const WATER: [&str; 2] = [
    "plane = { point = [0, 1, 0], normal = [0, 1, 0] }",
    "quad = { center = [30, 1, -20], u = [0, 0, 300], v = [300, 0, 0] }",
];
const SUN: &str = "[[light]]\nsun = { toward = [0.6, 1, 0.3], irradiance = 2, angular_diameter = 40 }\n";

/// The sun is so large that random paths hit it as well.
#[test]
fn a_sea_in_the_sun() {
    let map = MapPasses { count: 16, photons: 8192, radius: 0.1, chance: 1.0 };
    for water in WATER {
        let text = camera_and_film(SHORE_CAMERA, "")
            + FLOOR
            + &glass("index = 1.33, absorption = { rgb = [0.5, 0.2, 0.1] }")
            + &object("glass", water)
            + "[material.stone]\ndiffuse = { reflectance = 0.5 }\n"
            + &object("stone", "sphere = { center = [0.3, 0.9, 0.2], radius = 0.6 }")
            + SUN;
        assert_agree_with_map(water, &text, [128; 2], Some(map));
    }
}

/// The caustic on a ball is seen directly.
#[test]
fn an_infinite_mirror() {
    let text = camera_and_film("position = [0, 1.5, 4]\nlook_at = [0, 0.8, 0]\nvertical_fov = 50", "")
        + "[material.mirror]\nmirror = { reflectance = 0.9 }\n[material.stone]\ndiffuse = { reflectance = 0.5 }\n"
        + &object("mirror", "plane = { point = [0, 0, 0], normal = [0, 1, 0] }")
        + &object("stone", "sphere = { center = [0, 1, 0], radius = 0.7 }")
        + LAMP
        + &object("lamp", "sphere = { center = [2, 3, 1], radius = 0.6 }")
        + "[[light]]\nenvironment = { radiance = 0.01 }\n";
    assert_agree("mirror", &text, 64);
}

/// The floor of a sea, lit by a sun without extent whose light only photons find, is as bright as Fresnel and Beer
/// predict, near and far. The radiance at the angle v to the normal is (reflectance / pi) E cos(s) T(s) T(v) / n^2,
/// times the transmittance of depth / cos(s') + depth / cos(v') of water.
#[test]
fn the_floor_of_a_sea_is_as_bright_as_fresnel_and_beer_predict() {
    const N: f64 = 1.33;
    const ABSORPTION: f64 = 0.3;
    // Returns the cosine inside the water and the transmitted fraction.
    let refract = |cos: f64| {
        let inside = (1.0 - (1.0 - cos * cos) / (N * N)).sqrt();
        let [s, p] = [(cos - N * inside) / (cos + N * inside), (N * cos - inside) / (N * cos + inside)];
        (inside, 1.0 - 0.5 * (s * s + p * p))
    };
    for water in WATER {
        let text = "[camera]\nposition = [0, 2.5, 5]\nlook_at = [0, 0.8, 0]\nvertical_fov = 34\n[film]\nwidth = 40\nheight = 32\n\
                    [render]\nsamples = 128\npolarization = \"off\"\nmodel = \"rgb\"\n\
                    [material.floor]\ndiffuse = { reflectance = 0.001 }\n"
            .to_owned()
            + &object("floor", "plane = { point = [0, 0, 0], normal = [0, 1, 0] }")
            + &glass(&format!("index = {N}, absorption = {ABSORPTION}"))
            + &object("glass", water)
            + "[[light]]\nsun = { toward = [0.6, 0.8, 0], irradiance = 2000, angular_diameter = 0 }\n";
        let scene = scene(&text);
        let film = film_of(&scene, plan(&scene).method);
        let (sun_inside, sun_crosses) = refract(0.8);
        let ratio = |pixel: usize| {
            let at = DVec2::new((pixel % 40) as f64 + 0.5, (pixel / 40) as f64 + 0.5);
            let (inside, out) = refract(-scene.camera.ray(at).direction.y);
            let left = (-ABSORPTION * (1.0 / sun_inside + 1.0 / inside)).exp();
            let exact = 2.0 / std::f64::consts::PI * 0.8 * sun_crosses * out * left / (N * N);
            f64::from(film.pixels[pixel].rgb[1]) / exact
        };
        for rows in [0..4, 4..8, 8..16, 16..32] {
            let (mean, variance) = mean_and_variance((rows.start * 40..rows.end * 40).map(ratio));
            let error = (variance / (40 * rows.len()) as f64).sqrt();
            println!("{water}, rows {rows:?}: {mean:.4} of the exact light, with an error of {error:.4}");
            // Pixels share photons, so their noise is not fully independent.
            assert!(error < 0.03 && (mean - 1.0).abs() < 6.0 * error + 0.002, "{water}, {rows:?}: {mean} +- {error}");
        }
    }
}
