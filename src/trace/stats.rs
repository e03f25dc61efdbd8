use std::ops::AddAssign;

use serde::{Deserialize, Serialize};

use super::density::Rate;

/// What happened to the rays of many samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Stats {
    /// Rays followed, without those to lights.
    pub(super) rays: u64,
    /// Weight of the branches that deterministic transport did not follow.
    pub(super) dropped: f64,
    /// Weight of paths that were cut by limits of bounces, or hit more surfaces than any path should.
    pub(super) stopped: f64,
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
    pub(super) partings: u64,
    /// All light that was seen, as X + Y + Z.
    pub(super) light: f64,
    /// Most of it that polarization may have changed.
    pub(super) polarization: f64,
    /// Camera samples of deterministic transport that hit so many surfaces that they went on by chance.
    pub(super) by_chance: u64,
    /// Surfaces from which a vertex of a light path was looked at.
    pub(super) resampled: u64,
    /// What was sent, showed or kept and is not finite.
    pub(super) non_finite: u64,
}

impl Stats {
    /// Forgets what a second look at the same camera sample has counted of it.
    pub(super) fn count_once(&mut self, before: &Self) {
        let Self { dropped, stopped, by_chance, .. } = *before;
        (self.dropped, self.stopped, self.by_chance) = (dropped, stopped, by_chance);
    }

    /// Those of a pixel that takes more samples or fewer: light counts as much as that of any pixel.
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
