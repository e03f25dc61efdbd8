use serde::{Deserialize, Serialize};

use super::image::{DEPTH_OF_NOTHING, Pixel, Sample};
use super::sample_weights::SampleWeights;

/// The number of samples that are summed sequentially before they enter the tree.
const BLOCK: u32 = 16;

/// The running sum of a pixel's samples in one pass, in 64-bit precision and a fixed order.
///
/// Aligned blocks of 16 samples are summed sequentially, and the blocks are the leaves of a binary tree. The error
/// therefore grows with the logarithm of the count.
#[derive(Clone, Debug, PartialEq)]
pub struct PassSum {
    block: Entry,
    /// Entry i, if present, is the sum of 2^i blocks.
    tree: Vec<Option<Entry>>,
    taken: u32,
    rejected: u32,
    nearest: f64,
}

/// The sum of a pixel's passes, in the order in which they were rendered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PixelSum {
    total: Entry,
    kept: u32,
    nearest: f64,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Entry {
    rgb: [f64; 3],
    met: u32,
}

impl Entry {
    fn plus(self, other: Self) -> Self {
        Self { rgb: std::array::from_fn(|i| self.rgb[i] + other.rgb[i]), met: self.met + other.met }
    }
}

impl Default for PassSum {
    fn default() -> Self {
        Self { block: Entry::default(), tree: Vec::new(), taken: 0, rejected: 0, nearest: f64::INFINITY }
    }
}

impl Default for PixelSum {
    fn default() -> Self {
        Self { total: Entry::default(), kept: 0, nearest: f64::INFINITY }
    }
}

impl PassSum {
    /// Adds the next sample and returns whether it was kept. A sample that is not finite is left out and counted.
    pub fn add(&mut self, sample: &Sample) -> bool {
        let finite = sample.rgb.iter().all(|x| x.is_finite());
        if finite {
            let one = Entry { rgb: sample.rgb, met: u32::from(sample.depth.is_some()) };
            self.block = self.block.plus(one);
            self.nearest = self.nearest.min(sample.depth.unwrap_or(f64::INFINITY));
        } else {
            self.rejected += 1;
        }
        self.taken += 1;
        if self.taken.is_multiple_of(BLOCK) {
            self.carry();
        }
        finite
    }

    /// Moves the finished block into the tree, with carries as in a binary counter.
    fn carry(&mut self) {
        let mut sum = std::mem::take(&mut self.block);
        for level in &mut self.tree {
            match level.take() {
                Some(earlier) => sum = earlier.plus(sum),
                None => {
                    *level = Some(sum);
                    return;
                }
            }
        }
        self.tree.push(Some(sum));
    }

    /// Returns the sum of the samples that were kept.
    pub fn rgb(&self) -> [f64; 3] {
        self.total().rgb
    }

    /// Returns the number of samples that were kept.
    pub fn kept(&self) -> u32 {
        self.taken - self.rejected
    }

    /// Returns the number of samples that hit a surface.
    pub fn met(&self) -> u32 {
        self.total().met
    }

    fn total(&self) -> Entry {
        self.tree.iter().flatten().fold(self.block, |sum, entry| entry.plus(sum))
    }
}

impl PixelSum {
    /// Adds a pass.
    pub fn add(&mut self, pass: PassSum) {
        self.total = self.total.plus(pass.total());
        self.kept += pass.kept();
        self.nearest = self.nearest.min(pass.nearest);
    }

    /// Returns the sum of the samples that were kept.
    pub fn rgb(&self) -> [f64; 3] {
        self.total.rgb
    }

    /// Returns the number of samples that were kept.
    pub fn kept(&self) -> u32 {
        self.kept
    }

    /// Returns the pixel: the mean over the samples that were kept, including the subtracted ones, plus `extra`, light
    /// that is already a mean. The depth is that of the added samples.
    pub fn pixel(&self, subtracted: &Self, weights: &SampleWeights, extra: [f64; 3]) -> Pixel {
        let mean = |value: &dyn Fn(&Self) -> f64| weights.sum([value(self), value(subtracted)]) / weights.taken();
        Pixel {
            rgb: std::array::from_fn(|i| stored(mean(&|sum| sum.total.rgb[i]) + extra[i])),
            alpha: mean(&|sum| sum.total.met.into()).clamp(0.0, 1.0) as f32,
            depth: if self.nearest.is_finite() { stored(self.nearest) } else { DEPTH_OF_NOTHING },
            samples: weights.kept() as f32,
        }
    }
}

/// Converts a number for storage. Values beyond the range of f32 become the largest finite one, because EXR readers
/// choke on infinities.
pub fn stored(number: f64) -> f32 {
    (number as f32).clamp(f32::MIN, f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::super::filter::Filter;
    use super::*;

    fn sample(value: f64) -> Sample {
        Sample { rgb: [value; 3], depth: None, is_subtracted: false }
    }

    fn pixel(pass: PassSum) -> Pixel {
        let mut sum = PixelSum::default();
        sum.add(pass);
        let weights = SampleWeights::new(Filter::Box, [sum.kept(), 0]);
        sum.pixel(&PixelSum::default(), &weights, [0.0; 3])
    }

    /// Row A1 of the stability catalog.
    #[test]
    fn a1_the_mean_of_many_samples_keeps_nine_digits() {
        let count = 1u32 << 24;
        let (mut sum, mut exact, mut lost) = (PassSum::default(), 0.0, 0.0);
        for i in 0..count {
            let value = 0.1 + f64::from(i % 1013) * 1e-4;
            sum.add(&sample(value));
            let y: f64 = value - lost;
            let t: f64 = exact + y;
            lost = (t - exact) - y;
            exact = t;
        }
        assert!((sum.total().rgb[0] / exact - 1.0).abs() <= 1e-9);
        assert!((f64::from(pixel(sum).rgb[0]) / (exact / f64::from(count)) - 1.0).abs() <= 1e-7);
    }

    /// Row A2 of the stability catalog.
    #[test]
    fn a2_dim_samples_after_a_bright_one_all_count() {
        let mut sum = PassSum::default();
        sum.add(&sample(1e9));
        (0..1000).for_each(|_| {
            sum.add(&sample(1.0));
        });
        assert_eq!(sum.total().rgb[0], 1e9 + 1000.0);
    }

    /// Row A5 of the stability catalog.
    #[test]
    fn a5_a_sample_that_is_not_finite_is_left_out_and_counted() {
        let mut sum = PassSum::default();
        assert!(sum.add(&sample(1.0)));
        assert!(!sum.add(&sample(f64::NAN)));
        assert!(!sum.add(&sample(f64::INFINITY)));
        assert!(sum.add(&sample(3.0)));
        assert_eq!(sum.rejected, 2);
        assert_eq!(pixel(sum).rgb, [2.0; 3]);
    }
}
