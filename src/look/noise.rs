use smallvec::SmallVec;

use super::significance::{normal_equivalent, sidak_threshold};
use crate::film::{Channel, ExrFile, ExrLayer, TELL_VARIANCE};

/// Probability with which two images of the same thing are said to differ.
pub(super) const FAMILY: f64 = 0.01;
/// Values so near to each other are the same but for rounding, whatever their variance; in half floats, so near.
const ROUNDING: f64 = 1e-5;
const ROUNDING_OF_HALF: f64 = 1.0 / 1024.0;

/// Whether two images differ by more than their noise.
///
/// Of each value, z is the difference over its standard deviation sqrt(va + vb), by the `variance` layers of both
/// files. Where `samples.V`, `render/samples` or how many replicates there were says how little these rest on, z is the
/// normal number that is as improbable, by the degrees of freedom of Welch 1947. A variance that is negative or no
/// number counts as 0.
///
/// Few samples that happen to agree tell far too little: a variance counts as half the median of the pixel and those
/// around it, or more. Where all samples of a pixel are the same beside an edge, another one might have shown what a
/// neighbor shows: n of them tell the mean no better than to 1 / n of the difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// The z of either sign that all values together exceed by chance in 1 of 100 pairs of images.
    pub threshold: f64,
    /// The z that is farthest from 0.
    pub worst: f64,
    /// Its pixel, row by row, and the number of its channel.
    pub at: [usize; 2],
    /// How many values are beyond the threshold.
    pub beyond: usize,
    /// How many values without any variance in both images differ by more than rounding.
    pub changed: usize,
    /// The z of each channel's mean over the image.
    pub means: Vec<f64>,
}

/// What is needed of one image.
pub(super) struct Noisy<'f> {
    colors: Vec<&'f Channel>,
    variance: Vec<&'f Channel>,
    samples: Option<&'f Channel>,
    /// Samples of each pixel, if the file says so.
    taken: Option<f64>,
    /// Renders that the variance is of, where it is not that of samples.
    replicates: Option<f64>,
    /// Columns and rows.
    size: [usize; 2],
    rounding: f64,
}

impl<'f> Noisy<'f> {
    /// Of the colors of a file that says their variance, unless it says that too few samples tell it.
    pub(super) fn new(file: &'f ExrFile, beauty: &ExrLayer<'f>) -> Option<Self> {
        let said = |name: &str| file.attribute(name).and_then(|count| count.parse::<f64>().ok());
        let (taken, replicates) = (said("render/samples"), said("render/replicates"));
        if taken.is_some_and(|taken| taken < f64::from(TELL_VARIANCE)) {
            return None;
        }
        let layers = file.layers();
        let there = |name: &str| {
            let named = layers.iter().filter(move |layer| layer.name == name);
            named.into_iter().find(|layer| layer.part.bounds == beauty.part.bounds)
        };
        let variance = there("variance")?.color()?.to_vec();
        let samples = there("samples").and_then(|layer| layer.channels.first().copied());
        let (colors, size) = (beauty.color()?.to_vec(), beauty.part.bounds.size);
        let half = colors.iter().any(|channel| channel.kind() == "half");
        let rounding = if half { ROUNDING_OF_HALF } else { ROUNDING };
        Some(Self { colors, variance, samples, taken, replicates, size, rounding })
    }

    fn variance(&self, channel: usize, pixel: usize) -> f64 {
        // Not `clamp`, which would keep what is no number.
        self.variance[channel].at(pixel).max(0.0)
    }

    /// The variance of a pixel, or what stands in for it where few samples that happen to agree tell far too little:
    /// half the median around it, or where no sample differs from the others, that of one that shows what the most
    /// different neighbor does.
    fn variance_beside_neighbors(&self, channel: usize, pixel: usize) -> f64 {
        let told = self.variance(channel, pixel);
        let [columns, rows] = self.size;
        let [column, row] = [pixel % columns, pixel / columns];
        let beside = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let neighbors = beside(row, rows).flat_map(|y| beside(column, columns).map(move |x| y * columns + x));
        if told > 0.0 {
            let mut around: SmallVec<[f64; 9]> = neighbors.map(|other| self.variance(channel, other)).collect();
            let middle = around.len() / 2;
            return told.max(0.5 * *around.select_nth_unstable_by(middle, f64::total_cmp).1);
        }
        let Some(taken) = self.taken(pixel) else { return told };
        let value = self.colors[channel].at(pixel);
        let apart = neighbors.map(|other| (self.colors[channel].at(other) - value).abs());
        let apart = apart.filter(|apart| apart.is_finite()).fold(0.0, f64::max);
        (apart / taken) * (apart / taken)
    }

    /// The samples of a pixel, or of each on the average, where the file says so.
    pub(super) fn taken(&self, pixel: usize) -> Option<f64> {
        self.samples.map(|samples| samples.at(pixel)).or(self.taken).filter(|taken| *taken >= 1.0)
    }

    /// How many independent values beyond the first its variance rests on; endless where it is not said.
    fn freedom(&self, pixel: usize) -> f64 {
        let values = self.replicates.or_else(|| self.taken(pixel));
        values.map_or(f64::INFINITY, |values| (values - 1.0).max(1.0))
    }
}

/// The degrees of freedom of a sum of two variances. Welch 1947, *The Generalization of "Student's" Problem when
/// Several Different Population Variances are Involved*, equation 28.
fn freedom(variances: [f64; 2], of_each: [f64; 2]) -> f64 {
    let sum = variances[0] + variances[1];
    let parts: f64 = (0..2).map(|i| (variances[i] / sum) * (variances[i] / sum) / of_each[i]).sum();
    1.0 / parts
}

impl Noise {
    /// Of two images of one size; `is_left_out` tells pixels that are not compared.
    pub(super) fn new(noisy: [&Noisy; 2], is_left_out: impl Fn(usize) -> bool) -> Self {
        let rounding = noisy[0].rounding.max(noisy[1].rounding);
        let same = |a: f64, b: f64| (a - b).abs() <= rounding * a.abs().max(b.abs());
        let (channels, [columns, rows]) = (noisy[0].colors.len(), noisy[0].size);
        let (mut all, mut tests) = (Vec::new(), channels);
        let mut found = Self { threshold: 0.0, worst: 0.0, at: [0; 2], beyond: 0, changed: 0, means: Vec::new() };
        for channel in 0..channels {
            let (mut sums, mut variance) = ([0.0; 2], 0.0);
            for pixel in (0..columns * rows).filter(|pixel| !is_left_out(*pixel)) {
                let [a, b] = noisy.map(|noisy| noisy.colors[channel].at(pixel));
                let variances = noisy.map(|noisy| noisy.variance(channel, pixel));
                let both = variances[0] + variances[1];
                (sums, variance) = ([sums[0] + a, sums[1] + b], variance + both);
                tests += usize::from(both > 0.0);
                if same(a, b) {
                    continue;
                }
                let variances = noisy.map(|noisy| noisy.variance_beside_neighbors(channel, pixel));
                let both = variances[0] + variances[1];
                if both == 0.0 {
                    found.changed += 1;
                    continue;
                }
                let freedom = freedom(variances, noisy.map(|noisy| noisy.freedom(pixel)));
                let z = normal_equivalent((a - b) / both.sqrt(), freedom);
                all.push(z);
                if z.abs() > found.worst.abs() {
                    (found.worst, found.at) = (z, [pixel, channel]);
                }
            }
            let [a, b] = sums;
            found.means.push(if same(a, b) || variance == 0.0 { 0.0 } else { (a - b) / variance.sqrt() });
        }
        found.threshold = sidak_threshold(tests, FAMILY);
        found.beyond = all.iter().filter(|z| z.abs() > found.threshold).count();
        found
    }

    /// Whether nothing is beyond what chance makes.
    pub fn agrees(&self) -> bool {
        self.beyond == 0 && self.changed == 0 && self.means.iter().all(|z| z.abs() <= self.threshold)
    }
}
