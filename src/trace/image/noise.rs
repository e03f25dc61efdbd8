//! The noise of an image, estimated from replicates.
//!
//! With errors e_r of R replicates, the error of their mean is expected to be E = mean |e_r|^2 / R. The actual error is
//! a random number, and the bound has to hold for the one that was drawn. Two things about it are unknown:
//!
//! - E is an estimate, from few replicates.
//! - The error that was drawn varies around E. With independent pixels it hardly does, since there are many. But pixels
//!   share light vertices and photons, so that a whole image may be too bright. And one pixel may make most of the
//!   noise.
//!
//! Both depend on how many numbers the errors consist of. For normal errors, |e_r|^2 has the variance g^2 = 2 tr(C^2),
//! where C is the covariance of all pixels. The products of two replicates estimate that: the mean of (e_r . e_s)^2 is
//! tr(C^2). How much the |e_r|^2 differ, s^2, is another estimate, and the larger counts. |e_r|^2 is then about as
//! random as the sum of f = 2 E^2 R^2 / max(g^2, s^2) squares (Satterthwaite 1946, *An Approximate Distribution of
//! Estimates of Variance Components*), and the actual error over its estimate as F with f and (R - 1) f degrees of
//! freedom: the bound is its 95 % quantile, times E. What s^2 has beyond g^2 are rare bright samples, of which the mean
//! has R times as many: Student's t of R - 1 degrees of freedom times sqrt(2 (s^2 - g^2) / R) / R is added to that, as
//! the square root of the sum of both squares.
//!
//! Light that only one replicate found may be one of many rare finds, of which others were missed. Where one is found,
//! up to 4.74 are expected, at 95 % (Garwood 1936, *Fiducial Limits for the Poisson Distribution*): that many times as
//! much light as was found may be missing, wherever it is. Its square adds to the bound.

use serde::{Deserialize, Serialize};

use super::blur::squared_blur;
use crate::film::{Filter, TilePlace};
use crate::trace::replicates::{Products, REPLICATES, Replicates};

/// How much the replicates of an image differ, and what that tells about their mean.
///
/// Errors are relative: the root mean square over all pixels and film channels, divided by that of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Noise {
    /// Camera samples of each pixel for which the noise is measured.
    pub samples: u32,
    /// The expected error.
    pub expected: f64,
    /// The error is smaller than this in 95 of 100 renders of as many samples, with light as rare as that of the
    /// outlier. A render that takes samples until this is small enough tends to stop when it is too small by chance.
    pub at_most: f64,
    /// The tile of 16 x 16 pixels with the most noise: its first column and row, and its error relative to the image.
    pub worst_tile: TileNoise,
    /// A pixel that causes much of the noise by light that only one replicate found: light that is hardly ever found.
    pub outlier: Option<Outlier>,
}

/// What replicates tell about the error of their mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The random error of the image.
    pub noise: Noise,
    /// How much gathered photons blur it, relative to the image like the noise; 0 without them.
    pub blur: Estimate,
    /// The noise of alpha, where shadow catchers cause some: the root mean square over all pixels, divided by that of
    /// alpha itself. Alpha never exceeds 1, so no light is rare enough to make it far off unseen.
    pub alpha: Option<Estimate>,
}

/// An estimate of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The expected error.
    pub expected: f64,
    /// The error is smaller than this in 95 of 100 renders.
    pub at_most: f64,
}

impl Measured {
    /// Returns a bound on the error that holds in 95 of 100 renders or more, since it combines two such bounds. The
    /// noise of a pixel is independent of its blur, so their squares add up. The larger of the errors of colors and
    /// alpha counts.
    pub fn at_most(&self) -> f64 {
        let alpha = self.alpha.map_or(0.0, |alpha| alpha.at_most);
        self.noise.at_most.hypot(self.blur.at_most).max(alpha)
    }
}

/// The noise of a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TileNoise {
    /// Its first column and row in the format.
    pub corner: [i64; 2],
    /// Its expected error, relative to the image.
    pub expected: f64,
}

/// A pixel whose noise shows that its light is hardly ever found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outlier {
    /// Its column and row in the format.
    pub pixel: [i64; 2],
    /// Its share of the image's variance.
    pub share: f64,
    /// The replicate that found it, counted from 0.
    pub replicate: u32,
}

/// Student's t for 95 %, one side, 7 degrees of freedom.
const STUDENT_T: f64 = 1.894_578_605;
/// A pixel with more than this share of all variance may be an outlier (row A7 of the stability catalog).
const MIN_OUTLIER_SHARE: f64 = 0.1;
/// Share of a pixel's variance above which one of eight replicates stands out: the largest of eight normal numbers is
/// as far from their mean in 1 of 20 cases (Grubbs 1950, *Sample Criteria for Testing Outlying Observations*: 2.126
/// standard deviations; 2.126^2 / 7).
const GRUBBS_SHARE: f64 = 0.6457;
/// How many finds may be expected where there is one: a Poisson number with this mean is 0 or 1 in 5 of 100 cases.
const MAX_UNSEEN: f64 = 4.743_864_518;

/// The 95 % quantile of the normal distribution.
const NORMAL_QUANTILE: f64 = 1.644_853_627;

/// Returns about the 95 % quantile of the F distribution with 1 or more degrees of freedom of both squares, the second
/// 7 or more: too low by at most 2 %. Both cube roots are about normal.
///
/// Paulson 1942, *An Approximate Normalization of the Analysis of Variance Distribution*, equation 5.
fn f_quantile(first: f64, second: f64) -> f64 {
    let [a, b] = [first, second].map(|freedom| 2.0 / (9.0 * freedom));
    let squared = NORMAL_QUANTILE * NORMAL_QUANTILE;
    // The cube root x solves (1 - b) x - (1 - a) = NORMAL_QUANTILE sqrt(b x^2 + a).
    let [two, one, none] =
        [(1.0 - b) * (1.0 - b) - squared * b, (1.0 - a) * (1.0 - b), (1.0 - a) * (1.0 - a) - squared * a];
    let root = (one + (one * one - two * none).max(0.0).sqrt()) / two;
    root * root * root
}

/// Sums over some pixels.
#[derive(Default)]
struct Spread {
    /// Sums of products of the replicates' deviations from their mean, and of the squared mean.
    products: Products,
    squares: f64,
    numbers: f64,
    /// The pixel with the largest deviations in which one replicate stands out, and the sum of their squares.
    outlier: Option<(Outlier, f64)>,
}

impl Spread {
    /// Returns the sum of all squared deviations.
    fn total(&self) -> f64 {
        (0..REPLICATES).map(|i| self.products.0[i][i]).sum()
    }

    /// Adds a pixel of the format, with some channels.
    fn add<const C: usize>(&mut self, pixel: [i64; 2], replicates: &[[f64; C]; REPLICATES]) {
        let mean: [f64; C] = std::array::from_fn(|i| replicates.iter().map(|values| values[i]).sum::<f64>());
        let mean = mean.map(|sum| sum / REPLICATES as f64);
        let deviations = replicates.map(|values| -> [f64; C] { std::array::from_fn(|i| values[i] - mean[i]) });
        self.products.add(&deviations);
        let (mut sum, mut largest, mut replicate) = (0.0, 0.0, 0);
        for (number, deviation) in deviations.iter().enumerate() {
            let square = deviation.iter().map(|x| x * x).sum::<f64>();
            sum += square;
            if square > largest {
                (largest, replicate) = (square, number as u32);
            }
        }
        if largest > GRUBBS_SHARE * sum && self.outlier.as_ref().is_none_or(|(_, other)| sum > *other) {
            self.outlier = Some((Outlier { pixel, share: 0.0, replicate }, sum));
        }
        self.squares += mean.iter().map(|x| x * x).sum::<f64>();
        self.numbers += C as f64;
    }

    fn join(&mut self, other: Self) {
        self.products.join(&other.products);
        (self.squares, self.numbers) = (self.squares + other.squares, self.numbers + other.numbers);
        let is_larger = |new: &(Outlier, f64)| self.outlier.as_ref().is_none_or(|old| new.1 > old.1);
        if let Some(outlier) = other.outlier.filter(is_larger) {
            self.outlier = Some(outlier);
        }
    }

    /// Returns the mean square error of a replicate, and the 95 % bound of that of the mean of all, times their number.
    fn errors(&self) -> [f64; 2] {
        let (count, numbers) = (REPLICATES as f64, self.numbers.max(1.0));
        // Each replicate is a part of the mean from which it deviates.
        let errors: [f64; REPLICATES] =
            std::array::from_fn(|i| self.products.0[i][i] / numbers * count / (count - 1.0));
        let mean = errors.iter().sum::<f64>() / count;
        let spread = errors.iter().map(|error| (error - mean) * (error - mean)).sum::<f64>() / (count - 1.0);
        let mut shared = 0.0;
        for (i, products) in self.products.0.iter().enumerate() {
            for product in &products[..i] {
                // Deviations of two replicates have the covariance -C / R, those of one (1 - 1/R) C.
                let product = product / numbers + mean / count;
                shared += product * product;
            }
        }
        let own_share = 1.0 - 1.0 / count;
        let pairs = 0.5 * count * (count - 1.0);
        let normal = 2.0 * shared / pairs / (own_share * own_share + 1.0 / (count * count));
        let freedom = (2.0 * mean * mean / normal.max(spread)).max(1.0);
        let drawn = mean * (f_quantile(freedom, (count - 1.0) * freedom) - 1.0);
        let rare = STUDENT_T * (2.0 * (spread - normal).max(0.0) / count).sqrt();
        [mean, mean + drawn.hypot(rare)]
    }

    /// Returns a mean square error as an error relative to the mean of all replicates.
    fn relative(&self, square: f64) -> f64 {
        let (numbers, [mean, _]) = (self.numbers.max(1.0), self.errors());
        // The square of the mean includes its variance.
        let signal = self.squares / numbers - mean / REPLICATES as f64;
        match square / signal {
            _ if square == 0.0 => 0.0,
            relative if relative >= 0.0 => relative.sqrt(),
            _ => f64::INFINITY,
        }
    }

    /// Returns the noise after `samples` samples. `worst` is the tile with the largest mean square error.
    fn noise(&self, samples: u32, worst: Option<([i64; 2], f64)>) -> Noise {
        let (count, total, [mean, bound]) = (REPLICATES as f64, self.total(), self.errors());
        let outlier = self.outlier.map(|(outlier, sum)| Outlier { share: sum / total, ..outlier });
        let outlier = outlier.filter(|outlier| outlier.share > MIN_OUTLIER_SHARE);
        let unseen = outlier.map_or(0.0, |outlier| MAX_UNSEEN * MAX_UNSEEN * outlier.share * mean);
        let tile_noise = |(corner, square)| TileNoise { corner, expected: self.relative(square) };
        Noise {
            samples,
            expected: self.relative(mean / count),
            at_most: self.relative((bound + unseen) / count),
            worst_tile: worst.map_or(TileNoise::default(), tile_noise),
            outlier,
        }
    }
}

/// Measures the errors of an image's tiles after `each` samples of each replicate. `first` is the image's first pixel.
pub fn measure<'t>(
    tiles: impl Iterator<Item = (&'t Replicates, TilePlace)>,
    first: [i32; 2],
    filter: Filter,
    each: u32,
) -> Measured {
    let (mut all, mut worst): (Spread, Option<([i64; 2], f64)>) = (Spread::default(), None);
    let (mut alpha, mut blur) = (Spread::default(), Products::default());
    for (replicates, place) in tiles {
        let corner = [0, 1].map(|i| i64::from(first[i]) + i64::from(place.corner[i]));
        let (mut tile_noise, mut tile_alpha, mut tile_blur) =
            (Spread::default(), Spread::default(), Products::default());
        for pixel in 0..place.pixels() {
            let (x, y) = (pixel as i64 % i64::from(place.width), pixel as i64 / i64::from(place.width));
            let pixel_place = [corner[0] + x, corner[1] + y];
            tile_noise.add(pixel_place, &replicates.pixel(pixel, filter, each));
            replicates.blur(pixel, filter).iter().for_each(|replicates| tile_blur.add(replicates));
            let alphas = replicates.alpha(pixel, filter, each);
            alphas.iter().for_each(|alphas| tile_alpha.add(pixel_place, &alphas.map(|alpha| [alpha])));
        }
        let count = REPLICATES as f64;
        let square = tile_noise.total() / tile_noise.numbers / (count * (count - 1.0));
        if worst.is_none_or(|(_, largest)| square > largest) {
            worst = Some((corner, square));
        }
        all.join(tile_noise);
        alpha.join(tile_alpha);
        blur.join(&tile_blur);
    }
    let numbers = all.numbers.max(1.0);
    let [expected, at_most] = squared_blur(&blur, STUDENT_T).map(|squares| all.relative(squares / numbers));
    let blur = Estimate { expected, at_most };
    let Noise { expected, at_most, .. } = alpha.noise(REPLICATES as u32 * each, None);
    let alpha = (alpha.numbers > 0.0).then_some(Estimate { expected, at_most });
    Measured { noise: all.noise(REPLICATES as u32 * each, worst), blur, alpha }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{BranchKey, Sampler};

    /// Renders 1024 pixels with eight replicates of `samples` samples, many times. Returns the share of renders that
    /// are off by no more than their bound, and the share in which one replicate found much of the noise alone. `value`
    /// is that of a sample with a random number in a pixel, and `truth` its mean there.
    fn shares_of_renders(value: &dyn Fn(u32, f64) -> f64, truth: &dyn Fn(u32) -> f64, samples: u32) -> [f64; 2] {
        const RENDERS: u32 = 60;
        const PIXELS: u32 = 1024;
        let squares: f64 = (0..PIXELS).map(|pixel| truth(pixel) * truth(pixel)).sum();
        let mut shares_of_renders = [0.0; 2];
        for render in 0..RENDERS {
            let (mut spread, mut error) = (Spread::default(), 0.0);
            for pixel in 0..PIXELS {
                let replicates: [[f64; 3]; REPLICATES] = std::array::from_fn(|replicate| {
                    let key = [render, pixel * REPLICATES as u32 + replicate as u32];
                    let number = |sample| Sampler::new(7, key, sample).get_random_4d(BranchKey::CAMERA, 0)[0];
                    let sum = (0..samples).map(|sample| value(pixel, number(sample).max(1e-12))).sum::<f64>();
                    [sum / f64::from(samples); 3]
                });
                let mean = replicates.iter().map(|rgb| rgb[0]).sum::<f64>() / REPLICATES as f64;
                error += (mean - truth(pixel)) * (mean - truth(pixel)) / squares;
                spread.add([i64::from(pixel), 0], &replicates);
            }
            let noise = spread.noise(samples, None);
            shares_of_renders[0] += f64::from(u8::from(error.sqrt() <= noise.at_most)) / f64::from(RENDERS);
            shares_of_renders[1] += f64::from(u8::from(noise.outlier.is_some())) / f64::from(RENDERS);
        }
        shares_of_renders
    }

    /// Quantiles by Abramowitz & Stegun 1964, *Handbook of Mathematical Functions*, table 26.9.
    #[test]
    fn quantiles_of_f_are_those_of_the_table() {
        for ([first, second], quantile) in
            [([1.0, 7.0], 5.59), ([2.0, 14.0], 3.74), ([3.0, 21.0], 3.07), ([4.0, 28.0], 2.71), ([8.0, 60.0], 2.10)]
        {
            let found = f_quantile(first, second);
            assert!((found / quantile - 1.0).abs() < 0.02, "{first}, {second}: {found} for {quantile}");
        }
        assert!((f_quantile(1e12, 7e12) - 1.0).abs() < 1e-5);
    }

    /// Normal errors of one pixel, of several, and of one beside many dimmer ones.
    #[test]
    fn bounds_are_kept_by_few_pixels_as_by_many() {
        let scales = |first: usize, others: usize, dimmer: f64| [vec![1.0; first], vec![dimmer; others]].concat();
        for (number, sizes) in
            [scales(1, 0, 0.0), scales(3, 0, 0.0), scales(1, 50, 0.1), scales(200, 0, 0.0)].iter().enumerate()
        {
            const RENDERS: u32 = 4000;
            let mut over = 0;
            for render in 0..RENDERS {
                let (mut spread, mut error) = (Spread::default(), 0.0);
                for (pixel, size) in sizes.iter().enumerate() {
                    let normal = |replicate: usize| {
                        let u = Sampler::new(number as u64, [render, replicate as u32], pixel as u32)
                            .get_random_4d(BranchKey::CAMERA, 0);
                        size * (-2.0 * libm::log(1.0 - u[0])).sqrt() * libm::cos(std::f64::consts::TAU * u[1])
                    };
                    let replicates: [[f64; 1]; REPLICATES] = std::array::from_fn(|replicate| [1e3 + normal(replicate)]);
                    let off = replicates.iter().map(|value| value[0] - 1e3).sum::<f64>() / REPLICATES as f64;
                    error += off * off;
                    spread.add([pixel as i64, 0], &replicates);
                }
                let [_, bound] = spread.errors();
                over += u32::from(error > bound * sizes.len() as f64 / REPLICATES as f64);
            }
            let share = f64::from(over) / f64::from(RENDERS);
            // Of one pixel beside many, 8 % are off by more: its own error is known less well than that of all.
            assert!(share < if number == 2 { 0.095 } else { 0.07 }, "{number}: {share}");
        }
    }

    /// Row A7 of the stability catalog. u^-0.3 has three moments, u^-0.45 has two, and u^-0.8 has no variance.
    #[test]
    fn a7_bounds_of_samples_without_variance_are_kept_by_what_may_be_unseen() {
        for (a, samples) in [0.3, 0.45, 0.8].into_iter().flat_map(|a| [(a, 8), (a, 64)]) {
            let [kept, rare] = shares_of_renders(&|_, u| libm::pow(u, -a), &|_| 1.0 / (1.0 - a), samples);
            assert!(kept >= 0.95, "u^-{a}, {samples}: {kept} {rare}");
            assert!(if a == 0.3 { rare < 0.25 } else { a == 0.45 || rare >= 0.95 }, "u^-{a}, {samples}: {rare}");
        }
        // Light that a render finds once or twice, or never, in one of many pixels, and a hundred times as bright.
        for (pixels, chance, samples) in [(1024, 1.2e-5, 16), (100, 8e-5, 16), (1024, 1e-5, 8)] {
            let bright = |pixel| if pixel < pixels { 100.0 } else { 0.0 };
            // The fraction of a thousand times the number is as good as another random number.
            let value =
                |pixel: u32, u: f64| 0.7 + 0.6 * (1e3 * u).fract() + if u < chance { bright(pixel) } else { 0.0 };
            let [kept, found] = shares_of_renders(&value, &|pixel| 1.0 + chance * bright(pixel), samples);
            assert!(kept >= 0.95 && found > 0.2, "{pixels} pixels, {samples} samples: {kept} {found}");
        }
    }
}
