//! The one place where a basis chooses how many lanes travel together.

use crate::spectrum::{Basis, MAX_LANES};

/// Work that is done in N lanes.
pub(super) trait InLanes {
    /// What the work gives.
    type Output;
    /// Does the work.
    fn run<const N: usize>(self) -> Self::Output;
}

/// Does work in the narrowest compiled width that a basis fits into.
pub(super) fn in_lanes<W: InLanes>(basis: &Basis, work: W) -> W::Output {
    match basis.lanes() {
        0..=4 => work.run::<4>(),
        5..=16 => work.run::<16>(),
        17..=MAX_LANES => work.run::<MAX_LANES>(),
        lanes => unreachable!("no basis has {lanes} lanes"),
    }
}
