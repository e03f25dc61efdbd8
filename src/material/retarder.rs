use std::f64::consts::TAU;

use super::polarizer::projected_axis;
use super::stack::PHASE_STEP;
use super::{Block, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// A wave plate: a sheet in which light polarized along its fast axis is ahead of light polarized across it. All light
/// passes straight through.
///
/// At oblique incidence the phase difference is taken to be that along the normal. Unlike a thick crystal, the sheet
/// splits no rays. If its axis is along the normal, neither polarization is ahead and nothing changes.
///
/// ```toml
/// retarder = { axis = [1, 1, 0], retardance = 90 }          # degrees at every wavelength: a quarter-wave plate
/// retarder = { axis = [1, 1, 0], retardation_nm = 137.5 }   # the same at 550 nm, and less where waves are longer
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Retarder {
    /// The fast axis in the object's space, of any length.
    pub axis: DVec3,
    /// How far light polarized along the fast axis is ahead.
    pub retardance: Retardance,
}

/// How far light polarized along the fast axis is ahead of light polarized across it.
#[derive(Clone, Copy, Debug)]
pub enum Retardance {
    /// In degrees, the same at every wavelength.
    Phase(f64),
    /// As a length.
    Path(PathDifference),
}

/// The length by which one wave is ahead of another, equal at all wavelengths: the dispersion of birefringence is
/// neglected.
#[derive(Clone, Copy, Debug)]
pub struct PathDifference {
    /// In nm in vacuum, within -10^6 to 10^6.
    pub nm: f64,
}

impl PathDifference {
    /// Returns the block for light at a wavelength in nm, in a band of a relative width. If the phase changes by more
    /// than [`PHASE_STEP`] over the band, c and q are means over it, otherwise those of a single phase. A band of many
    /// orders is left unpolarized.
    pub fn block(self, wave @ [wavelength_nm, _]: [f64; 2]) -> Block<f64> {
        let block = Block::of_retarder(TAU * self.nm / wavelength_nm);
        let step = self.phase_step(wave);
        if step <= PHASE_STEP {
            return block;
        }
        let sinc = libm::sin(0.5 * step) / (0.5 * step);
        Block { c: sinc * block.c, q: sinc * block.q, ..block }
    }

    /// Returns the difference of phase between the two ends of a band, in radians, from its wavelength in nm and
    /// relative width.
    pub fn phase_step(self, [wavelength_nm, band]: [f64; 2]) -> f64 {
        TAU * self.nm.abs() / wavelength_nm * band
    }
}

impl Retarder {
    /// Returns the share that passes straight through: all light.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        Straight { holes: Lanes::ZERO, panes: Lanes::ONE, polarization: 0.0 }
    }

    pub(super) fn mueller<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        let Some(axis) = projected_axis(context, self.axis) else { return mueller.set_unchanged(context.present) };
        let lanes = context.present.nonzero();
        match self.retardance {
            Retardance::Phase(degrees) => {
                let block = Block::of_retarder(degrees.to_radians());
                mueller.set_lanes(axis, lanes, |_| block);
            }
            Retardance::Path(path) => mueller.set_lanes(axis, lanes, |lane| path.block(context.wave(lane))),
        }
    }
}
