//! Caustics of surfaces that are only partly smooth: the mirror reflection of a clear coat, or a mix of paint and
//! mirror.

use std::f64::consts::{FRAC_1_PI, PI};

use abbe::plan::plan;
use abbe::trace::{LightPass, Method, Smoothness};

use super::agreement::{ABOVE, BALL, FLOOR, LAMP, assert_agree, assert_agree_with_map, camera_and_film, glass};
use super::gathered::NARROW;
use super::materials::{BENT, ROUND_LAMP};
use crate::support::scenes::{SPLITTING, body, films_of, mean_and_variance, mean_color, object, quad, scene, view};

const VARNISH: &str = "[material.varnish]\nplastic = { reflectance = { rgb = [0.4, 0.3, 0.2] }, index = 1.5 }\n";
/// Half paint, half mirror.
const MIX: &str = "[material.paint]\ndiffuse = { reflectance = 0.5 }\n[material.mirror]\nmirror = { reflectance = 0.9 }\n\
                   [material.mixed]\nmix = { materials = [\"paint\", \"mirror\"], amount = 0.5 }\n";

/// Number of renders that are compared with a closed form.
const SEEDS: u64 = 64;

/// Returns the reflectance of a clear surface for unpolarized light (Born & Wolf, *Principles of Optics*, 1.5.2).
fn fresnel(cos: f64, index: f64) -> f64 {
    let refracted = (1.0 - (1.0 - cos * cos) / (index * index)).sqrt();
    let s = (cos - index * refracted) / (cos + index * refracted);
    let p = (index * cos - refracted) / (index * cos + refracted);
    0.5 * (s * s + p * p)
}

/// A varnished floor mirrors a spotlight that shines only at the floor. The mirror image lies as far below the floor as
/// the spot is above it, with its intensity scaled by F. It lights a small disc above the floor.
#[test]
fn the_light_of_a_spot_that_a_varnished_floor_mirrors_has_its_closed_form() {
    for (index, aside) in [(1.5, 1.0), (1.8, 6.0)] {
        let (spot_height, height, reflectance) = (1.0, 1.5, 0.3);
        let where_met = aside * spot_height / (spot_height + height);
        let text = view([aside - 0.05, 0.3, 0.1], [aside, height, 0.0], 0.7, 12)
            + "[render]\nmodel = \"rgb\"\npolarization = \"off\"\n"
            + &body(
                "floor",
                &format!("plastic = {{ reflectance = 0, index = {index:?} }}"),
                &[&quad([where_met, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.0, -0.1])],
            )
            + &body(
                "small",
                &format!("diffuse = {{ reflectance = {reflectance:?} }}"),
                &[&format!("disc = {{ center = [{aside:?}, {height:?}, 0], normal = [0, -1, 0], radius = 0.02 }}")],
            )
            + &format!(
                "[[light]]\nspot = {{ position = [0, {spot_height:?}, 0], toward = [{where_met:?}, -1, 0], \
                 cone_angle = 1, blend = 0, intensity = 20 }}\n"
            );
        let scene = scene(&text);
        let planned = plan(&scene);
        assert!(
            planned.method.light_pass.as_ref().is_some_and(|pass| pass.to.contains(&Smoothness::Partial)),
            "{:?}",
            planned.because
        );
        let pass = LightPass {
            photons: 65_536,
            lights: vec![0],
            openings: Vec::new(),
            to: Smoothness::ALL.to_vec(),
            map: None,
        };
        let method = Method { samples: 1, transport: SPLITTING, light_pass: Some(pass), ..planned.method };
        let films = films_of(&scene, &method, 0..SEEDS);
        let (found, variance) = mean_and_variance(films.iter().map(|film| mean_color(film)[1]));
        let along = aside.hypot(spot_height + height);
        let cos = (spot_height + height) / along;
        let expected = reflectance * FRAC_1_PI * 20.0 * fresnel(cos, index) * cos / (along * along);
        let error = (variance / SEEDS as f64).sqrt();
        println!("index {index}, aside {aside}: {found:.6} for {expected:.6}, error {:.3} %", 100.0 * error / expected);
        assert!(error < 0.001 * expected, "{error} of {expected}");
        assert!(
            (found - expected).abs() < 4.0 * error,
            "index {index}: {found} for {expected} with an error of {error}"
        );
    }
    assert!((fresnel(1.0, 1.5) - 0.04).abs() < 1e-12 && fresnel((0.5 * PI).cos(), 1.5) > 0.999_999);
}

#[test]
fn a_varnished_ball_and_a_mixed_one_under_a_lamp() {
    for (what, material) in [("varnish", VARNISH), ("mixed", MIX)] {
        let text =
            camera_and_film(ABOVE, "") + FLOOR + LAMP + material + &object(what, BALL) + &object("lamp", ROUND_LAMP);
        assert_agree(what, &text, 32);
    }
}

/// Each body mirrors the lamp onto all the others, and the caustic of the glass lands on varnish.
#[test]
fn a_glass_ball_and_a_cube_of_varnish_on_an_infinite_varnished_floor() {
    let text = camera_and_film(ABOVE, "")
        + LAMP
        + VARNISH
        + &object("varnish", "plane = { point = [0, 0, 0], normal = [0, 1, 0] }")
        + &object("varnish", "cube = { center = [-0.8, 0.5, 0.3], size = [0.6, 1, 0.6] }")
        + &glass("index = 1.5")
        + &object("glass", "sphere = { center = [0.5, 0.5, 0], radius = 0.4 }")
        + &object("lamp", ROUND_LAMP);
    assert_agree("glass and varnish", &text, 32);
}

#[test]
fn varnish_with_bent_normals_and_varnish_with_holes() {
    let text = camera_and_film(ABOVE, "")
        + LAMP
        + VARNISH
        + "[material.lattice]\nmask = { material = \"varnish\", opacity = { checker = [0.3, { rgb = [1, 0.8, 0.6] }], repeat = 4 } }\n\
           [material.wall]\ndiffuse = { reflectance = 0.8 }\n"
        + &object("varnish", BENT)
        + &object("lattice", "quad = { center = [0.3, 0.5, 0], u = [0.6, 0.2, 0], v = [0, 0, -0.6] }")
        + &object("wall", "quad = { center = [-0.9, 0.5, 0], u = [0, 0, 1], v = [0, 0.5, 0] }")
        + &object("lamp", ROUND_LAMP);
    assert_agree("bent, and with holes", &text, 32);
}

#[test]
fn caustics_of_varnish_are_seen_in_a_mirror() {
    let text = camera_and_film("position = [0, 1.2, 2.5]\nlook_at = [0, 0.8, -2]\nvertical_fov = 40", "")
        + FLOOR
        + LAMP
        + MIX
        + VARNISH
        + &object("mirror", "quad = { center = [0, 2, -2], u = [3, 0, 0], v = [0, 2, 0.3] }")
        + &object("varnish", BALL)
        + &object("mixed", "cube = { center = [1.2, 0.4, 0.3], size = 0.8 }")
        + &object("lamp", "sphere = { center = [0.5, 5, 0], radius = 0.6 }");
    assert_agree_with_map("in a mirror", &text, [64; 2], Some(NARROW));
}

/// Where the caustics of varnish are left to random paths, photons still contribute all caustics of glass, also those
/// that varnish reflects.
#[test]
fn photons_to_glass_alone_leave_varnish_to_chance() {
    let text = camera_and_film(ABOVE, "")
        + FLOOR
        + LAMP
        + VARNISH
        + &object("varnish", "cube = { center = [-0.9, 0.5, 0.3], size = [0.6, 1, 0.6] }")
        + &glass("index = 1.5")
        + &object("glass", BALL)
        + &object("lamp", ROUND_LAMP);
    let scene = scene(&text);
    let planned = plan(&scene).method;
    let estimate = |coats: bool, photons: u64| {
        let to = if coats { vec![Smoothness::Whole, Smoothness::Partial] } else { vec![Smoothness::Whole] };
        let light_pass = Some(LightPass { photons, lights: vec![0], openings: Vec::new(), to, map: None });
        let method = Method { samples: 32, transport: SPLITTING, light_pass, ..planned.clone() };
        mean_and_variance(films_of(&scene, &method, 0..16).iter().map(|film| mean_color(film)[1]))
    };
    let [(with, v), (without, w)] = [estimate(true, 40_000), estimate(false, 20_000)];
    let z = (with - without) / ((v + w) / 16.0).sqrt();
    println!("to all {with:.6}, to glass alone {without:.6}, z {z:.2}");
    assert!(z.abs() < 4.0, "{with} and {without}, {z} standard errors apart");
}
