use std::f64::consts::PI;

use abbe::math::DVec3;

use super::{Case, assert_closed_forms, case, polygon_irradiance, quad_irradiance};
use crate::support::scenes::quad;

/// Returns cases of discs and polygons.
fn flat_lights() -> Vec<Case> {
    let [low, high] = [0.3, 2.0].map(|height: f64| PI / (1.0 + height * height));
    let square = 4.0 * 0.5f64.sqrt() * libm::atan(0.5f64.sqrt());
    let triangle = [DVec3::new(-1.0, 1.0, 0.5), DVec3::new(2.0, 1.5, 0.0), DVec3::new(0.0, 0.7, -2.0)];
    let points = triangle.map(|p| format!("{:?}", p.to_array())).join(", ");
    let wall = |h: f64, below: f64| {
        let whole = quad([-h, 0.5 - below, 0.0], DVec3::Y * (0.5 + below), DVec3::Z);
        (whole, quad_irradiance([0.0; 3], DVec3::new(-h, 0.5, 0.0), DVec3::Y * 0.5, DVec3::Z))
    };
    let ((near, by_near), (sunk, by_sunk)) = (wall(1e-4, 0.0), wall(0.5, 0.4));
    let tilted = (DVec3::new(0.6, 1.4, 0.2), DVec3::new(0.8, 0.3, 0.1), DVec3::new(-0.2, 0.3, 0.9));
    let tilted_quad = quad(tilted.0, tilted.1, tilted.2);
    vec![
        case("G1 disc", &["disc = { center = [0, 2, 0], normal = [0, -1, 0], radius = 1 }"], high),
        case("disc close by", &["disc = { center = [0, 0.3, 0], normal = [0, 1, 0], radius = 1 }"], low),
        case("G2 square", &["quad = { center = [0, 1, 0], u = [1, 0, 0], v = [0, 0, 1] }"], square),
        case("tilted square", &[&tilted_quad], quad_irradiance([0.0; 3], tilted.0, tilted.1, tilted.2)),
        case("triangle", &[&format!("triangle = {{ points = [{points}] }}")], polygon_irradiance([0.0; 3], &triangle)),
        case("L3 wall that touches the floor", &[&near], by_near),
        case("wall that goes on below the floor", &[&sunk], by_sunk),
        case(
            "square mesh",
            &["mesh = { points = [[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]], faces = [[0, 1, 2], [0, 2, 3]] }"],
            square,
        ),
    ]
}

#[test]
fn flat_lights_send_what_lambert_computed() {
    assert_closed_forms(&flat_lights());
}
