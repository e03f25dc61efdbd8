//! Sends photons in batches.

use std::ops::Range;

use super::follow::{Photon, PhotonHit, Surfaces, follow_photon};
use crate::math::{BranchKey, Sampler};
use crate::trace::photon_targets::{PhotonTarget, PhotonTargets};
use crate::trace::stats::Stats;
use crate::trace::walk::{Polarization, Walker};
use crate::trace::{Transport, World};

/// Photons of a batch, which are traced one after another. What they leave is added in the order of the batches.
const BATCH_SIZE: u64 = 4096;
/// Use of a photon's random numbers: its first ray.
const RAY: u32 = 0;

/// Photons are traced like camera paths: along all branches while they carry much, then along one. Splitting at 0.05
/// took as much time for the same noise; never splitting took 2 to 15 times as much (`benches/caustics.rs`).
pub const PHOTON_TRANSPORT: Transport = Transport::Random { split: 0.25, roulette: 0.05 };

/// A part of a target's photons.
#[derive(Clone, Copy)]
pub struct Batch {
    pub target: usize,
    pub first: u64,
    pub count: u64,
    pub seed: u64,
}

pub struct SentBatch<T> {
    pub records: Vec<T>,
    /// Where each photon was sent and whether anything was kept of it.
    pub outcomes: Vec<([f64; 2], bool)>,
    pub stats: Stats,
}

/// The callback that decides what is kept of a photon that lands.
type LandCallback<'a, const N: usize, P, T> = dyn Fn(&Walker<N, P>, &PhotonHit<N, P>, &mut Vec<T>) + 'a;

/// Splits all photons to some targets into batches. Their numbers follow those of the first `before` passes.
pub fn batches_of_pass(targets: &PhotonTargets, before: u64, seed: u64) -> Vec<Batch> {
    batches(targets, |target| before * target.photons..(before + 1) * target.photons, seed)
}

/// Splits those photons of each target that have the given numbers into batches.
pub fn batches(targets: &PhotonTargets, numbers: impl Fn(&PhotonTarget) -> Range<u64>, seed: u64) -> Vec<Batch> {
    let target_batches = |(target, of): (usize, &PhotonTarget)| {
        let numbers = numbers(of);
        let end = numbers.end;
        let batch = move |first: u64| Batch { target, first, count: BATCH_SIZE.min(end - first), seed };
        numbers.step_by(BATCH_SIZE as usize).map(batch)
    };
    targets.targets.iter().enumerate().flat_map(target_batches).collect()
}

/// Traces the photons of one batch; `land` decides what is kept of each that lands. If `learns`, only records for which
/// photons something would be kept.
pub fn trace_batch<const N: usize, P: Polarization<N>, T>(
    world: &World,
    targets: &PhotonTargets,
    batch: Batch,
    learns: bool,
    land: &LandCallback<N, P, T>,
) -> SentBatch<T> {
    let mut walker = Walker::<N, P>::new(world, PHOTON_TRANSPORT);
    let (mut records, mut outcomes) = (Vec::new(), Vec::new());
    let target = &targets.targets[batch.target];
    let light = target.light;
    // Directions and wavelengths matter more than where on a small lamp photons start, so they get the best numbers.
    let is_extended = world.scene.lights[light].is_extended();
    for number in batch.first..batch.first + batch.count {
        let key = [batch.target as u32, (number >> 32) as u32];
        let sampler = Sampler::new(batch.seed, key, number as u32);
        let u = sampler.get_4d(BranchKey::CAMERA, RAY);
        let u_extended = if is_extended { sampler.get_more_4d(BranchKey::CAMERA, RAY)[0] } else { 0.0 };
        let guide_uv = target.guide.sample([u[0], u[1]]);
        let before = records.len();
        if let Some(emitted) = targets.sample_le(&world.scene, batch.target, guide_uv, [u[3], u_extended]) {
            let draw = world.method.basis.draw(u[2]);
            let (draw, sampler, scope) = (&draw, &sampler, Surfaces::Smooth);
            let first_half = number < target.photons / 2;
            let photon = Photon { emitted: &emitted, light, draw, sampler, scope, first_half };
            follow_photon(&mut walker, &photon, &mut |walker, photon_hit| land(walker, photon_hit, &mut records));
        }
        if learns {
            outcomes.push((guide_uv, records.len() > before));
            records.clear();
        }
    }
    SentBatch { records, outcomes, stats: walker.stats }
}
