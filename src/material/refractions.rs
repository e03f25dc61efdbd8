use super::{Branch, Interface, ScatterContext};
use crate::spectrum::Lanes;

/// The refracted branches of a smooth surface: one for each pair of indices by which rays are refracted, or a single
/// one if the lanes do not part.
pub(super) struct Refractions<'a, const N: usize> {
    context: &'a ScatterContext<'a, N>,
    parts: bool,
    branches: &'a mut Vec<Branch<N>>,
    /// Position of the first one, after the branches of other surfaces.
    first: usize,
    /// The pair of indices of each branch.
    pairs: [[f64; 2]; N],
}

impl<'a, const N: usize> Refractions<'a, N> {
    /// Starts without branches.
    pub(super) fn new(context: &'a ScatterContext<'a, N>, parts: bool, branches: &'a mut Vec<Branch<N>>) -> Self {
        let first = branches.len();
        Self { context, parts, branches, first, pairs: [[0.0; 2]; N] }
    }

    /// Returns the branch of a pair of indices; a new one starts without light. `interface` makes the boundary between
    /// them.
    pub(super) fn branch(&mut self, pair: [f64; 2], interface: impl FnOnce() -> Interface) -> &mut Branch<N> {
        let count = self.branches.len() - self.first;
        let existing = self.pairs[..count].iter().position(|other| !self.parts || *other == pair);
        let number = existing.unwrap_or_else(|| {
            let (ScatterContext { wo, normal, .. }, [here, beyond]) = (self.context, pair);
            let wi = if here == beyond { -*wo } else { interface().refract(*wo, *normal) };
            let (share, eta_scale) = (Lanes::ZERO, (here / beyond) * (here / beyond));
            self.branches.push(Branch { wi, share, pdf: None, crosses: true, eta_scale, polarization: 0.0 });
            self.pairs[count] = pair;
            count
        });
        &mut self.branches[self.first + number]
    }
}
