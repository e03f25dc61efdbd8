use std::f64::consts::PI;

use abbe::math::DVec3;

use super::{BANDS, Case, assert_closed_forms, case, lamp, quad_irradiance};
use crate::support::scenes::quad;

/// Returns cases of one-sided lamps, a sky beside a lamp, and more lights than are all sampled.
fn combined_lights() -> Vec<Case> {
    let square = "quad = { center = [0, 1, 0], u = [1, 0, 0], v = [0, 0, 1] }";
    let irradiance = 4.0 * 0.5f64.sqrt() * libm::atan(0.5f64.sqrt());
    let front = |name, shapes: &[&str], irradiance| Case {
        scene: lamp(", sides = \"front\"", shapes),
        ..case(name, &[], irradiance)
    };
    let down = "quad = { center = [0, 1, 0], u = [1, 0, 0], v = [0, 0, 1] }";
    let up = "quad = { center = [0, 1, 0], u = [0, 0, 1], v = [1, 0, 0] }";
    // Ten squares on a ring, each with a different tilt. None hides another from the point.
    let ring: Vec<(DVec3, DVec3, DVec3)> = (0..10)
        .map(|i| {
            let (sin, cos) = libm::sincos(f64::from(i) * 0.2 * PI);
            let center = DVec3::new(2.0 * cos, 1.0 + 0.2 * f64::from(i), 2.0 * sin);
            (center, DVec3::new(0.3, 0.05 * f64::from(i), 0.0), DVec3::new(0.0, 0.1, 0.2 + 0.01 * f64::from(i)))
        })
        .collect();
    let quads: Vec<String> = ring.iter().map(|&(center, u, v)| quad(center, u, v)).collect();
    let quads: Vec<&str> = quads.iter().map(String::as_str).collect();
    let by_ring: f64 = ring.iter().map(|&(c, u, v)| quad_irradiance([0.0; 3], c, u, v)).sum();
    // A disc wholly above the floor gives its irradiance times the cosine of its center, however wide it is.
    let sun = |name, others: &str, diameter: f64, irradiance| {
        let (sin, cos) = libm::sincos(0.7);
        let scene = if others.contains("quad") { others.to_owned() } else { lamp("", &[]) + others };
        let light = format!(
            "[[light]]\nsun = {{ toward = [{sin}, {cos}, 0], angular_diameter = {diameter:?}, irradiance = {{ rgb = {:?} }} }}\n",
            BANDS.map(|x| 3.0 * x)
        );
        Case { scene: scene + &light, ..case(name, &[], irradiance) }
    };
    let sky = format!("[[light]]\nenvironment = {{ radiance = {{ rgb = {:?} }} }}\n", BANDS.map(|x| 0.7 * x));
    vec![
        front("front that faces the floor", &[down], irradiance),
        front("back that faces the floor", &[up], 0.0),
        case(
            "light in the plane of the floor",
            &["quad = { center = [1.5, 0, 0], u = [0, 0, 1], v = [1, 0, 0] }"],
            0.0,
        ),
        case("ten squares", &quads, by_ring),
        Case {
            scene: lamp("", &[square]) + &sky,
            ..case("square before a sky", &[], irradiance + 0.7 * (PI - irradiance))
        },
        Case {
            scene: lamp("", &quads) + &sky,
            ..case("ten squares before a sky", &[], by_ring + 0.7 * (PI - by_ring))
        },
        Case { scene: lamp("", &[]) + &sky, ..case("sky alone", &[], 0.7 * PI) },
        // Straight above at height 2 and tilted by 20 degrees: the point is in the full part of the cone.
        Case {
            scene: lamp("", &[])
                + &format!(
                    "[[light]]\nspot = {{ position = [0, 2, 0], toward = [0.36397, -1, 0], cone_angle = 80, blend = 0.3, \
                     intensity = {{ rgb = {BANDS:?} }} }}\n"
                ),
            ..case("spot", &[], 0.25)
        },
        sun("parallel sun", "", 0.0, 3.0 * libm::cos(0.7)),
        sun("sun as we see it", "", 0.533, 3.0 * libm::cos(0.7)),
        sun("wide sun before a sky", &sky, 80.0, 3.0 * libm::cos(0.7) + 0.7 * PI),
        // The lamp extends to 45 degrees and the sun to 44.1. With a diameter of 10, the sun's rim would shine past the
        // lamp.
        sun("sun hidden by a lamp", &lamp("", &[square]), 8.0, irradiance),
        Case {
            scene: lamp("", &[square])
                + &format!("[[light]]\npoint = {{ position = [0.3, 0.8, 0], intensity = {{ rgb = {BANDS:?} }} }}\n"),
            ..case("square and point", &[], irradiance + 0.8 / libm::pow(0.73, 1.5))
        },
    ]
}

/// Returns cases of squares in one plane, which do not hide each other, and points below them, which hide nothing.
fn crowds() -> Vec<Case> {
    let crowd = |name, rows: i32, others: &str, more: f64| {
        let (mut squares, mut points, mut irradiance) = (Vec::new(), String::new(), more);
        for (i, j) in (0..rows).flat_map(|i| (0..rows).map(move |j| (i, j))) {
            let [x, z] = [i, j].map(|k| 1.3 * f64::from(k) - 0.8 * f64::from(rows) + 0.37);
            let (center, u, v) = (DVec3::new(x, 2.0, z), DVec3::X * 0.2, DVec3::Z * 0.1);
            squares.push(quad(center, u, v));
            irradiance += quad_irradiance([0.0; 3], center, u, v);
            if (i + 2 * j) % 3 == 0 {
                let (way, intensity) = (DVec3::new(x + 0.3, 1.0 + 0.1 * f64::from(j % 5), z), 0.01 * f64::from(1 + i));
                points += &format!(
                    "[[light]]\npoint = {{ position = {:?}, intensity = {{ rgb = {:?} }} }}\n",
                    way.to_array(),
                    BANDS.map(|x| intensity * x)
                );
                irradiance += intensity * way.y / libm::pow(way.length(), 3.0);
            }
        }
        let squares: Vec<&str> = squares.iter().map(String::as_str).collect();
        Case { scene: lamp("", &squares) + &points + others, ..case(name, &[], irradiance) }
    };
    let (sin, cos) = libm::sincos(0.7);
    // The sun is behind the plane of the squares and shines between them.
    let sun = format!(
        "[[light]]\nsun = {{ toward = [0, {cos}, {sin}], angular_diameter = 0, irradiance = {{ rgb = {BANDS:?} }} }}\n"
    );
    vec![
        crowd("forty lamps", 5, "", 0.0),
        crowd("five hundred lamps", 20, "", 0.0),
        crowd("lamps and a sun", 6, &sun, cos),
    ]
}

#[test]
fn one_of_many_lamps_stands_for_all() {
    assert_closed_forms(&crowds());
}

#[test]
fn lights_together_send_the_sum_and_hide_each_other() {
    assert_closed_forms(&combined_lights());
}
