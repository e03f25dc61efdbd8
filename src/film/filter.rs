use std::f64::consts::TAU;

use super::mitchell::{Mitchell, RADIUS};
use crate::math::{DVec2, sample_disk};

/// The reconstruction filter: where camera samples fall, within and around their pixel.
///
/// The filter is the probability density of the samples, which all have the same weight. Each sample contributes to one
/// pixel only, so pixels share no noise (Ernst, Stamminger & Greiner 2006, *Filter Importance Sampling*). Where a
/// filter is negative, its absolute value is the density and the samples are subtracted. Widths are in pixels.
///
/// ```toml
/// film.filter = "box"        # or "center", "tent", "gaussian", "blackman-harris", "mitchell"
/// # film.filter = { gaussian = { sigma = 0.5 } }
/// # or { tent = { radius = 1 } }, { blackman-harris = { radius = 1.5 } }, or { mitchell = { b = 0, c = 0.5 } }
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Filter {
    /// Uniform over the pixel.
    #[default]
    Box,
    /// Always at the center.
    Center,
    /// On each axis, a density that falls linearly to 0.
    Tent {
        /// The distance from the pixel's center where the density reaches 0. The plain filter uses 1.
        radius: f64,
    },
    /// A normal distribution, cut off at 4 standard deviations from the center.
    Gaussian {
        /// The standard deviation on each axis before the cut. The plain filter uses 0.5.
        sigma: f64,
    },
    /// On each axis, the four-term window with side lobes of -92 dB given by Harris 1978, *On the Use of Windows for
    /// Harmonic Analysis with the Discrete Fourier Transform*.
    BlackmanHarris {
        /// Half of the window's length. The plain filter uses 1.5.
        radius: f64,
    },
    /// A cubic on each axis with negative lobes, which keep edges sharp.
    Mitchell(Mitchell),
}

/// The distance at which the normal distribution is cut off, in standard deviations. 0.03 % of it lies beyond.
const CUTOFF: f64 = 4.0;
/// The fraction of the two-dimensional normal distribution within [`CUTOFF`]: 1 - exp(-CUTOFF^2 / 2).
const SHARE_WITHIN_CUTOFF: f64 = 0.9996645373720975;
/// The maximum distance of a sample from the center of its pixel, on one axis.
const MAX_REACH: f64 = 16.0;
/// The coefficients of the Blackman-Harris window.
const WINDOW: [f64; 4] = [0.35875, 0.48829, 0.14128, 0.01168];

impl Filter {
    /// All filters, with the parameters that they have if only their name is given.
    pub const PLAIN: [Self; 6] = [
        Self::Box,
        Self::Center,
        Self::Tent { radius: 1.0 },
        Self::Gaussian { sigma: 0.5 },
        Self::BlackmanHarris { radius: 1.5 },
        Self::Mitchell(Mitchell::PLAIN),
    ];

    /// Samples a position relative to the unit pixel, y down. The sample contributes to this pixel only.
    pub fn place(self, u: [f64; 2]) -> DVec2 {
        let middle = DVec2::splat(0.5);
        match self {
            Self::Box => u.into(),
            Self::Center => middle,
            Self::Tent { radius } => middle + DVec2::from(u.map(sample_tent)) * radius,
            Self::Gaussian { sigma } => middle + sample_normal(u) * sigma,
            Self::BlackmanHarris { radius } => middle + DVec2::from(u.map(sample_blackman_harris)) * radius,
            Self::Mitchell(cubic) => middle + DVec2::from(u.map(|u| cubic.place(u))),
        }
    }

    /// Returns the filter's value at an offset from the center of a pixel, in pixels. The filter integrates to 1. If it
    /// is nowhere negative, it is the density of the samples.
    ///
    /// A filter without width has no such value. Contributions that cannot be sampled at its position, but only found,
    /// are spread over the pixel.
    pub fn value(self, offset: DVec2) -> f64 {
        let separable = |value: &dyn Fn(f64) -> f64| value(offset.x) * value(offset.y);
        match self {
            Self::Box | Self::Center => separable(&|x| if (-0.5..0.5).contains(&x) { 1.0 } else { 0.0 }),
            Self::Tent { radius } => separable(&|x| (1.0 - x.abs() / radius).max(0.0) / radius),
            Self::Gaussian { sigma } => {
                let squared = offset.length_squared() / (sigma * sigma);
                if squared < CUTOFF * CUTOFF {
                    libm::exp(-0.5 * squared) / (TAU * sigma * sigma * SHARE_WITHIN_CUTOFF)
                } else {
                    0.0
                }
            }
            Self::BlackmanHarris { radius } => separable(&|x| {
                if x.abs() >= radius {
                    return 0.0;
                }
                let [a, b, c, d] = WINDOW;
                let cos = |times: f64| libm::cos(0.5 * TAU * times * x / radius);
                (a + b * cos(1.0) + c * cos(2.0) + d * cos(3.0)) / (2.0 * a * radius)
            }),
            Self::Mitchell(cubic) => separable(&|x| cubic.value(x)),
        }
    }

    /// Returns the positive part of the filter, normalized to integrate to 1.
    pub fn positive_value(self, offset: DVec2) -> f64 {
        self.value(offset).max(0.0) / (0.5 * (1.0 + self.absolute_integral()))
    }

    /// Returns whether samples may fall where the filter is negative.
    pub fn is_signed(self) -> bool {
        matches!(self, Self::Mitchell(_))
    }

    /// Returns whether a sample at a position relative to the unit pixel is subtracted.
    pub fn subtracts(self, place: DVec2) -> bool {
        self.is_signed() && self.value(place - 0.5) < 0.0
    }

    /// Returns the integral of the filter's absolute value. This is the weight of a sample before its sign.
    pub fn absolute_integral(self) -> f64 {
        match self {
            Self::Mitchell(cubic) => cubic.absolute_integral() * cubic.absolute_integral(),
            _ => 1.0,
        }
    }

    /// Returns the largest offset of a sample from the center of its pixel on each axis, in pixels.
    pub fn reach(self) -> f64 {
        match self {
            Self::Box | Self::Center => 0.5,
            Self::Tent { radius } | Self::BlackmanHarris { radius } => radius,
            Self::Gaussian { sigma } => CUTOFF * sigma,
            Self::Mitchell(_) => RADIUS,
        }
    }

    /// Returns whether the filter may differ from 0 within a distance of an offset from the center of a pixel, both in
    /// pixels.
    pub fn reaches(self, offset: DVec2, distance: f64) -> bool {
        let from_center = match self {
            Self::Gaussian { .. } => offset.length(),
            _ => offset.abs().max_element(),
        };
        from_center - distance <= self.reach()
    }

    /// Returns the filter's name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Center => "center",
            Self::Tent { .. } => "tent",
            Self::Gaussian { .. } => "gaussian",
            Self::BlackmanHarris { .. } => "blackman-harris",
            Self::Mitchell(_) => "mitchell",
        }
    }

    /// Returns the name and the width or other parameters, as files record them.
    pub fn described(self) -> String {
        let name = self.name();
        if let Self::Mitchell(Mitchell { b, c }) = self {
            return format!("{name} b {b} c {c}");
        }
        self.width().map_or(name.to_owned(), |(key, width, _)| format!("{name} {key} {width}"))
    }

    /// Returns the key, the value and the maximum of a width that is out of range.
    pub fn too_wide(self) -> Option<(&'static str, f64, f64)> {
        self.width().filter(|(_, width, most)| !(*width > 0.0 && width <= most))
    }

    fn width(self) -> Option<(&'static str, f64, f64)> {
        match self {
            Self::Box | Self::Center | Self::Mitchell(_) => None,
            Self::Tent { radius } | Self::BlackmanHarris { radius } => Some(("radius", radius, MAX_REACH)),
            Self::Gaussian { sigma } => Some(("sigma", sigma, MAX_REACH / CUTOFF)),
        }
    }
}

/// Samples the density 1 - |x| on -1 to 1 by inversion.
fn sample_tent(u: f64) -> f64 {
    if u < 0.5 { (2.0 * u).sqrt() - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).sqrt() }
}

/// Samples the two-dimensional normal distribution within [`CUTOFF`]. Maps the numbers to a disk and stretches its
/// radii, so that strata stay compact.
///
/// The disk has the fraction rho^2 of its area within radius rho, the distribution 1 - exp(-r^2 / 2) within r.
fn sample_normal(u: [f64; 2]) -> DVec2 {
    let point = sample_disk(u);
    let squared = point.length_squared();
    if squared == 0.0 {
        return DVec2::ZERO;
    }
    let stretched = -2.0 * libm::log1p(-SHARE_WITHIN_CUTOFF * squared.min(1.0));
    point * (stretched / squared).sqrt()
}

/// Samples the density of the window on -1 to 1. Inverts its integral by Newton's method, safeguarded by bisection.
fn sample_blackman_harris(u: f64) -> f64 {
    let [a, b, c, d] = WINDOW;
    // Solves for the half above 0, where the window falls from the center to the end.
    let target = (2.0 * u - 1.0).abs();
    let (mut low, mut high, mut x) = (0.0, 1.0, 0.5 * target);
    for _ in 0..60 {
        let (sin, cos) = libm::sincos(0.5 * TAU * x);
        let (sin2, cos2) = (2.0 * sin * cos, 2.0 * cos * cos - 1.0);
        let (sin3, cos3) = (sin2 * cos + cos2 * sin, cos2 * cos - sin2 * sin);
        let share = x + (b * sin + c * sin2 / 2.0 + d * sin3 / 3.0) / (0.5 * TAU * a);
        let density = 1.0 + (b * cos + c * cos2 + d * cos3) / a;
        let error = share - target;
        if error > 0.0 {
            high = x
        } else {
            low = x
        }
        let next = x - error / density;
        // An exact root equals one of the bounds.
        let next = if (low..=high).contains(&next) { next } else { 0.5 * (low + high) };
        let step = (next - x).abs();
        x = next;
        if step <= 1e-12 {
            break;
        }
    }
    if u < 0.5 { -x } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_window_is_an_exact_root() {
        assert_eq!(sample_blackman_harris(0.5), 0.0);
    }

    #[test]
    fn the_share_within_the_cut_is_that_of_the_normal_distribution() {
        assert_eq!(SHARE_WITHIN_CUTOFF, -libm::expm1(-0.5 * CUTOFF * CUTOFF));
    }
}
