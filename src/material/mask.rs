use super::{Branch, Incoming, Mueller, Part, Scatter, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::{Lanes, Table};

/// A material with holes, or one that is thinly spread: what it does not cover lets light pass straight through, as if
/// nothing were there.
///
/// ```toml
/// mask = { material = "leaf", opacity = 0.5 }
/// ```
#[derive(Clone, Debug)]
pub struct Mask<S, M> {
    /// The covering material, by name: one that reflects or transmits.
    pub material: Part<M>,
    /// Share of the light that meets the material, 0 to 1.
    pub opacity: S,
}

impl<M: Scatter> Mask<Table, M> {
    pub(super) fn scatter<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        u: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        let (opacity, first) = (context.read(&self.opacity), branches.len());
        self.material.material().scatter(context, u, branches);
        branches[first..].iter_mut().for_each(|branch| *branch = branch.scaled(opacity));
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let (light, pdf) = self.material.material().evaluate(context, wi)?;
        Some((light * context.read(&self.opacity), pdf))
    }

    pub(super) fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N> {
        self.material.material().diffuse_part(context, wi) * context.read(&self.opacity)
    }

    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        self.material.material().mueller(context, incoming, mueller);
        mueller.scale(context.read(&self.opacity));
    }

    /// Sets the Mueller matrix of light that passes straight through; holes leave its polarization unchanged.
    pub(super) fn mueller_of_straight<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        let (opacity, mut hole) = (context.read(&self.opacity), Mueller::NONE);
        hole.set_unchanged(Lanes::from_fn(|i| 1.0 - opacity[i]));
        self.material.material().mueller_of_straight(context, mueller);
        mueller.scale(opacity);
        mueller.add(&hole);
    }

    /// Returns the share that passes straight through.
    pub(super) fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Straight<N> {
        let opacity = context.read(&self.opacity);
        let within = self.material.material().straight(context).unwrap_or(Straight::NONE);
        // Computing 1 minus what is hit keeps full precision where everything passes through.
        let holes = Lanes::from_fn(|i| 1.0 - opacity[i] * (1.0 - within.holes[i]));
        Straight { holes, panes: within.panes * opacity, ..within }
    }
}
