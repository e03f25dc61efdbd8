use std::f64::consts::TAU;

use super::polarizer::let_through;
use super::stack::PHASE_STEP;
use super::{Arrival, Block, Mueller, Straight};
use crate::math::{DVec3, Transform};
use crate::spectrum::{Lanes, Quantity, Table};

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
#[derive(Clone, Debug)]
pub struct Retarder<S> {
    /// The fast axis in the object's space, of any length.
    pub axis: DVec3,
    /// By how much light along it is ahead.
    pub retardance: Retardance<S>,
}

/// By how much light along the fast axis is ahead of light across it.
#[derive(Clone, Debug)]
pub enum Retardance<S> {
    /// In degrees, the same at every wavelength.
    Phase(f64),
    /// By a length.
    Path(PathDifference<S>),
}

/// The length by which one wave is ahead of another, the same at all wavelengths: how birefringence changes with them
/// is left out.
#[derive(Clone, Debug)]
pub struct PathDifference<S> {
    /// In nm in vacuum, within -10^6 to 10^6.
    pub nm: f64,
    /// 1, of which lanes read where they are,
    pub wavelength: S,
    /// and how wide their bands are.
    pub band: S,
}

impl<S> PathDifference<S> {
    /// Of so many nm; `one` is the number 1.
    pub fn new(nm: f64, one: impl Fn() -> S) -> Self {
        Self { nm, wavelength: one(), band: one() }
    }

    fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> PathDifference<T> {
        PathDifference {
            nm: self.nm,
            wavelength: convert(Quantity::Wavelength, &self.wavelength),
            band: convert(Quantity::BandWidth, &self.band),
        }
    }

    /// c and q of light of a wavelength in nm and the relative width of its band: those of one phase, or where it
    /// changes by more than [`PHASE_STEP`] over the band, the mean over it. A band of many orders is left unpolarized.
    pub fn block(&self, wavelength_nm: f64, band: f64) -> Block<f64> {
        let block = Block::of_retarder(TAU * self.nm / wavelength_nm);
        let step = self.phase_step(wavelength_nm, band);
        if step <= PHASE_STEP {
            return block;
        }
        let left = libm::sin(0.5 * step) / (0.5 * step);
        Block { c: left * block.c, q: left * block.q, ..block }
    }

    /// How much the phase differs between both ends of a band, in radians.
    pub fn phase_step(&self, wavelength_nm: f64, band: f64) -> f64 {
        TAU * self.nm.abs() / wavelength_nm * band
    }
}

impl<S> Retarder<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Retarder<T> {
        let retardance = match &self.retardance {
            Retardance::Phase(degrees) => Retardance::Phase(*degrees),
            Retardance::Path(difference) => Retardance::Path(difference.map(convert)),
        };
        Retarder { axis: self.axis, retardance }
    }

    /// All light goes straight on.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        Straight { holes: Lanes::ZERO, panes: Lanes::ONE, polarization: 0.0 }
    }
}

impl<S: Clone> Retarder<S> {
    /// Turned with the object that it lies on.
    #[must_use]
    pub fn turned(&self, map: &Transform) -> Self {
        Self { axis: map.vector(self.axis), ..self.clone() }
    }
}

impl Retarder<Table> {
    pub(super) fn mueller<const N: usize>(&self, arrival: &Arrival<N>, mueller: &mut Mueller<N>) {
        let Some(axis) = let_through(arrival, self.axis) else { return mueller.set_unchanged(arrival.present) };
        let lanes = arrival.present.not_zero();
        match &self.retardance {
            Retardance::Phase(degrees) => {
                let block = Block::of_retarder(degrees.to_radians());
                mueller.set_lanes(axis, lanes, |_| block);
            }
            Retardance::Path(path) => mueller.set_lanes(axis, lanes, |lane| {
                let read = |table| arrival.draw.read_lane(table, lane);
                path.block(read(&path.wavelength), read(&path.band))
            }),
        }
    }
}
