use std::f64::consts::TAU;

use super::polarizer::let_through;
use super::stack::PHASE_STEP;
use super::{Block, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// A sheet in which light polarized along its fast axis is ahead of light across it: a wave plate. All light goes
/// straight on.
///
/// Light that meets it aslant is taken to be ahead by as much as along the normal. It splits no rays, as a thick
/// crystal does. Where its axis is along the normal, neither direction is ahead and nothing changes.
///
/// ```toml
/// retarder = { axis = [1, 1, 0], retardance = 90 }          # degrees at every wavelength: a quarter-wave plate
/// retarder = { axis = [1, 1, 0], retardation_nm = 137.5 }   # the same at 550 nm, and less where waves are longer
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Retarder {
    /// The fast axis in the object's space, of any length.
    pub axis: DVec3,
    /// By how much light along it is ahead.
    pub retardance: Retardance,
}

/// By how much light along the fast axis is ahead of light across it.
#[derive(Clone, Copy, Debug)]
pub enum Retardance {
    /// In degrees, the same at every wavelength.
    Phase(f64),
    /// By a length.
    Path(PathDifference),
}

/// The length by which one wave is ahead of another, the same at all wavelengths: how birefringence changes with them
/// is left out.
#[derive(Clone, Copy, Debug)]
pub struct PathDifference {
    /// In nm in vacuum, within -10^6 to 10^6.
    pub nm: f64,
}

impl PathDifference {
    /// c and q of light of a wavelength in nm and the relative width of its band: those of one phase, or where it
    /// changes by more than [`PHASE_STEP`] over the band, the mean over it. A band of many orders is left unpolarized.
    pub fn block(self, wave @ [wavelength_nm, _]: [f64; 2]) -> Block<f64> {
        let block = Block::of_retarder(TAU * self.nm / wavelength_nm);
        let step = self.phase_step(wave);
        if step <= PHASE_STEP {
            return block;
        }
        let left = libm::sin(0.5 * step) / (0.5 * step);
        Block { c: left * block.c, q: left * block.q, ..block }
    }

    /// How much the phase differs between both ends of a band, in radians, for its wavelength in nm and relative width.
    pub fn phase_step(self, [wavelength_nm, band]: [f64; 2]) -> f64 {
        TAU * self.nm.abs() / wavelength_nm * band
    }
}

impl Retarder {
    /// All light goes straight on.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        Straight { holes: Lanes::ZERO, panes: Lanes::ONE, polarization: 0.0 }
    }

    pub(super) fn mueller<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        let Some(axis) = let_through(context, self.axis) else { return mueller.set_unchanged(context.present) };
        let lanes = context.present.not_zero();
        match self.retardance {
            Retardance::Phase(degrees) => {
                let block = Block::of_retarder(degrees.to_radians());
                mueller.set_lanes(axis, lanes, |_| block);
            }
            Retardance::Path(path) => mueller.set_lanes(axis, lanes, |lane| path.block(context.wave(lane))),
        }
    }
}
