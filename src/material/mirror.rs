use super::{Arrival, Block, Branch, Mueller};
use crate::math::{DVec3, unit};
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
        Branch {
            wi: reflect(arrival.wo, arrival.normal),
            share: arrival.read(&self.reflectance),
            pdf: None,
            crosses: false,
            eta_scale: 1.0,
            polarization: 0.0,
        }
    }

    /// That of a perfect metal: handedness turns around.
    pub(super) fn mueller<const N: usize>(&self, arrival: &Arrival<N>, mueller: &mut Mueller<N>) {
        let share = arrival.read(&self.reflectance);
        let block = Block { a: share, d: Lanes::ZERO, c: share * -1.0, q: Lanes::ZERO };
        *mueller = Mueller { axis: arrival.wo.cross(arrival.normal), block, base: None };
    }
}

/// The mirror image of the unit vector `wo` about the unit `normal`, normalized so that bounces do not drift.
pub fn reflect(wo: DVec3, normal: DVec3) -> DVec3 {
    unit(normal * (2.0 * wo.dot(normal)) - wo)
}
