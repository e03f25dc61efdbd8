/// What happened to the rays of many samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tally {
    /// Rays followed, without those to lights.
    pub(super) rays: u64,
    /// Weight of the branches that deterministic transport did not follow.
    pub(super) dropped: f64,
    /// Weight of paths that met more surfaces than any path should.
    pub(super) stopped: f64,
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
    /// Surfaces at which lanes parted.
    pub(super) partings: u64,
    /// Bound of the weight that polarization would move: the sum of weight x |P_A P_B| over consecutive smooth surfaces.
    pub(super) polarization: f64,
}
