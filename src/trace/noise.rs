//! The noise of an image, told by replicates.
//!
//! The error of the mean of all replicates is itself a random number. Where pixels know nothing of each other it is
//! hardly one, for they are many; but light vertices and photons are shared by pixels, so that a whole image may be too
//! bright, and in a caustic few pixels make most of it. So the bound is one for a single draw, as the upper end of a
//! prediction interval is: with x of R replicates, mean x + t s sqrt(1 + 1/R), where s is their standard deviation and t
//! Student's of R - 1 degrees. Errors are never negative and now and then large, so x is their logarithm; the bound is no
//! less than it is of the errors themselves.

use serde::{Deserialize, Serialize};

use super::replicates::{REPLICATES, Replicates};
use crate::film::{Filter, TilePlace};

/// How far the replicates of an image are apart, and what that tells of their mean.
///
/// Errors are relative: the root of the mean square, over all pixels and the three film channels, by that of the image
/// itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Camera samples of each pixel that it is the noise of.
    pub samples: u32,
    /// The error that is expected.
    pub expected: f64,
    /// The error is smaller than this in 95 of 100 renders.
    pub at_most: f64,
    /// The tile of 16 x 16 pixels with most noise: the first column and row, and its error, relative to the image.
    pub worst_tile: TileNoise,
    /// A pixel that makes much of the noise by what one replicate found alone: light that is hardly ever found, of
    /// which no number of samples tells how much there is.
    pub outlier: Option<Outlier>,
}

/// The noise of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TileNoise {
    /// Its first column and row in the format.
    pub corner: [i64; 2],
    /// The error that is expected of it, relative to the image.
    pub expected: f64,
}

/// A pixel whose noise tells that its light is hardly ever found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outlier {
    /// Its column and row in the format.
    pub pixel: [i64; 2],
    /// Its part of the image's variance.
    pub share: f64,
    /// The replicate that found it, counted from 0.
    pub replicate: u32,
}

/// Student's t for 95 %, one side, 7 degrees of freedom.
const STUDENT: f64 = 1.894_578_605;
/// A pixel with more than this part of all variance is looked at (row A7 of the stability catalog).
const MUCH: f64 = 0.1;
/// The part of a pixel's variance that one of eight replicates makes where it stands out: the largest of eight normal
/// numbers is as far from their mean in 1 of 20 cases (Grubbs 1950, *Sample Criteria for Testing Outlying
/// Observations*: 2.126 standard deviations; 2.126^2 / 7).
const ALONE: f64 = 0.6457;

/// Sums over some pixels.
#[derive(Default)]
struct Spread {
    /// Of squared deviations from the mean of the replicates, and of squares of the mean.
    deviations: [f64; REPLICATES],
    squares: f64,
    numbers: f64,
    /// The pixel with the largest deviations in which one replicate stands out: where it is, and how large they are.
    outlier: Option<(Outlier, f64)>,
}

impl Spread {
    fn total(&self) -> f64 {
        self.deviations.iter().sum()
    }

    /// Adds a pixel of the format.
    fn add(&mut self, pixel: [i64; 2], replicates: &[[f64; 3]; REPLICATES]) {
        let mean: [f64; 3] = std::array::from_fn(|i| replicates.iter().map(|rgb| rgb[i]).sum::<f64>());
        let mean = mean.map(|sum| sum / REPLICATES as f64);
        let apart = |rgb: &[f64; 3]| (0..3).map(|i| (rgb[i] - mean[i]) * (rgb[i] - mean[i])).sum::<f64>();
        let deviations = replicates.each_ref().map(apart);
        let (mut sum, mut most, mut replicate) = (0.0, 0.0, 0);
        for (number, &deviation) in deviations.iter().enumerate() {
            self.deviations[number] += deviation;
            sum += deviation;
            if deviation > most {
                (most, replicate) = (deviation, number as u32);
            }
        }
        if most > ALONE * sum && self.outlier.as_ref().is_none_or(|(_, other)| sum > *other) {
            self.outlier = Some((Outlier { pixel, share: 0.0, replicate }, sum));
        }
        self.squares += mean.iter().map(|x| x * x).sum::<f64>();
        self.numbers += 3.0;
    }

    fn join(&mut self, other: Self) {
        for (sum, more) in self.deviations.iter_mut().zip(other.deviations) {
            *sum += more;
        }
        (self.squares, self.numbers) = (self.squares + other.squares, self.numbers + other.numbers);
        let is_larger = |new: &(Outlier, f64)| self.outlier.as_ref().is_none_or(|old| new.1 > old.1);
        if let Some(outlier) = other.outlier.filter(is_larger) {
            self.outlier = Some(outlier);
        }
    }

    /// What the sums tell.
    fn noise(self, samples: u32, worst: Option<([i64; 2], f64)>) -> Noise {
        let count = REPLICATES as f64;
        // The mean is nearer to each replicate than the truth is.
        let error = |deviation: f64| deviation / self.numbers.max(1.0) * count / (count - 1.0);
        let errors = self.deviations.map(error);
        let mean = errors.iter().sum::<f64>() / count;
        let bound = predicted(errors).max(libm::exp(predicted(errors.map(libm::log))));
        // The square of the mean has its variance in it.
        let signal = self.squares / self.numbers.max(1.0) - mean / count;
        let relative = |error: f64| match error / count / signal {
            _ if error == 0.0 => 0.0,
            square if square >= 0.0 => square.sqrt(),
            _ => f64::INFINITY,
        };
        let total = self.total();
        let outlier = self.outlier.map(|(outlier, sum)| Outlier { share: sum / total, ..outlier });
        let of_tile = |(corner, variance)| TileNoise { corner, expected: relative(variance * count) };
        Noise {
            samples,
            expected: relative(mean),
            at_most: relative(bound),
            worst_tile: worst.map_or(TileNoise::default(), of_tile),
            outlier: outlier.filter(|outlier| outlier.share > MUCH),
        }
    }
}

/// What the next of some numbers stays below in 95 of 100 cases; nothing is told where one of them is not finite.
fn predicted(numbers: [f64; REPLICATES]) -> f64 {
    let count = REPLICATES as f64;
    let mean = numbers.iter().sum::<f64>() / count;
    let squares: f64 = numbers.iter().map(|number| (number - mean) * (number - mean)).sum();
    mean + STUDENT * (squares / (count - 1.0) * (1.0 + 1.0 / count)).sqrt()
}

/// The noise of an image's tiles, whose first pixels are given, after so many samples of each replicate.
pub(super) fn noise<'t>(
    tiles: impl Iterator<Item = (&'t Replicates, TilePlace)>,
    first: [i32; 2],
    filter: Filter,
    each: u32,
) -> Noise {
    let (mut all, mut worst): (Spread, Option<([i64; 2], f64)>) = (Spread::default(), None);
    for (replicates, place) in tiles {
        let corner = [0, 1].map(|i| i64::from(first[i]) + i64::from(place.corner[i]));
        let mut of_tile = Spread::default();
        for pixel in 0..place.pixels() {
            let (x, y) = (pixel as i64 % i64::from(place.width), pixel as i64 / i64::from(place.width));
            of_tile.add([corner[0] + x, corner[1] + y], &replicates.pixel(pixel, filter, each));
        }
        let count = REPLICATES as f64;
        let variance = of_tile.total() / of_tile.numbers / (count * (count - 1.0));
        if worst.is_none_or(|(_, most)| variance > most) {
            worst = Some((corner, variance));
        }
        all.join(of_tile);
    }
    all.noise(REPLICATES as u32 * each, worst)
}
