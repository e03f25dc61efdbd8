//! The one place where a basis chooses how many lanes travel together.

use crate::spectrum::Basis;

/// Work that is done in N lanes.
pub(super) trait InLanes {
    /// What the work gives.
    type Output;
    /// Does the work.
    fn run<const N: usize>(self) -> Self::Output;
}

/// Does work in the narrowest compiled width that a basis fits into.
pub(super) fn in_lanes<W: InLanes>(basis: &Basis, work: W) -> W::Output {
    match basis.len() {
        0..=4 => work.run::<4>(),
        bins => unreachable!("no basis has {bins} bins"),
    }
}
