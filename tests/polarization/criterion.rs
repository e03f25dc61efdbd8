//! The plan leaves polarization out only where that is allowed.

use std::fmt::Write;

use abbe::plan::plan;
use abbe::scene::Scene;
use abbe::spectrum::Curve;
use abbe::trace::{Method, Polarizing, Transport, most_changed, polarization_error, prepare};

use crate::support::random::Random;
use crate::support::scenes::{film_of, scene};

/// Error that the plan tolerates without polarization: a third of the error that a scene may have by default, see
/// `plan`.
const TOLERATED: f64 = 0.01;
const SCENES: u64 = 80;

fn vector(random: &mut Random, from: f64, to: f64) -> [f64; 3] {
    [0, 1, 2].map(|_| random.between(from, to))
}

/// Returns a random scene of panes, mirrors, prisms, glass balls, metals and rough glass in front of lamps and a gray
/// sky.
fn random_scene(number: u64) -> String {
    let mut random = Random::new(number + 31_000);
    let mut text = String::from(
        "camera = { position = [0, 0, 6], look_at = [0, 0, 0], vertical_fov = 30 }\n\
         film = { width = 16, height = 16, filter = \"center\" }\n\
         [[light]]\nenvironment.radiance = 0.2\n\
         [material.lamp]\nemissive.radiance = 4\n",
    );
    let is_rough = number % 5 == 4;
    for object in 0..3 + number % 4 {
        let kind = (random.number() * if is_rough { 7.0 } else { 5.0 }) as u32;
        let index = random.between(1.3, 2.2);
        let (material, shape) = match kind {
            0 => (format!("thin.index = {index}"), "quad = { center = [0, 0, 0], u = [0.9, 0, 0], v = [0, 0.9, 0] }"),
            1 => {
                ("mirror.reflectance = 0.95".into(), "quad = { center = [0, 0, 0], u = [0.9, 0, 0], v = [0, 0.9, 0] }")
            }
            2 => (format!("dielectric.index = {index}"), "cube = { center = [0, 0, 0], size = 0.9 }"),
            3 => (format!("dielectric.index = {index}"), "sphere = { center = [0, 0, 0], radius = 0.5 }"),
            4 => {
                let [n, k] = [random.between(0.1, 3.0), random.between(1.0, 6.0)];
                (
                    format!("conductor = {{ n = {n}, k = {k} }}"),
                    "disc = { center = [0, 0, 0], normal = [0, 0, 1], radius = 0.8 }",
                )
            }
            5 => (
                format!("dielectric = {{ index = {index}, roughness = 0.3 }}"),
                "sphere = { center = [0, 0, 0], radius = 0.5 }",
            ),
            _ => (
                "conductor = { n = 1.0, k = 6.6, roughness = 0.3 }".into(),
                "cube = { center = [0, 0, 0], size = 0.8 }",
            ),
        };
        let axis = vector(&mut random, -1.0, 1.0);
        let degrees = random.between(0.0, 180.0);
        let place = [random.between(-1.2, 1.2), random.between(-1.2, 1.2), 1.1 * object as f64 - 3.0];
        writeln!(
            text,
            "[material.object{object}]\n{material}\n[[object]]\nmaterial = \"object{object}\"\nshape.{shape}\n\
             transform = [{{ rotate = {{ axis = {axis:?}, degrees = {degrees} }} }}, {{ translate = {place:?} }}]"
        )
        .expect("text takes all");
    }
    for _ in 0..3 {
        let place = vector(&mut random, -4.0, 4.0);
        writeln!(text, "[[object]]\nmaterial = \"lamp\"\nshape.sphere = {{ center = {place:?}, radius = 0.8 }}")
            .expect("text takes all");
    }
    text
}

/// Returns the relative RMS error of averaging polarization. It is that of every pixel if nothing is random, and
/// otherwise taken from 8 times as many samples as the plan looks at. The second result is true in the first case.
fn error_of_averaging(scene: &Scene<Curve>, method: &Method) -> (f64, bool) {
    if let Transport::Random { .. } = method.transport {
        let squares = (1..=8).map(|seed| {
            let seeded = Method { seed, polarization: Polarizing::Averaged, ..method.clone() };
            polarization_error(&prepare(scene, seeded)).powi(2)
        });
        return ((squares.sum::<f64>() / 8.0).sqrt(), false);
    }
    let [averaged, traced] = [Polarizing::Averaged, Polarizing::Traced].map(|polarization| {
        let film = film_of(scene, Method { polarization, ..method.clone() });
        film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1])).collect::<Vec<_>>()
    });
    let square = |x: f64| x * x;
    let off: f64 = averaged.iter().zip(&traced).map(|(a, b)| square(a - b)).sum();
    ((off / traced.iter().map(|x| square(*x)).sum::<f64>()).sqrt(), true)
}

/// In at least 95 of 100 random scenes in which the plan leaves polarization off, the error is within the tolerance. It
/// is exactly 0 if no light hits two surfaces that polarize.
#[test]
fn polarization_stays_off_only_where_that_changes_little() {
    let (mut off, mut kept, mut on, mut needless) = (0, 0, 0, 0);
    for number in 0..SCENES {
        let text = random_scene(number);
        let compiled = scene(&text);
        let planned = plan(&compiled);
        let (error, is_exact) = error_of_averaging(&compiled, &planned.method);
        if planned.method.polarization == Polarizing::Averaged {
            off += 1;
            kept += u32::from(error <= TOLERATED);
            let averaged = Method { polarization: Polarizing::Averaged, ..planned.method.clone() };
            if most_changed(&prepare(&compiled, averaged)) == 0.0 && is_exact {
                assert!(error < 1e-6, "scene {number}: {error} where none was possible\n{text}");
            }
        } else {
            on += 1;
            needless += u32::from(error <= 0.1 * TOLERATED);
        }
    }
    println!(
        "off in {off} scenes, below {TOLERATED} in {kept}; on in {on}, {needless} of them for less than a tenth of it"
    );
    assert!(off > 20 && on > 20, "off {off}, on {on}");
    assert!(f64::from(kept) >= 0.95 * f64::from(off), "{kept} of {off}");
}

/// A floor lit through a coated ball of glass, beside a film, in 8 x 8 pixels.
fn coated_ball(x: f64) -> String {
    format!(
        r#"
        camera = {{ position = [0.6, 1.4, 3], look_at = [0, 0.5, 0], vertical_fov = 38 }}
        film = {{ width = 8, height = 8 }}
        render.caustics = "off"
        [material]
        floor.diffuse.reflectance = 0.3
        film.thin = {{ index = 1.33, thickness_nm = 600 }}
        coated.dielectric = {{ index = 1.5, coating = [{{ index = 2.2, thickness_nm = 370 }}] }}
        lamp.emissive.radiance = 8
        [[object]]
        shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
        material = "floor"
        [[object]]
        shape.quad = {{ center = [0.55, 0.5, 0.1], u = [0.4, 0, 0.2], v = [0, 0.45, 0] }}
        material = "film"
        [[object]]
        shape.sphere = {{ center = [{x}, 0.5, -0.9], radius = 0.45 }}
        material = "coated"
        [[object]]
        shape.quad = {{ center = [0.5, 3, 1], u = [1, 0, 0], v = [0, 0, 1] }}
        material = "lamp"
        [[light]]
        environment.radiance = 0.5
        "#
    )
}

/// Leaving out polarization is wrong by 3.1 to 4.2 % in each of these images, as measured with 2048 samples per pixel.
/// When each pixel was visited nine times with the same random numbers, the plan found less than 0.5 % in five of them.
#[test]
fn an_image_of_few_pixels_is_looked_at_by_as_many_samples() {
    for place in -4..=4 {
        let planned = plan(&scene(&coated_ball(0.1 * f64::from(place))));
        let error = planned.polarization_error;
        assert_eq!(planned.method.polarization, Polarizing::Traced, "ball {place}: {error:?}");
    }
}
