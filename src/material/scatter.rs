use super::{Branch, Incoming, Lobes, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// What the tracer, and materials made of others, ask a material.
pub trait Scatter {
    /// In which ways light leaves it.
    fn lobes(&self) -> Lobes;

    /// The ways on, backward: adds them to `branches`. `u` are two random numbers.
    fn scatter<const N: usize>(&self, context: &ScatterContext<N>, u: [f64; 2], branches: &mut Vec<Branch<N>>);

    /// BSDF times the cosine for light from the unit vector `wi`, and the density with which `scatter` draws `wi`.
    ///
    /// None where only a delta distribution could send light that way.
    fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)>;

    /// What of BSDF times cosine, as `evaluate` answers it, is of diffuse lobes.
    fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N>;

    /// The share of the light that goes straight on and into the same media; none where nothing does. `scatter` leaves
    /// it out.
    fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Option<Straight<N>>;

    /// The largest degree |s - p| / (s + p) to which unpolarized light from the unit vector `wi` leaves polarized,
    /// where the material scatters it by a density of directions: by the facet that mirrors or refracts it, or the coat
    /// that it crosses.
    fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32;

    /// Makes `mueller` what becomes of the polarization of light that arrives, of which `scatter` and `evaluate` say
    /// how much leaves.
    fn mueller<const N: usize>(&self, context: &ScatterContext<N>, incoming: Incoming, mueller: &mut Mueller<N>);

    /// Makes `mueller` what becomes of the polarization of light that goes straight on, as `straight` says.
    fn mueller_of_straight<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>);
}
