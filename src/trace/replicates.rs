//! Replicates: renders of the same image that know nothing of each other, side by side.

use serde::{Deserialize, Serialize};

use crate::film::{Filter, PassSum, SampleWeights};

/// How many there are.
pub(super) const REPLICATES: usize = 8;
/// How many of them are the first half.
pub(super) const HALF: u32 = REPLICATES as u32 / 2;

/// What the replicates found in the pixels of a tile; empty where there is but one render.
///
/// Numbers of 32 bits do: sums of as many samples of each replicate are as wrong in all of them, and what is told of
/// them is how far they are apart.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Replicates {
    /// Of each pixel, the samples of each replicate.
    added: Vec<[Sum; REPLICATES]>,
    /// The same of samples that are subtracted; empty where the filter is nowhere negative.
    subtracted: Vec<[Sum; REPLICATES]>,
    /// What photons show, times the samples that they were sent beside; empty where none are sent.
    shown: Vec<[[f32; 3]; REPLICATES]>,
}

#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct Sum {
    rgb: [f32; 3],
    kept: u32,
}

impl Sum {
    fn add(&mut self, pass: &PassSum) {
        let rgb = pass.rgb();
        (0..3).for_each(|i| self.rgb[i] += rgb[i] as f32);
        self.kept += pass.kept();
    }
}

impl Replicates {
    /// Of so many pixels; some samples of theirs are subtracted, or none is.
    pub(super) fn new(pixels: usize, is_signed: bool) -> Self {
        let sums = |wanted: bool| if wanted { vec![[Sum::default(); REPLICATES]; pixels] } else { Vec::new() };
        Self { added: sums(true), subtracted: sums(is_signed), shown: Vec::new() }
    }

    /// Whether it has as many sums of each kind as another one, or none yet of what photons show.
    pub(super) fn is_shaped_as(&self, other: &Self) -> bool {
        let pixels = other.added.len();
        (self.added.len(), self.subtracted.len()) == (pixels, other.subtracted.len())
            && [0, pixels].contains(&self.shown.len())
    }

    /// Adds the samples of a pixel in one pass of a replicate: those that are added, and those that are subtracted.
    pub(super) fn add(&mut self, pixel: usize, replicate: u32, [added, subtracted]: [&PassSum; 2]) {
        let replicate = replicate as usize;
        self.added[pixel][replicate].add(added);
        if let Some(sums) = self.subtracted.get_mut(pixel) {
            sums[replicate].add(subtracted);
        }
    }

    /// Adds what photons of a replicate show in a pixel.
    pub(super) fn show(&mut self, pixel: usize, replicate: u32, rgb: [f64; 3]) {
        if self.shown.is_empty() {
            self.shown = vec![[[0.0; 3]; REPLICATES]; self.added.len()];
        }
        let sum = &mut self.shown[pixel][replicate as usize];
        (0..3).for_each(|i| sum[i] += rgb[i] as f32);
    }

    /// A pixel as each replicate has it, after so many samples of each.
    pub(super) fn pixel(&self, pixel: usize, filter: Filter, each: u32) -> [[f64; 3]; REPLICATES] {
        std::array::from_fn(|replicate| {
            let added = self.added[pixel][replicate];
            let subtracted = self.subtracted.get(pixel).map_or(Sum::default(), |sums| sums[replicate]);
            let shown = self.shown.get(pixel).map_or([0.0; 3], |shown| shown[replicate]);
            let weights = SampleWeights::new(filter, [added.kept, subtracted.kept]);
            let mean = |i: usize| weights.sum([added.rgb[i].into(), subtracted.rgb[i].into()]) / weights.taken();
            std::array::from_fn(|i| mean(i) + f64::from(shown[i]) / f64::from(each))
        })
    }

    /// The variance of a pixel's mean over all replicates, after so many samples of each.
    pub(super) fn variance(&self, pixel: usize, filter: Filter, each: u32) -> [f64; 3] {
        let (replicates, count) = (self.pixel(pixel, filter, each), REPLICATES as f64);
        std::array::from_fn(|i| {
            let mean = replicates.iter().map(|rgb| rgb[i]).sum::<f64>() / count;
            replicates.iter().map(|rgb| (rgb[i] - mean) * (rgb[i] - mean)).sum::<f64>() / (count * (count - 1.0))
        })
    }
}
