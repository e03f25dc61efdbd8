use super::polarizer::let_through;
use super::{Arrival, Block, Mueller, Straight};
use crate::math::{DVec3, Transform};
use crate::spectrum::Lanes;

/// A sheet in which light polarized along its fast axis is ahead of light across it: a wave plate. All light goes
/// straight on.
///
/// Light that meets it aslant is taken to be ahead by as much as along the normal. It splits no rays, as a thick
/// crystal does.
///
/// ```toml
/// retarder = { axis = [1, 1, 0], retardance = 90 }     # degrees at every wavelength: a quarter-wave plate
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Retarder {
    /// The fast axis in the object's space, of any length.
    pub axis: DVec3,
    /// By how much light along it is ahead, in degrees.
    pub retardance: f64,
}

impl Retarder {
    /// Turned with the object that it lies on.
    #[must_use]
    pub fn turned(self, map: &Transform) -> Self {
        Self { axis: map.vector(self.axis), ..self }
    }

    /// All light goes straight on.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        Straight { holes: Lanes::ZERO, panes: Lanes::ONE, polarization: 0.0 }
    }

    pub(super) fn mueller<const N: usize>(&self, arrival: &Arrival<N>) -> Mueller<N> {
        match let_through(arrival, self.axis) {
            Some(axis) => {
                let block = Block::of_retarder(self.retardance.to_radians());
                Mueller::of_lanes(axis, arrival.present, |_| block)
            }
            None => Mueller::unchanged(arrival.present),
        }
    }
}
