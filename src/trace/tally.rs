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
    /// All light that was seen, as X + Y + Z.
    pub(super) light: f64,
    /// Most of it that polarization may have changed.
    pub(super) polarization: f64,
    /// Camera samples of deterministic transport that met so many surfaces that they went on by chance.
    pub(super) by_chance: u64,
}
