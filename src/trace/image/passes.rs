//! The order in which samples are taken.

use serde::{Deserialize, Serialize};

use super::layer_sums::SplatWeights;
use super::light_pass::LightPassProgress;
use super::noise::Measured;
use crate::trace::World;
use crate::trace::pass::{Pass, Stage};
use crate::trace::replicates::{HALF_REPLICATES, REPLICATES};
use crate::trace::stats::Stats;

/// Samples of each pixel in the first pass, if no photons are gathered; each later pass doubles them.
const FIRST_PASS: u32 = 16;

/// Samples of each pixel in the largest pass with light vertices, all of which are in memory at once. Where photons are
/// gathered, a pass lasts as long as its map.
const MAX_PASS_SAMPLES: u32 = 64;

/// How far a render is, except for the pixels that are ahead in a pass.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Progress {
    /// Camera samples of each pixel, and passes, that are done.
    pub samples: u32,
    pub passes: u32,
    /// The stage of the replicates, if there are any.
    pub(in crate::trace) stage: Stage,
    /// What the replicates showed when they last had the same number of samples each.
    pub measured: Option<Measured>,
    pub sending: LightPassProgress,
    /// Statistics of gathered photons, and of paths from the lights.
    pub(in crate::trace) gathered: Stats,
    pub gathered_photons: u64,
}

impl Progress {
    pub(in crate::trace) fn pass(&self, world: &World) -> Pass {
        if world.method.stop.is_some() {
            return self.stage.pass(world, self.passes, max_pass_samples(world));
        }
        let numbers = self.samples..end_of_pass(world, self.samples, self.passes);
        Pass::without_replicates(world, self.passes, numbers)
    }

    /// Returns the camera samples of each pixel after the next pass.
    pub fn end_of_pass(&self, world: &World) -> u32 {
        self.samples + self.pass(world).numbers.len() as u32
    }

    pub(in crate::trace) fn finish(&mut self, pass: &Pass) {
        let samples = pass.numbers.len() as u32;
        (self.samples, self.passes) = (self.samples + samples, self.passes + 1);
        if pass.replicate.is_some() {
            self.stage = self.stage.after_samples(samples);
            self.sending.batches = 0;
        }
    }

    /// Returns the number of samples of each pixel that the photons of each replicate stand for, where every pass sends
    /// some. Samples of the pass under way count in proportion to the photons it has sent.
    fn sent_samples(&self, world: &World) -> [f64; REPLICATES] {
        let mut sent_samples = std::array::from_fn(|replicate| f64::from(self.stage.samples_of(replicate as u32)));
        let pass = self.pass(world);
        if let Some(replicate) = pass.replicate {
            sent_samples[replicate as usize] += pass.numbers.len() as f64 * self.sending.sent_share(world, &pass);
        }
        sent_samples
    }

    /// Returns the weights of sums over photons in the image.
    pub fn splat_weights(&self, world: &World) -> SplatWeights {
        if world.method.stop.is_none() {
            return SplatWeights { image: 1.0, halves: [1.0; 2], samples: None };
        }
        let samples = self.sent_samples(world);
        let (first, second) = samples.split_at(HALF_REPLICATES as usize);
        let [all, first, second] = [&samples[..], first, second].map(|part| part.iter().sum::<f64>());
        let ratio = |share: f64, samples: f64| if samples > 0.0 { share / samples } else { 0.0 };
        let halves = [first, second].map(|half| ratio(0.5 * all, half));
        SplatWeights { image: ratio(1.0, all), halves, samples: Some(samples) }
    }

    /// Returns the camera samples of each pixel after the stage of all replicates.
    pub fn samples_after_stage(&self) -> u32 {
        (self.stage.before.saturating_add(self.stage.size)).saturating_mul(REPLICATES as u32)
    }

    /// Whether its numbers are consistent.
    pub fn is_consistent(&self, world: &World) -> bool {
        let unused = self.stage == Stage::default();
        if world.method.stop.is_some() { self.stage.is_possible_after(self.samples) } else { unused }
    }

    /// Whether a render of a world passes this point, so that all its sums are these.
    pub fn is_reached_by(&self, world: &World) -> bool {
        let samples = (0..self.passes).fold(0, |samples, pass| end_of_pass(world, samples, pass));
        samples == self.samples && samples <= world.method.samples
    }
}

/// Returns the most samples of a replicate in one pass: those that share a map, or light vertices in memory at once.
pub fn max_pass_samples(world: &World) -> u32 {
    let map = world.method.map().filter(|_| world.has_map());
    map.map_or(MAX_PASS_SAMPLES, |map| (world.method.samples / map.count).clamp(1, MAX_PASS_SAMPLES))
}

fn end_of_pass(world: &World, samples: u32, passes: u32) -> u32 {
    let all = world.method.samples;
    let end = match world.method.map().filter(|_| world.has_map()) {
        Some(map) => (u64::from(passes + 1) * u64::from(all) / u64::from(map.count)).min(all.into()) as u32,
        None if world.method.light_vertices => samples.saturating_add(samples.clamp(FIRST_PASS, MAX_PASS_SAMPLES)),
        None => samples.saturating_mul(2).max(FIRST_PASS),
    };
    end.min(all)
}
