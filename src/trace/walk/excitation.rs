//! Fluorescence on a path's way back: where it sees a dye's light, it goes on with what excites the dye.
//!
//! A dye's matrix has rank 1, so the sensor gets a product: what it would get of the dye as a lamp, by the path's lanes
//! between dye and camera, times how much light excites the dye, by its lanes between light and dye. The first factor
//! is kept here. For the second the path starts with new lanes, as from a sensor of its own. (Mojzik, Fichet & Wilkie
//! 2018, *Handling Fluorescence in a Uni-directional Spectral Path Tracer*, sample the matrix instead.)

use crate::light::LightId;
use crate::spectrum::{Draw, Lanes, Wavelength};
use crate::trace::World;
use crate::trace::received_light::{ReceivedLight, SourceId};

/// What the sensor gets of a dye that a path has seen, and how the path goes on from there.
#[derive(Clone, Debug)]
pub struct Excitation<const N: usize, P> {
    /// The dye whose light reaches the sensor.
    pub source: SourceId,
    /// The lanes by which it arrives, for a brightness of 1; their meaning, whether they parted, and the polarization.
    pub lanes: Lanes<N>,
    pub seen_by: Draw<N>,
    pub parted: bool,
    pub polarization: P,
    /// The dye that the path's light excites: the same, or one whose light excites another.
    pub dye: usize,
    /// What the path's lanes stand for on their way to the light.
    pub draw: Draw<N>,
}

impl<const N: usize, P> Excitation<N, P> {
    /// How the sensor sees light that arrives at the dye in lanes.
    pub fn seen<T>(&self, world: &World, received: &ReceivedLight<N>, look: impl FnOnce(&ReceivedLight<N>) -> T) -> T {
        let brightness = world.dyes.as_ref().map_or(0.0, |dyes| dyes.excited(self.dye, received));
        self.seen_of(brightness, look)
    }

    /// The brightness by a light of one wavelength.
    pub fn worth(&self, world: &World, light: LightId, wavelength: &Wavelength) -> f64 {
        world.dyes.as_ref().map_or(0.0, |dyes| wavelength.worth(dyes.excitation(self.dye, light))[0])
    }

    /// How the sensor sees a brightness of the dye.
    pub fn seen_of<T>(&self, brightness: f64, look: impl FnOnce(&ReceivedLight<N>) -> T) -> T {
        let lanes = &(self.lanes * brightness as f32);
        look(&ReceivedLight { source: self.source, draw: &self.seen_by, lanes, parted: self.parted })
    }
}
