//! Samples of the pixel filters against the densities that give them their names.

use abbe::film::Filter;

use super::warps::{around, check_warp};
use crate::support::random::Random;

/// A sample's place about the middle of its pixel.
fn about(filter: Filter, u: [f64; 2]) -> [f64; 2] {
    let place = filter.place(u);
    [place.x - 0.5, place.y - 0.5]
}

#[test]
fn samples_of_a_tent_fall_in_a_straight_line() {
    for radius in [1.0, 2.5] {
        // Integral of 1 - |x| from -1.
        let below = |x: f64| if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) };
        let between = |low: f64, high: f64| below(2.0 * high - 1.0) - below(2.0 * low - 1.0);
        let warp = |u| about(Filter::Tent { radius }, u).map(|x| 0.5 + 0.5 * x / radius);
        check_warp(&format!("tent filter of radius {radius}"), warp, |x0, x1, y0, y1| {
            between(x0, x1) * between(y0, y1)
        });
    }
}

#[test]
fn samples_of_a_gaussian_are_normal_within_four_sigma() {
    let sigma = 0.5;
    let warp = |u| {
        let [x, y] = about(Filter::Gaussian { sigma }, u);
        [((x * x + y * y).sqrt() / (4.0 * sigma)).min(1.0), around(x, y)]
    };
    // Of the plane's normal distribution, exp(-r^2 / 2) lies beyond r.
    let beyond = |r: f64| libm::exp(-0.5 * 16.0 * r * r);
    let probability = |r0, r1, a0, a1| (beyond(r0) - beyond(r1)) / (1.0 - beyond(1.0)) * (a1 - a0);
    check_warp("gaussian filter", warp, probability);
}

#[test]
fn samples_of_blackman_harris_follow_the_window() {
    // Harris 1978, table 1, integrated by Simpson's rule.
    let window = |t: f64| {
        let turn = std::f64::consts::TAU * t;
        0.35875 - 0.48829 * libm::cos(turn) + 0.14128 * libm::cos(2.0 * turn) - 0.01168 * libm::cos(3.0 * turn)
    };
    let between = |low: f64, high: f64| {
        let step = (high - low) / 64.0;
        let inner = |i: u32| if i % 2 == 1 { 4.0 } else { 2.0 } * window(low + f64::from(i) * step);
        (window(low) + (1..64).map(inner).sum::<f64>() + window(high)) * step / 3.0 / 0.35875
    };
    let radius = 1.5;
    let warp = |u| about(Filter::BlackmanHarris { radius }, u).map(|x| 0.5 + 0.5 * x / radius);
    // What Simpson's rule leaves is taken out by the sum over the whole window.
    let all = between(0.0, 0.5) + between(0.5, 1.0);
    check_warp("Blackman-Harris filter", warp, |x0, x1, y0, y1| between(x0, x1) * between(y0, y1) / (all * all));
}

#[test]
fn filters_stay_in_their_width_and_are_even() {
    let mut random = Random::new(3);
    let filters = [
        (Filter::Box, 0.5),
        (Filter::Tent { radius: 1.0 }, 1.0),
        (Filter::Gaussian { sigma: 0.5 }, 2.0),
        (Filter::BlackmanHarris { radius: 1.5 }, 1.5),
    ];
    let last = 1.0 - f64::from(f32::EPSILON) / 2.0;
    for (filter, width) in filters {
        let corners = [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.5, 0.5], [0.0, 0.5]];
        for u in (0..1000).map(|_| random.pair()).chain(corners) {
            let [x, y] = about(filter, u);
            assert!(x.abs() <= width + 1e-15 && y.abs() <= width + 1e-15, "{filter:?} at {u:?}: {x}, {y}");
            let other = about(filter, u.map(|u| 1.0 - u));
            assert!((x + other[0]).abs() < 1e-9 && (y + other[1]).abs() < 1e-9, "{filter:?} at {u:?}");
        }
        assert_eq!(about(filter, [0.5, 0.5]), [0.0; 2]);
    }
}
