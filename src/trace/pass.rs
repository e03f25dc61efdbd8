//! One pass over the pixels, and the samples that it takes.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::World;
use super::photon_targets::PhotonTargets;
use super::replicates::{HALF_REPLICATES, REPLICATES};
use crate::math::derive_seed;

/// The samples that a pass takes of each pixel, and their random numbers.
#[derive(Clone, Debug)]
pub(super) struct Pass {
    /// Number of the pass, from 0.
    number: u32,
    /// Its samples in the sequence of its seed.
    pub(super) numbers: Range<u32>,
    /// The seed of camera samples and light vertices.
    pub(super) seed: u64,
    /// The replicate that the samples belong to, if there are replicates.
    pub(super) replicate: Option<u32>,
}

impl Pass {
    /// Returns a pass of a render without replicates.
    pub(super) fn without_replicates(world: &World, number: u32, numbers: Range<u32>) -> Self {
        Self { number, numbers, seed: world.method.seed, replicate: None }
    }

    /// Returns a pass of one replicate.
    pub(super) fn of_replicate(world: &World, number: u32, numbers: Range<u32>, replicate: u32) -> Self {
        Self { number, numbers, seed: derive_seed(world.method.seed, replicate.into()), replicate: Some(replicate) }
    }

    /// Returns a pass for a pilot that looks only at its photons.
    pub(super) fn for_photons_only(world: &World, number: u32) -> Self {
        Self::without_replicates(world, number, 0..0)
    }

    /// Returns the seed of its photons, and the number of earlier passes whose photons have that seed.
    pub(super) fn photon_seed(&self) -> (u64, u64) {
        match self.replicate {
            None => (self.seed, self.number.into()),
            Some(_) => (derive_seed(self.seed, self.numbers.start.into()), 0),
        }
    }

    /// Returns targets with the photons that this pass sends to them. Without replicates, these are all their photons.
    /// With replicates, these are `factor` as many, in proportion to the pass's share of the method's samples.
    pub(super) fn targets<'t>(&self, world: &World, targets: &'t PhotonTargets, factor: u32) -> Cow<'t, PhotonTargets> {
        let part = self.numbers.len() as f64 / f64::from(world.method.samples);
        match self.replicate {
            None => Cow::Borrowed(targets),
            Some(_) => Cow::Owned(targets.scaled(part * f64::from(factor))),
        }
    }

    /// Returns whether it belongs to the first half of all replicates; `None` without replicates.
    pub(super) fn is_in_first_half(&self) -> Option<bool> {
        self.replicate.map(|replicate| replicate < HALF_REPLICATES)
    }
}

/// A stage of a render in replicates, in which each replicate takes the same number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Stage {
    /// Samples of a pixel that each replicate had before it.
    pub(super) before: u32,
    /// Samples of a pixel that each replicate takes; 0 before this is known.
    pub(super) size: u32,
    /// The replicate whose turn it is, and the number of samples that it has taken.
    replicate: u32,
    taken: u32,
}

impl Stage {
    /// Returns the next pass, of at most `max_samples` samples.
    pub(super) fn pass(self, world: &World, number: u32, max_samples: u32) -> Pass {
        let start = self.before + self.taken;
        let end = self.before + self.size.min(self.taken + max_samples);
        Pass::of_replicate(world, number, start..end, self.replicate)
    }

    /// Returns the stage after more samples of the replicate whose turn it is.
    pub(super) fn after_samples(mut self, samples: u32) -> Self {
        self.taken += samples;
        if self.taken == self.size {
            (self.replicate, self.taken) = (self.replicate + 1, 0);
        }
        if self.replicate == REPLICATES as u32 {
            return Self { before: self.before + self.size, ..Self::default() };
        }
        self
    }

    /// Returns the samples of a pixel that a replicate has, without those of the pass in progress.
    pub(super) fn samples_of(self, replicate: u32) -> u32 {
        self.before
            + match replicate.cmp(&self.replicate) {
                Ordering::Less => self.size,
                Ordering::Equal => self.taken,
                Ordering::Greater => 0,
            }
    }

    /// Returns whether this is a possible stage after this number of samples of each pixel.
    pub(super) fn is_possible_after(self, samples: u32) -> bool {
        let Self { before, size, replicate, taken } = self;
        let each = |count: u32| u64::from(REPLICATES as u32) * u64::from(count);
        let taken_in_stage = u64::from(replicate) * u64::from(size) + u64::from(taken);
        each(before) + taken_in_stage == u64::from(samples)
            && replicate < REPLICATES as u32
            && (taken < size || size + taken == 0)
    }
}
