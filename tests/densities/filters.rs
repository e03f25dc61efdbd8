//! Samples of the pixel filters are compared with the densities that give the filters their names.

use abbe::film::{Filter, Mitchell, SampleWeights};
use abbe::math::DVec2;

use super::warps::{around, check_warp};
use crate::support::random::Random;

/// Returns a sample's position relative to the center of its pixel.
fn sample_offset(filter: Filter, u: [f64; 2]) -> [f64; 2] {
    let place = filter.place(u);
    [place.x - 0.5, place.y - 0.5]
}

#[test]
fn samples_of_a_tent_fall_in_a_straight_line() {
    for radius in [1.0, 2.5] {
        // The integral of 1 - |x| from -1.
        let below = |x: f64| if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) };
        let between = |low: f64, high: f64| below(2.0 * high - 1.0) - below(2.0 * low - 1.0);
        let warp = |u| sample_offset(Filter::Tent { radius }, u).map(|x| 0.5 + 0.5 * x / radius);
        check_warp(&format!("tent filter of radius {radius}"), warp, |x0, x1, y0, y1| {
            between(x0, x1) * between(y0, y1)
        });
    }
}

#[test]
fn samples_of_a_gaussian_are_normal_within_four_sigma() {
    let sigma = 0.5;
    let warp = |u| {
        let [x, y] = sample_offset(Filter::Gaussian { sigma }, u);
        [((x * x + y * y).sqrt() / (4.0 * sigma)).min(1.0), around(x, y)]
    };
    // The part exp(-r^2 / 2) of the normal distribution in the plane lies beyond r.
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
    let warp = |u| sample_offset(Filter::BlackmanHarris { radius }, u).map(|x| 0.5 + 0.5 * x / radius);
    // Dividing by the sum over the whole window removes the error of Simpson's rule.
    let all = between(0.0, 0.5) + between(0.5, 1.0);
    check_warp("Blackman-Harris filter", warp, |x0, x1, y0, y1| between(x0, x1) * between(y0, y1) / (all * all));
}

/// B and C of cubic filters: the plain one, the Catmull-Rom spline, the B-spline, and the ends of the allowed range.
const CUBICS: [[f64; 2]; 5] = [[1.0 / 3.0, 1.0 / 3.0], [0.0, 0.5], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

/// Returns the integral of a cubic filter from its center to x, with negative lobes counted as negative: from equation
/// 8 of Mitchell & Netravali 1988.
fn cubic(b: f64, c: f64, x: f64) -> f64 {
    let inner = [6.0 - 2.0 * b, 0.0, -18.0 + 12.0 * b + 6.0 * c, 12.0 - 9.0 * b - 6.0 * c];
    let outer = [8.0 * b + 24.0 * c, -12.0 * b - 48.0 * c, 6.0 * b + 30.0 * c, -b - 6.0 * c];
    let to = |piece: [f64; 4], x: f64| (0..4).map(|i| piece[i] * x.powi(i as i32 + 1) / (6.0 * (i as f64 + 1.0))).sum();
    let [near, far, start]: [f64; 3] = [to(inner, x.min(1.0)), to(outer, x.max(1.0)), to(outer, 1.0)];
    near + far - start
}

/// Returns the integral of a cubic filter's absolute value from its center to x. Beside a double root at 2, the outer
/// piece has the root (2 B + 6 C) / (B + 6 C).
fn absolute_cubic(b: f64, c: f64, x: f64) -> f64 {
    let root = (2.0 * b + 6.0 * c) / (b + 6.0 * c);
    if x <= root { cubic(b, c, x) } else { 2.0 * cubic(b, c, root) - cubic(b, c, x) }
}

#[test]
fn samples_of_cubics_follow_their_absolute_value() {
    for [b, c] in CUBICS {
        let filter = Filter::Mitchell(Mitchell { b, c });
        let all = 2.0 * absolute_cubic(b, c, 2.0);
        assert!((2.0 * cubic(b, c, 2.0) - 1.0).abs() < 1e-14, "the integral");
        assert!((filter.absolute_integral() - all * all).abs() < 1e-13, "the integral of the absolute value");
        let below = |x: f64| (0.5 * all + absolute_cubic(b, c, x.abs()).copysign(x)) / all;
        let between = |low: f64, high: f64| below(4.0 * high - 2.0) - below(4.0 * low - 2.0);
        let warp = |u| sample_offset(filter, u).map(|x| 0.5 + 0.25 * x);
        check_warp(&format!("mitchell filter {b} {c}"), warp, |x0, x1, y0, y1| between(x0, x1) * between(y0, y1));
    }
}

#[test]
fn cubics_have_the_published_values_and_add_up_to_1_over_all_pixels() {
    let value = |[b, c]: [f64; 2], x: f64| Filter::Mitchell(Mitchell { b, c }).value(DVec2::new(x, 0.0));
    // ((6 - 2 B) / 6)^2 at the center, and (6 - 2 B) / 6 times B / 6 one pixel beside it.
    assert!((value(CUBICS[0], 0.0) - 64.0 / 81.0).abs() < 1e-15);
    assert!((value(CUBICS[0], 1.0) - 8.0 / 9.0 / 18.0).abs() < 1e-15);
    // The Catmull-Rom spline passes through its samples. Halfway between them, their weights are 9 / 16 and -1 / 16.
    let halfway = [0.0, 1.0, 0.5, 1.5].map(|x| value(CUBICS[1], x));
    for (found, expected) in halfway.into_iter().zip([1.0, 0.0, 9.0 / 16.0, -1.0 / 16.0]) {
        assert!((found - expected).abs() < 1e-15, "{halfway:?}");
    }
    let mut random = Random::new(8);
    for [b, c] in CUBICS {
        let filter = Filter::Mitchell(Mitchell { b, c });
        for _ in 0..100 {
            let [x, y] = random.pair();
            let pixels = (-2..=2).flat_map(|i| (-2..=2).map(move |j| DVec2::new(f64::from(i), f64::from(j))));
            let sum: f64 = pixels.map(|pixel| filter.value(DVec2::new(x, y) - pixel)).sum();
            assert!((sum - 1.0).abs() < 1e-14, "{b} {c}: {sum}");
            let offset = DVec2::new(4.0 * x - 2.0, 4.0 * y - 2.0);
            assert_eq!(filter.subtracts(offset + 0.5), filter.value(offset) < 0.0);
        }
    }
}

/// Means of independent samples have the stated expectation and variance, for few samples as well as for many.
#[test]
fn means_of_signed_samples_are_unbiased_and_their_variance_is_known() {
    let filter = Filter::Mitchell(Mitchell { b: 0.0, c: 0.8 });
    // An edge 0.6 pixels right of the center, with light that grows to the right of it.
    let light = |x: f64| if x < 0.6 { 3.0 } else { 1.0 + 0.5 * x };
    let steps = 1 << 16;
    let exact: f64 = (0..steps)
        .map(|i| {
            let x = 4.0 * (f64::from(i) + 0.5) / f64::from(steps) - 2.0;
            // The other axis is evaluated at its center, so that its integral drops out.
            light(x) * filter.value(DVec2::new(x, 0.0)) / filter.value(DVec2::ZERO) * 4.0 / f64::from(steps)
        })
        .sum::<f64>();
    let mut random = Random::new(21);
    for (samples, pixels) in [(5, 400_000), (24, 100_000)] {
        let (mut sum, mut squares, mut predicted) = (0.0, 0.0, 0.0);
        for _ in 0..pixels {
            let (mut counts, mut sums, mut all) = ([0; 2], [0.0; 2], 0.0);
            for _ in 0..samples {
                let place = filter.place(random.pair());
                let value = light(place.x - 0.5);
                let lobe = usize::from(filter.subtracts(place));
                (counts[lobe], sums[lobe], all) = (counts[lobe] + 1, sums[lobe] + value, all + value * value);
            }
            let weights = SampleWeights::new(filter, counts);
            let mean = weights.sum(sums) / weights.taken();
            (sum, squares, predicted) = (sum + mean, squares + mean * mean, predicted + weights.variance(sums, all));
        }
        let pixels = f64::from(pixels);
        let (mean, variance) = (sum / pixels, squares / pixels - (sum / pixels) * (sum / pixels));
        // Once in 10000 times, all of 5 samples are in negative lobes, and there is nothing to subtract from.
        let z = (mean - exact) / (variance / pixels).sqrt();
        assert!(z.abs() < 4.0, "{samples} samples: {mean} is {z} standard errors off {exact}");
        let ratio = predicted / pixels / variance;
        assert!((ratio - 1.0).abs() < if samples == 5 { 0.25 } else { 0.05 }, "{samples} samples: {ratio}");
    }
}

#[test]
fn filters_stay_in_their_width_and_are_even() {
    let mut random = Random::new(3);
    let filters = [
        (Filter::Box, 0.5),
        (Filter::Tent { radius: 1.0 }, 1.0),
        (Filter::Gaussian { sigma: 0.5 }, 2.0),
        (Filter::BlackmanHarris { radius: 1.5 }, 1.5),
        (Filter::Mitchell(Mitchell::PLAIN), 2.0),
        (Filter::Mitchell(Mitchell { b: 0.0, c: 0.0 }), 2.0),
    ];
    let last = 1.0 - f64::from(f32::EPSILON) / 2.0;
    for (filter, width) in filters {
        let corners = [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.5, 0.5], [0.0, 0.5]];
        for u in (0..1000).map(|_| random.pair()).chain(corners) {
            let [x, y] = sample_offset(filter, u);
            assert!(x.abs() <= width + 1e-15 && y.abs() <= width + 1e-15, "{filter:?} at {u:?}: {x}, {y}");
            let other = sample_offset(filter, u.map(|u| 1.0 - u));
            assert!((x + other[0]).abs() < 1e-9 && (y + other[1]).abs() < 1e-9, "{filter:?} at {u:?}");
        }
        assert_eq!(sample_offset(filter, [0.5, 0.5]), [0.0; 2]);
    }
}
