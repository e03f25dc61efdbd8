//! Which paths end at random.

/// Number of surfaces after which a path follows one branch only, and roulette ends 1 in 1000 paths even without loss.
pub const LONG_PATH: u32 = 64;
/// Survival probability of paths that long. It is closer to 1 than light caught in a clear body needs to find its way
/// out, so that none comes out much brighter than it went in.
///
/// Beyond a thousand surfaces, the probability of ending is one over their number, so that brightness grows in
/// proportion to that number. Light that diffuses through angles, as in a dense body that is hardly rough, leaves after
/// n surfaces with a probability proportional to n^(-3/2). With an exponential factor, its noise would be unbounded.
const LONG_PATH_SURVIVAL: f64 = 0.999;
/// Number of surfaces after which light counts as caught, and ends with the same probability as just after `LONG_PATH`.
const CAUGHT_PATH: u32 = 30_000;
/// Smallest survival probability of a faint path, so that none comes back more than ten times brighter.
const MIN_SURVIVAL: f64 = 0.1;

/// Plays Russian roulette on the weight (Arvo & Kirk 1990). Returns the factor that makes up for the paths that end, or
/// `None` if this one ends.
///
/// `u` is called for a random number only if something is left to chance.
pub fn play_roulette(weight: f64, threshold: f64, vertices: u32, u: impl FnOnce() -> f64) -> Option<f64> {
    let mut chance = if weight < threshold { (weight / threshold).max(MIN_SURVIVAL) } else { 1.0 };
    if vertices >= LONG_PATH {
        let survival_by_length = if vertices < CAUGHT_PATH { 1.0 - 1.0 / f64::from(vertices) } else { 0.0 };
        chance = chance.min(LONG_PATH_SURVIVAL.max(survival_by_length));
    }
    (chance >= 1.0 || u() < chance).then_some(1.0 / chance)
}
