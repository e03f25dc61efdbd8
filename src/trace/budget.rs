//! How far a plan looks ahead.

/// Rough number of rays of one look ahead, if it has found something by then. A plan looks some ten times, and a ray
/// takes half a microsecond to two. All looks take a second or two together, however many rays a path or a photon has.
pub const RAYS_OF_A_LOOK: u64 = 1 << 17;
