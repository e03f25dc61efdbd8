//! The order in which samples are taken.

use serde::{Deserialize, Serialize};

use super::World;
use super::light_pass::Sending;
use super::stats::Stats;

/// Samples of each pixel in the first pass, where no photons are gathered; every other pass takes as many as were taken
/// before.
const FIRST_PASS: u32 = 16;

/// Samples of each pixel in the largest pass with light vertices, all of which are in memory at once.
const MOST_AT_ONCE: u32 = 64;

/// How far an image in the making is, but for the pixels that are ahead in a pass.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Progress {
    /// Camera samples of each pixel, and passes.
    pub(super) samples: u32,
    pub(super) passes: u32,
    pub(super) sending: Sending,
    /// Of photons that were gathered, and paths from the lights.
    pub(super) gathered: Stats,
    pub(super) gathered_photons: u64,
}

impl Progress {
    /// Camera samples of each pixel after the next pass.
    pub(super) fn end_of_pass(&self, world: &World) -> u32 {
        end_of_pass(world, self.samples, self.passes)
    }

    /// Whether a render of a world comes by here, so that all its sums are these.
    pub(super) fn is_on_the_way_of(&self, world: &World) -> bool {
        let samples = (0..self.passes).fold(0, |samples, pass| end_of_pass(world, samples, pass));
        samples == self.samples && samples <= world.method.samples
    }
}

fn end_of_pass(world: &World, samples: u32, passes: u32) -> u32 {
    let all = world.method.samples;
    let map = world.method.light_pass.as_ref().and_then(|pass| pass.map).filter(|_| world.has_map());
    let end = match map {
        Some(map) => (u64::from(passes + 1) * u64::from(all) / u64::from(map.count)).min(all.into()) as u32,
        None if world.method.light_vertices => samples.saturating_add(samples.clamp(FIRST_PASS, MOST_AT_ONCE)),
        None => samples.saturating_mul(2).max(FIRST_PASS),
    };
    end.min(all)
}
