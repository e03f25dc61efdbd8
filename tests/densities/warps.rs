//! Maps from the unit square are compared with their stated densities.

use std::f64::consts::{PI, TAU};

use abbe::math::{
    DVec3, cone, one_minus_cos_of_cone, sample_cosine_hemisphere, sample_disk, sample_sphere, sample_triangle,
};

use crate::support::chi_squared;
use crate::support::random::Random;

/// Number of calls of `check_warp`, including those for filters.
const TESTS: u32 = 17;
const DRAWS: usize = 400_000;
const ROWS: usize = 16;
const COLUMNS: usize = 16;

/// Tests a map into the unit square. The probability of every cell of a grid is known.
pub fn check_warp(name: &str, warp: impl Fn([f64; 2]) -> [f64; 2], probability: impl Fn(f64, f64, f64, f64) -> f64) {
    let mut random = Random::new(name.bytes().map(u64::from).sum());
    let mut counts = vec![0; ROWS * COLUMNS];
    for _ in 0..DRAWS {
        let [x, y] = warp(random.pair());
        assert!((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y), "{name}: ({x}, {y})");
        let cell = |x: f64, cells: usize| ((x * cells as f64) as usize).min(cells - 1);
        counts[cell(x, ROWS) * COLUMNS + cell(y, COLUMNS)] += 1;
    }
    let edge = |cell: usize, cells: usize| cell as f64 / cells as f64;
    let probabilities: Vec<f64> = (0..ROWS * COLUMNS)
        .map(|bin| {
            let (row, column) = (bin / COLUMNS, bin % COLUMNS);
            probability(edge(row, ROWS), edge(row + 1, ROWS), edge(column, COLUMNS), edge(column + 1, COLUMNS))
        })
        .collect();
    assert!((probabilities.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    chi_squared::check(name, &counts, &probabilities, TESTS);
}

/// Returns the azimuth as a fraction of a full turn.
pub fn around(x: f64, y: f64) -> f64 {
    (libm::atan2(y, x) / TAU + 0.5).clamp(0.0, 1.0)
}

#[test]
fn points_of_the_disk_are_uniform_by_area() {
    // The area between two radii and two azimuths, divided by pi.
    let probability = |r0: f64, r1: f64, a0: f64, a1: f64| (r1 * r1 - r0 * r0) * (a1 - a0);
    check_warp("disk", |u| [sample_disk(u).length(), around(sample_disk(u).x, sample_disk(u).y)], probability);
}

#[test]
fn directions_of_the_cosine_hemisphere_follow_the_cosine() {
    // The integral of cos(theta) / pi between two heights and two azimuths.
    let probability = |z0: f64, z1: f64, a0: f64, a1: f64| (z1 * z1 - z0 * z0) * (a1 - a0);
    let warp = |u| {
        let d: DVec3 = sample_cosine_hemisphere(u);
        assert!((d.length() - 1.0).abs() < 1e-15);
        [d.z, around(d.x, d.y)]
    };
    check_warp("cosine hemisphere", warp, probability);
}

#[test]
fn directions_of_the_sphere_are_uniform() {
    let uniform = |z0: f64, z1: f64, a0: f64, a1: f64| (z1 - z0) * (a1 - a0);
    let warp = |u| {
        let d = sample_sphere(u);
        assert!((d.length() - 1.0).abs() < 1e-15);
        [(0.5 + 0.5 * d.z).clamp(0.0, 1.0), around(d.x, d.y)]
    };
    check_warp("sphere", warp, uniform);
}

#[test]
fn directions_of_a_cone_are_uniform() {
    for half_angle in [1e-8, 1e-3, 0.5, 0.5 * PI] {
        let sin = libm::sin(half_angle);
        let one_minus_cos = one_minus_cos_of_cone(sin * sin);
        let exact = 2.0 * libm::pow(libm::sin(0.5 * half_angle), 2.0);
        assert!((one_minus_cos / exact - 1.0).abs() < 1e-14, "1 - cos of {half_angle}: {one_minus_cos:e}");
        let probability = |x0: f64, x1: f64, a0: f64, a1: f64| (x1 - x0) * (a1 - a0);
        // 1 - cos is computed from the chord to the axis, which stays accurate in narrow cones.
        let warp = |u| {
            let d = cone(one_minus_cos, u);
            let x = 0.5 * (d - DVec3::Z).length_squared() / one_minus_cos;
            [if x > 1.0 && x < 1.0 + 1e-14 { 1.0 } else { x }, around(d.x, d.y)]
        };
        check_warp(&format!("cone of {half_angle}"), warp, probability);
    }
}

#[test]
fn points_of_a_triangle_are_uniform_by_area() {
    // The part of a cell below the diagonal of the square, divided by the triangle's area of 1/2.
    let probability = |x0: f64, x1: f64, y0: f64, y1: f64| {
        let whole = (x1 - x0) * (y1 - y0);
        if x1 + y1 <= 1.0 {
            2.0 * whole
        } else if x0 + y0 >= 1.0 {
            0.0
        } else {
            whole
        }
    };
    check_warp("triangle", sample_triangle, probability);
}
