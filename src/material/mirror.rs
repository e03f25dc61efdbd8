use super::{Arrival, Block, Branch, Mueller};
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
    pub(super) fn scatter<const N: usize>(&self, arrival: &Arrival<N>) -> Branch<N> {
        Branch::mirrored(arrival, arrival.read(&self.reflectance), 0.0)
    }

    /// That of a perfect metal: handedness turns around.
    pub(super) fn mueller<const N: usize>(&self, arrival: &Arrival<N>, mueller: &mut Mueller<N>) {
        let share = arrival.read(&self.reflectance);
        let block = Block { a: share, d: Lanes::ZERO, c: share * -1.0, q: Lanes::ZERO };
        *mueller = Mueller { axis: arrival.wo.cross(arrival.normal), block, base: None };
    }
}
