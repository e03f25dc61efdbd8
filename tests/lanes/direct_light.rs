//! Direct light on a diffuse floor, compared with closed forms. Next-event estimation and random hits must together
//! count a light once.

mod bounces;
mod combined;
mod flat;
mod round;

use std::f64::consts::PI;

use abbe::math::DVec3;

use crate::support::scenes::{GROUND, Mean, SINGLE_PATH, SPLITTING, body, render_film, view};

/// Relative radiances of the bands.
const BANDS: [f64; 3] = [1.0, 2.0, 0.5];
const REFLECTANCE: f64 = 0.5;

pub struct Case {
    name: &'static str,
    /// Objects of the material "lamp", and anything else.
    scene: String,
    /// The point on the floor y = 0 that the camera looks at, and the position of the camera.
    point: [f64; 3],
    camera: [f64; 3],
    /// Irradiance from a light of radiance 1.
    irradiance: f64,
}

fn case(name: &'static str, shapes: &[&str], irradiance: f64) -> Case {
    let scene = lamp("", shapes);
    Case { name, scene, point: [0.0; 3], camera: [7.0, 0.6, 3.0], irradiance }
}

fn lamp(sides: &str, shapes: &[&str]) -> String {
    body("lamp", &format!("emissive = {{ radiance = {{ rgb = {BANDS:?} }}{sides} }}"), shapes)
}

/// Returns the irradiance of a horizontal surface from a polygon of radiance 1 above it: half the sum of the angles
/// that its edges subtend, each times the vertical component of the edge plane's normal (Lambert 1760; Baum, Rushmeier
/// & Winget 1989).
fn polygon_irradiance(point: [f64; 3], corners: &[DVec3]) -> f64 {
    let seen: Vec<DVec3> = corners.iter().map(|corner| (*corner - DVec3::from(point)).normalize()).collect();
    let edges = (0..seen.len()).map(|i| (seen[i], seen[(i + 1) % seen.len()]));
    let sum: f64 = edges.map(|(a, b)| libm::acos(a.dot(b)) * a.cross(b).normalize().y).sum();
    0.5 * sum.abs()
}

fn quad_irradiance(point: [f64; 3], center: DVec3, u: DVec3, v: DVec3) -> f64 {
    polygon_irradiance(point, &[center + u + v, center - u + v, center - u - v, center + u - v])
}

/// Returns the irradiance from a ball that is wholly above the floor: pi sin^2 cos, in the direction of its center.
fn ball_irradiance(point: [f64; 3], center: [f64; 3], radius: f64) -> f64 {
    let d = DVec3::from(center) - DVec3::from(point);
    PI * radius * radius / d.length_squared() * d.normalize().y
}

fn assert_closed_forms(cases: &[Case]) {
    // Next-event estimation with all lights, with one of them, and without a bounce that could hit any.
    let ways = [("", SPLITTING, 24), ("", SINGLE_PATH, 32), ("diffuse_bounces = 0\n", SINGLE_PATH, 32)];
    for case in cases {
        for (limit, transport, samples) in ways {
            let floor = format!("diffuse = {{ reflectance = {REFLECTANCE} }}");
            // The camera is so far away and its view so narrow that all pixels see one point.
            let text = view(case.camera, case.point, 1e-5, 40)
                + &format!("[render]\nsamples = {samples}\n{limit}")
                + &body("floor", &floor, &[GROUND])
                + &case.scene;
            let (film, report) = render_film(&text, transport);
            assert_eq!(report.non_finite, 0, "{}", case.name);
            let mean = Mean::of(&film);
            let expected = BANDS.map(|band| band * REFLECTANCE / PI * case.irradiance);
            if case.irradiance == 0.0 {
                assert_eq!(mean.value, [0.0; 3], "{}", case.name);
                continue;
            }
            let (off, error) = (mean.value[0] / expected[0] - 1.0, mean.error[0] / expected[0]);
            println!("{:40} {off:+.1e} +- {error:.1e} {limit}", case.name);
            mean.assert_near(expected, 3 * cases.len(), case.name);
            assert!(mean.worst_relative_error(expected) <= 0.01, "{}: {mean:?}", case.name);
        }
    }
}
