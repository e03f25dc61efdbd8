//! Replicates: statistically independent renders of the same image, side by side.

use serde::{Deserialize, Serialize};

use super::layers::CatcherLight;
use crate::film::{Filter, PassSum, SampleWeights};

/// Number of replicates.
pub const REPLICATES: usize = 8;
/// Number of replicates in the first half.
pub(super) const HALF_REPLICATES: u32 = REPLICATES as u32 / 2;

/// The sums of the replicates over the pixels of a tile; empty if there is only one render.
///
/// Numbers of 32 bits are enough. Sums of the same number of samples have similar rounding errors in all replicates,
/// and only the differences between replicates are used.
#[derive(Clone, Default, Serialize, Deserialize)]
pub(super) struct Replicates {
    light: ReplicateSums,
    /// How much gathered photons blur the light; empty if none are gathered.
    blur: ReplicateSums,
    /// Light that photons splat, times the number of samples that they were sent with; empty if none are sent.
    splatted: Vec<[[f32; 3]; REPLICATES]>,
    /// How much of each pixel is covered; empty unless shadow catchers add noise to that.
    covered: Vec<[CoverageSums; REPLICATES]>,
}

/// Sums over samples for the coverage of a pixel.
#[derive(Clone, Copy, Default, Serialize, Deserialize)]
struct CoverageSums {
    /// Samples that hit something, among those that are added and those that are subtracted.
    met: [u32; 2],
    /// Luminance of shadow catchers with all objects, with those of the plate alone, and number of samples that hit
    /// them.
    caught: [f32; 3],
    /// What photons add to the luminance with all objects, times the number of samples that they were sent with.
    splatted: f32,
}

impl CoverageSums {
    fn add(&mut self, samples: [&PassSum; 2], caught: CatcherLight<f64>) {
        (0..2).for_each(|lobe| self.met[lobe] += samples[lobe].met());
        let caught = [caught.with_objects, caught.without_objects, caught.share];
        (0..3).for_each(|i| self.caught[i] += caught[i] as f32);
    }

    /// Returns the alpha of a pixel by the weights of its samples, if photons were splatted for `sent_samples` samples.
    fn alpha(&self, weights: &SampleWeights, sent_samples: f64) -> f64 {
        let met = weights.sum(self.met.map(f64::from)) / weights.taken();
        let [with, without, share] = self.caught.map(|sum| f64::from(sum) / weights.added());
        let caught = CatcherLight {
            with_objects: with + f64::from(self.splatted) / sent_samples,
            without_objects: without,
            share,
        };
        (met.clamp(0.0, 1.0) + caught.coverage()).min(1.0)
    }
}

/// For each pixel, the sums of each replicate over the samples that are added, and over those that are subtracted. The
/// latter are empty if the filter is nowhere negative.
#[derive(Clone, Default, Serialize, Deserialize)]
struct ReplicateSums([Vec<[Sum; REPLICATES]>; 2]);

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

impl ReplicateSums {
    fn new(pixels: usize, is_signed: bool) -> Self {
        let sums = |wanted: bool| if wanted { vec![[Sum::default(); REPLICATES]; pixels] } else { Vec::new() };
        Self([true, is_signed].map(sums))
    }

    fn pixels(&self) -> usize {
        self.0[0].len()
    }

    fn has_same_shape(&self, other: &Self) -> bool {
        self.0.each_ref().map(Vec::len) == other.0.each_ref().map(Vec::len)
    }

    /// Adds the samples of a pixel that one pass of a replicate kept.
    fn add(&mut self, pixel: usize, replicate: u32, samples: [&PassSum; 2]) {
        for (sums, pass) in self.0.iter_mut().zip(samples) {
            if let Some(sums) = sums.get_mut(pixel) {
                sums[replicate as usize].add(pass);
            }
        }
    }

    /// Returns the sums of a pixel in a replicate: of samples that are added, and of those that are subtracted.
    fn sums_of(&self, pixel: usize, replicate: usize) -> [Sum; 2] {
        self.0.each_ref().map(|sums| sums.get(pixel).map_or(Sum::default(), |sums| sums[replicate]))
    }

    /// Returns the number of samples of a pixel that a replicate kept.
    fn kept(&self, pixel: usize, replicate: usize) -> u32 {
        self.sums_of(pixel, replicate).iter().map(|sum| sum.kept).sum()
    }

    /// Returns the weights of a pixel's samples in a replicate.
    fn weights(&self, pixel: usize, replicate: usize, filter: Filter) -> SampleWeights {
        SampleWeights::new(filter, self.sums_of(pixel, replicate).map(|sum| sum.kept))
    }

    /// Returns the mean of a pixel's samples in a replicate.
    fn mean(&self, pixel: usize, replicate: usize, filter: Filter) -> [f64; 3] {
        let (weights, [added, subtracted]) = (self.weights(pixel, replicate, filter), self.sums_of(pixel, replicate));
        std::array::from_fn(|i| weights.sum([added.rgb[i].into(), subtracted.rgb[i].into()]) / weights.taken())
    }
}

/// Sums over pixels of the products of what two replicates found.
#[derive(Default)]
pub(super) struct Products(pub(super) [[f64; REPLICATES]; REPLICATES]);

impl Products {
    /// Adds a pixel with `C` channels.
    pub(super) fn add<const C: usize>(&mut self, replicates: &[[f64; C]; REPLICATES]) {
        for (products, a) in self.0.iter_mut().zip(replicates) {
            for (product, b) in products.iter_mut().zip(replicates) {
                *product += a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            }
        }
    }

    /// Adds the sums of other pixels.
    pub(super) fn join(&mut self, other: &Self) {
        let sums = self.0.iter_mut().flatten();
        sums.zip(other.0.iter().flatten()).for_each(|(sum, more)| *sum += more);
    }
}

impl Replicates {
    /// Returns empty sums for some pixels, with subtracted samples, gathered photons and shadow catchers if needed.
    pub(super) fn new(pixels: usize, is_signed: bool, gathers: bool, catches: bool) -> Self {
        let blur = if gathers { ReplicateSums::new(pixels, is_signed) } else { ReplicateSums::default() };
        let covered = if catches { vec![[CoverageSums::default(); REPLICATES]; pixels] } else { Vec::new() };
        Self { light: ReplicateSums::new(pixels, is_signed), blur, splatted: Vec::new(), covered }
    }

    /// Returns the bytes of memory per pixel; `splats` tells whether photons are splatted.
    pub(super) fn bytes_of_pixel(is_signed: bool, gathers: bool, catches: bool, splats: bool) -> usize {
        let kinds = (1 + usize::from(is_signed)) * (1 + usize::from(gathers));
        let [catches, splats] = [catches, splats].map(usize::from);
        kinds * size_of::<[Sum; REPLICATES]>()
            + catches * size_of::<[CoverageSums; REPLICATES]>()
            + splats * size_of::<[[f32; 3]; REPLICATES]>()
    }

    /// Returns whether there are as many sums of each kind as in `other`; those of splatted photons may still be
    /// missing.
    pub(super) fn has_same_shape(&self, other: &Self) -> bool {
        self.light.has_same_shape(&other.light)
            && self.blur.has_same_shape(&other.blur)
            && [0, other.light.pixels()].contains(&self.splatted.len())
            && self.covered.len() == other.covered.len()
    }

    /// Adds the samples of a pixel from one pass of a replicate, and how much gathered photons blur them. Of both, the
    /// first are added, and the second are subtracted.
    pub(super) fn add(&mut self, pixel: usize, replicate: u32, samples: [&PassSum; 2], blurs: [&PassSum; 2]) {
        self.light.add(pixel, replicate, samples);
        self.blur.add(pixel, replicate, blurs);
    }

    /// Adds what photons of a replicate splat onto a pixel.
    pub(super) fn add_splat(&mut self, pixel: usize, replicate: u32, rgb: [f64; 3]) {
        if self.splatted.is_empty() {
            self.splatted = vec![[[0.0; 3]; REPLICATES]; self.light.pixels()];
        }
        let sum = &mut self.splatted[pixel][replicate as usize];
        (0..3).for_each(|i| sum[i] += rgb[i] as f32);
    }

    /// Adds the coverage of a pixel from one pass of a replicate, in which shadow catchers sent the luminance `caught`.
    pub(super) fn add_alpha(
        &mut self,
        pixel: usize,
        replicate: u32,
        samples: [&PassSum; 2],
        caught: CatcherLight<f64>,
    ) {
        self.covered[pixel][replicate as usize].add(samples, caught);
    }

    /// Adds the luminance that photons of a replicate splat onto shadow catchers in a pixel.
    pub(super) fn add_caught_splat(&mut self, pixel: usize, replicate: u32, luminance: f64) {
        self.covered[pixel][replicate as usize].splatted += luminance as f32;
    }

    /// Returns the alpha of a pixel in each replicate, after `each` samples of each; `None` without shadow catchers.
    pub(super) fn alpha(&self, pixel: usize, filter: Filter, each: u32) -> Option<[f64; REPLICATES]> {
        let alpha_of = |replicate: usize| {
            let weights = self.light.weights(pixel, replicate, filter);
            self.covered[pixel][replicate].alpha(&weights, each.into())
        };
        (!self.covered.is_empty()).then(|| std::array::from_fn(alpha_of))
    }

    /// Returns the color of a pixel in each replicate, after `each` samples of each.
    pub(super) fn pixel(&self, pixel: usize, filter: Filter, each: u32) -> [[f64; 3]; REPLICATES] {
        std::array::from_fn(|replicate| self.pixel_of(replicate, pixel, filter, each.into()))
    }

    /// Returns the color of a pixel in one replicate, whose photons were splatted for `sent_samples` samples.
    fn pixel_of(&self, replicate: usize, pixel: usize, filter: Filter, sent_samples: f64) -> [f64; 3] {
        let mean = self.light.mean(pixel, replicate, filter);
        let splatted = self.splatted.get(pixel).map_or([0.0; 3], |splatted| splatted[replicate]);
        let sent_samples = if sent_samples > 0.0 { sent_samples } else { f64::INFINITY };
        std::array::from_fn(|i| mean[i] + f64::from(splatted[i]) / sent_samples)
    }

    /// Returns the blur of a pixel, as estimated by each replicate; `None` if no photons are gathered.
    pub(super) fn blur(&self, pixel: usize, filter: Filter) -> Option<[[f64; 3]; REPLICATES]> {
        let gathers = self.blur.pixels() > 0;
        gathers.then(|| std::array::from_fn(|replicate| self.blur.mean(pixel, replicate, filter)))
    }

    /// Returns the variance of a pixel's mean over all replicates that have begun; `None` while fewer than two have.
    /// `sent_samples` is the number of samples for which the photons of each replicate were splatted.
    pub(super) fn variance(&self, pixel: usize, filter: Filter, sent_samples: [f64; REPLICATES]) -> Option<[f64; 3]> {
        let started = (0..REPLICATES).filter(|&replicate| self.light.kept(pixel, replicate) > 0);
        let pixels: Vec<[f64; 3]> =
            started.map(|replicate| self.pixel_of(replicate, pixel, filter, sent_samples[replicate])).collect();
        let count = pixels.len() as f64;
        (count > 1.0).then(|| {
            std::array::from_fn(|i| {
                let mean = pixels.iter().map(|rgb| rgb[i]).sum::<f64>() / count;
                pixels.iter().map(|rgb| (rgb[i] - mean) * (rgb[i] - mean)).sum::<f64>() / (count * (count - 1.0))
            })
        })
    }
}
