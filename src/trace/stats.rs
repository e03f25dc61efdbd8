use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

use super::density::Rate;

/// What happened to the rays of many samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Stats {
    /// Rays traced, without shadow rays.
    pub(super) rays: u64,
    /// Weight of the branches that deterministic transport did not follow.
    pub(super) dropped: f64,
    /// Weight of paths that were cut by bounce limits, or that hit more surfaces than any path should.
    pub(super) stopped: f64,
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
    pub(super) partings: u64,
    /// All light that was seen, as X + Y + Z.
    pub(super) light: f64,
    /// The largest amount of the light seen that polarization may have changed.
    pub(super) polarization: f64,
    /// Camera samples of deterministic transport that hit so many surfaces that they continued at random.
    pub(super) by_chance: u64,
    /// Surfaces at which a vertex of a light path was sampled.
    pub(super) resampled: u64,
    /// Values that were sent, splatted or stored and are not finite.
    pub(super) non_finite: u64,
}

impl Stats {
    /// Restores the counts that a second trace of the same camera sample must not add to.
    pub(super) fn count_once(&mut self, before: &Self) {
        let Self { dropped, stopped, by_chance, .. } = *before;
        (self.dropped, self.stopped, self.by_chance) = (dropped, stopped, by_chance);
    }

    /// Returns the stats of a pixel with this sampling rate: its light counts as much as that of any pixel.
    pub(super) fn of_pixel(self, rate: Rate) -> Self {
        let times = rate.times();
        Self { light: self.light / times, polarization: self.polarization / times, ..self }
    }
}

impl AddAssign for Stats {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.dropped += other.dropped;
        self.stopped += other.stopped;
        self.unmatched += other.unmatched;
        self.partings += other.partings;
        self.light += other.light;
        self.polarization += other.polarization;
        self.by_chance += other.by_chance;
        self.resampled += other.resampled;
        self.non_finite += other.non_finite;
    }
}
