use smallvec::SmallVec;

use super::significance::{normal_equivalent, sidak_threshold};
use crate::film::{Channel, ExrFile, ExrLayer, TELL_VARIANCE};

/// The probability of a false alarm: that two images of the same thing are said to differ.
pub(super) const FALSE_ALARM_RATE: f64 = 0.01;
/// The relative difference up to which values count as equal, whatever their variance, and the same for half floats.
const ROUNDING: f64 = 1e-5;
const ROUNDING_OF_HALF: f64 = 1.0 / 1024.0;

/// Whether two images differ by more than their noise.
///
/// For each value, z is the difference divided by its standard deviation sqrt(va + vb), taken from the `variance`
/// layers of both files. If `samples.V`, `render/samples` or the number of replicates shows how few values the
/// variances are estimated from, z is the equally improbable normal deviate, with the degrees of freedom of Welch 1947.
/// A variance that is negative or NaN counts as 0.
///
/// If few samples happen to agree, their variance is far too small. A variance therefore counts as at least half the
/// median over the pixel and its neighbors. If all samples of a pixel beside an edge are equal, another one might have
/// shown what a neighbor shows: n samples determine the mean only to 1 / n of the difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// The |z| that the largest of all values exceeds by chance in 1 of 100 pairs of images.
    pub threshold: f64,
    /// The z that is farthest from 0.
    pub worst: f64,
    /// The pixel with the worst z, counted row by row, and the index of its channel.
    pub worst_place: [usize; 2],
    /// The number of values beyond the threshold.
    pub beyond: usize,
    /// The number of values that have no variance in either image, but differ by more than rounding.
    pub changed: usize,
    /// The z of each channel's mean over the image.
    pub means: Vec<f64>,
}

/// The data that is needed from one image.
pub(super) struct NoisyImage<'f> {
    colors: Vec<&'f Channel>,
    variance: Vec<&'f Channel>,
    samples: Option<&'f Channel>,
    /// The number of samples per pixel, if the file states it.
    sample_count: Option<f64>,
    /// The number of renders from which the variance is estimated, if not from samples.
    replicates: Option<f64>,
    /// Columns and rows.
    size: [usize; 2],
    rounding: f64,
}

impl<'f> NoisyImage<'f> {
    /// Selects the colors of a file and their variance. Returns none if the file has no variance, or states that there
    /// were too few samples to estimate it.
    pub(super) fn new(file: &'f ExrFile, beauty: &ExrLayer<'f>) -> Option<Self> {
        let number_attribute = |name: &str| file.attribute(name).and_then(|count| count.parse::<f64>().ok());
        let (sample_count, replicates) = (number_attribute("render/samples"), number_attribute("render/replicates"));
        if sample_count.is_some_and(|sample_count| sample_count < f64::from(TELL_VARIANCE)) {
            return None;
        }
        let layers = file.layers();
        let find_layer = |name: &str| {
            let named = layers.iter().filter(move |layer| layer.name == name);
            named.into_iter().find(|layer| layer.part.bounds == beauty.part.bounds)
        };
        let variance = find_layer("variance")?.color()?.to_vec();
        let samples = find_layer("samples").and_then(|layer| layer.channels.first().copied());
        let (colors, size) = (beauty.color()?.to_vec(), beauty.part.bounds.size);
        let half = colors.iter().any(|channel| channel.kind() == "half");
        let rounding = if half { ROUNDING_OF_HALF } else { ROUNDING };
        Some(Self { colors, variance, samples, sample_count, replicates, size, rounding })
    }

    fn variance(&self, channel: usize, pixel: usize) -> f64 {
        // Not `clamp`, which would keep NaN.
        self.variance[channel].at(pixel).max(0.0)
    }

    /// Returns the variance of a pixel, or a substitute if few samples happen to agree and it is far too small: half
    /// the median around the pixel, or, if all samples are equal, the variance if one sample showed what the most
    /// different neighbor shows.
    fn robust_variance(&self, channel: usize, pixel: usize) -> f64 {
        let own_variance = self.variance(channel, pixel);
        let [columns, rows] = self.size;
        let [column, row] = [pixel % columns, pixel / columns];
        let neighborhood = |index: usize, count: usize| index.saturating_sub(1)..(index + 2).min(count);
        let neighbors =
            neighborhood(row, rows).flat_map(|y| neighborhood(column, columns).map(move |x| y * columns + x));
        if own_variance > 0.0 {
            let mut variances: SmallVec<[f64; 9]> = neighbors.map(|other| self.variance(channel, other)).collect();
            let middle = variances.len() / 2;
            return own_variance.max(0.5 * *variances.select_nth_unstable_by(middle, f64::total_cmp).1);
        }
        let Some(sample_count) = self.sample_count(pixel) else { return own_variance };
        let value = self.colors[channel].at(pixel);
        let difference = neighbors.map(|other| (self.colors[channel].at(other) - value).abs());
        let difference = difference.filter(|difference| difference.is_finite()).fold(0.0, f64::max);
        (difference / sample_count) * (difference / sample_count)
    }

    /// Returns the number of samples of a pixel, or else the average number per pixel, if the file states it.
    pub(super) fn sample_count(&self, pixel: usize) -> Option<f64> {
        self.samples.map(|samples| samples.at(pixel)).or(self.sample_count).filter(|sample_count| *sample_count >= 1.0)
    }

    /// Returns how many independent values beyond the first the variance rests on. Infinite if that is not stated.
    fn freedom(&self, pixel: usize) -> f64 {
        let values = self.replicates.or_else(|| self.sample_count(pixel));
        values.map_or(f64::INFINITY, |values| (values - 1.0).max(1.0))
    }
}

/// Returns the degrees of freedom of a sum of two variances. Welch 1947, *The Generalization of "Student's" Problem
/// when Several Different Population Variances are Involved*, equation 28.
fn freedom(variances: [f64; 2], of_each: [f64; 2]) -> f64 {
    let sum = variances[0] + variances[1];
    let parts: f64 = (0..2).map(|i| (variances[i] / sum) * (variances[i] / sum) / of_each[i]).sum();
    1.0 / parts
}

impl Noise {
    /// Compares two images of the same size, except for pixels that `is_left_out` excludes.
    pub(super) fn new(noisy: [&NoisyImage; 2], is_left_out: impl Fn(usize) -> bool) -> Self {
        let rounding = noisy[0].rounding.max(noisy[1].rounding);
        let is_equal = |a: f64, b: f64| (a - b).abs() <= rounding * a.abs().max(b.abs());
        let (channels, [columns, rows]) = (noisy[0].colors.len(), noisy[0].size);
        let (mut all, mut tests) = (Vec::new(), channels);
        let mut found =
            Self { threshold: 0.0, worst: 0.0, worst_place: [0; 2], beyond: 0, changed: 0, means: Vec::new() };
        for channel in 0..channels {
            let (mut sums, mut variance) = ([0.0; 2], 0.0);
            for pixel in (0..columns * rows).filter(|pixel| !is_left_out(*pixel)) {
                let [a, b] = noisy.map(|noisy| noisy.colors[channel].at(pixel));
                let variances = noisy.map(|noisy| noisy.variance(channel, pixel));
                let total = variances[0] + variances[1];
                (sums, variance) = ([sums[0] + a, sums[1] + b], variance + total);
                tests += usize::from(total > 0.0);
                if is_equal(a, b) {
                    continue;
                }
                let variances = noisy.map(|noisy| noisy.robust_variance(channel, pixel));
                let total = variances[0] + variances[1];
                if total == 0.0 {
                    found.changed += 1;
                    continue;
                }
                let freedom = freedom(variances, noisy.map(|noisy| noisy.freedom(pixel)));
                let z = normal_equivalent((a - b) / total.sqrt(), freedom);
                all.push(z);
                if z.abs() > found.worst.abs() {
                    (found.worst, found.worst_place) = (z, [pixel, channel]);
                }
            }
            let [a, b] = sums;
            found.means.push(if is_equal(a, b) || variance == 0.0 { 0.0 } else { (a - b) / variance.sqrt() });
        }
        found.threshold = sidak_threshold(tests, FALSE_ALARM_RATE);
        found.beyond = all.iter().filter(|z| z.abs() > found.threshold).count();
        found
    }

    /// Returns whether nothing exceeds what chance makes.
    pub fn agrees(&self) -> bool {
        self.beyond == 0 && self.changed == 0 && self.means.iter().all(|z| z.abs() <= self.threshold)
    }
}
