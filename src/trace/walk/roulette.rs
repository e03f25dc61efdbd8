//! Which paths end by chance.

/// Surfaces after which a path follows one of its ways, and roulette ends even one without loss, 1 in 1000 times.
pub const LONG: u32 = 64;
/// How certain it is then that a path goes on: nearer to 1 than light caught in a clear body needs to find its way out,
/// so that none comes out much brighter than it went in.
///
/// Beyond a thousand surfaces it is one less in as many as there have been, so that brightness grows in proportion to
/// their number: light that diffuses through angles, as in a dense body that is hardly rough, leaves after n surfaces
/// as often as n^(-3/2), and with a factor that grew by a power its noise would have no bounds.
const SURE: f64 = 0.999;
/// Surfaces after which light counts as caught, and ends as after `LONG`.
const CAUGHT: u32 = 30_000;
/// The least likely that a faint path goes on, so that none comes back brighter than ten times.
const UNLIKELY: f64 = 0.1;

/// Russian roulette on the weight (Arvo & Kirk 1990): the factor that makes up for the paths that end, or none.
///
/// `u` is asked for a random number only where something is left to chance.
pub fn survival(weight: f64, roulette: f64, vertices: u32, u: impl FnOnce() -> f64) -> Option<f64> {
    let mut chance = if weight < roulette { (weight / roulette).max(UNLIKELY) } else { 1.0 };
    if vertices >= LONG {
        let surest = if vertices < CAUGHT { 1.0 - 1.0 / f64::from(vertices) } else { 0.0 };
        chance = chance.min(SURE.max(surest));
    }
    (chance >= 1.0 || u() < chance).then_some(1.0 / chance)
}
