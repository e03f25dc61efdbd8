//! How far a plan looks ahead.

/// Rays that one look ahead follows, about, if it has seen something by then. A plan looks some ten times, and a ray
/// takes half a microsecond to two: together they take a second or two, however many rays a path or a photon has.
pub const RAYS_OF_A_LOOK: u64 = 1 << 17;
