//! Which paths end by chance.

/// Surfaces after which roulette ends even a path that loses nothing, one time in a thousand.
const LONG: u32 = 64;
/// The most certain that a long path is to go on: nearer to 1 than light caught in a clear body needs to find its way out,
/// so that none comes out much brighter than it went in.
const SURE: f64 = 0.999;
/// The least likely that a faint path goes on, so that none comes back brighter than ten times.
const UNLIKELY: f64 = 0.1;

/// Russian roulette on the weight (Arvo & Kirk 1990): the factor that makes up for the paths that end, or none.
///
/// `u` is asked for a random number only where something is left to chance.
pub(super) fn survival(weight: f64, roulette: f64, vertices: u32, u: impl FnOnce() -> f64) -> Option<f64> {
    let mut chance = if weight < roulette { (weight / roulette).max(UNLIKELY) } else { 1.0 };
    if vertices >= LONG {
        chance = chance.min(SURE);
    }
    (chance >= 1.0 || u() < chance).then_some(1.0 / chance)
}
