//! Fluorescence on a path's way back: where it sees a dye's light, it goes on with what excites the dye.
//!
//! A dye's matrix has rank 1, so the sensor gets a product: what it would get of the dye as a lamp, by the path's lanes
//! between dye and camera, times how much light excites the dye, by its lanes between light and dye. The first factor
//! is kept here. For the second the path starts with new lanes, as from a sensor of its own. (Mojzik, Fichet & Wilkie
//! 2018, *Handling Fluorescence in a Uni-directional Spectral Path Tracer*, sample the matrix instead.)

use super::World;
use super::arrived::{Arrived, SourceId};
use crate::light::LightId;
use crate::spectrum::{Draw, Lanes, Wavelength};

/// What the sensor gets of a dye that a path has seen, and how the path goes on from there.
#[derive(Clone, Debug)]
pub(super) struct Excitation<const N: usize, P> {
    /// The dye whose light reaches the sensor.
    pub(super) source: SourceId,
    /// The lanes by which it arrives, for a brightness of 1; what they stand for, whether they parted, and how the path
    /// was polarized.
    pub(super) lanes: Lanes<N>,
    pub(super) seen_by: Draw<N>,
    pub(super) parted: bool,
    pub(super) polarization: P,
    /// The dye that the path's light excites: the same, or one whose light excites another.
    pub(super) dye: usize,
    /// What the path's lanes stand for on their way to the light.
    pub(super) draw: Draw<N>,
}

impl<const N: usize, P> Excitation<N, P> {
    /// How the sensor sees light that arrives at the dye in lanes.
    pub(super) fn seen<T>(&self, world: &World, arrived: &Arrived<N>, look: impl FnOnce(&Arrived<N>) -> T) -> T {
        let brightness = world.dyes.as_ref().map_or(0.0, |dyes| dyes.excited(self.dye, arrived));
        self.seen_of(brightness, look)
    }

    /// The brightness by a light of one wavelength.
    pub(super) fn worth(&self, world: &World, light: LightId, wavelength: &Wavelength) -> f64 {
        world.dyes.as_ref().map_or(0.0, |dyes| wavelength.worth(dyes.excitation(self.dye, light))[0])
    }

    /// How the sensor sees a brightness of the dye.
    pub(super) fn seen_of<T>(&self, brightness: f64, look: impl FnOnce(&Arrived<N>) -> T) -> T {
        let lanes = &(self.lanes * brightness as f32);
        look(&Arrived { source: self.source, draw: &self.seen_by, lanes, parted: self.parted })
    }
}
