use super::{Branch, Incoming, Lobes, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// What the tracer, and materials made of others, need from a material.
pub trait Scatter {
    /// Returns the kinds of lobes in which light leaves it.
    fn lobes(&self) -> Lobes;

    /// Samples directions backward from the viewer and adds them to `branches`. `u` are two random numbers.
    fn scatter<const N: usize>(&self, context: &ScatterContext<N>, u: [f64; 2], branches: &mut Vec<Branch<N>>);

    /// Returns BSDF times cosine for light from the unit vector `wi`, and the density with which `scatter` draws `wi`.
    ///
    /// Returns None where only a delta distribution could scatter light from there.
    fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)>;

    /// Returns the part of BSDF times cosine, as returned by `evaluate`, that diffuse lobes contribute.
    fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N>;

    /// Returns the share of the light that passes straight through into the same media, or None if nothing does.
    /// `scatter` leaves this share out.
    fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Option<Straight<N>>;

    /// Returns the largest degree |s - p| / (s + p) to which unpolarized light from the unit vector `wi` leaves
    /// polarized, for directions that are drawn with a density. The degree is that of the facet that mirrors or
    /// refracts the light, or of the coat that the light crosses.
    fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32;

    /// Sets `mueller` to what the surface does to the polarization of arriving light; `scatter` and `evaluate`
    /// determine how much of it leaves.
    fn mueller<const N: usize>(&self, context: &ScatterContext<N>, incoming: Incoming, mueller: &mut Mueller<N>);

    /// Sets `mueller` to what the surface does to the polarization of light that passes straight through.
    fn mueller_of_straight<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>);
}
