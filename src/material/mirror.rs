use super::{Block, Branch, Mueller, ScatterContext};
use crate::spectrum::{Lanes, Quantity, Table};

/// An ideal mirror on both sides.
///
/// ```toml
/// mirror = { reflectance = 0.95 }     # 1 if absent
/// ```
#[derive(Clone, Debug)]
pub struct Mirror<S> {
    /// Share of the arriving light that leaves again, the same at every angle.
    pub reflectance: S,
}

impl<S> Mirror<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Mirror<T> {
        Mirror { reflectance: convert(Quantity::Reflectance, &self.reflectance) }
    }
}

impl Mirror<Table> {
    pub(super) fn scatter<const N: usize>(&self, context: &ScatterContext<N>) -> Branch<N> {
        Branch::mirrored(context, context.read(&self.reflectance), 0.0)
    }

    /// Sets the Mueller matrix of a perfect metal, which reverses handedness.
    pub(super) fn mueller<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        let share = context.read(&self.reflectance);
        let block = Block { a: share, d: Lanes::ZERO, c: share * -1.0, q: Lanes::ZERO };
        *mueller = Mueller { axis: context.wo.cross(context.normal), block, base: None };
    }
}
