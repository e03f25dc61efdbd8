//! Fluorescence, followed backward: where a path sees a dye's light, it continues with what excites the dye.
//!
//! A dye's matrix has rank 1, so the sensor receives a product. Its first factor is what the sensor would receive from
//! the dye as a lamp, by the path's lanes between dye and camera. The second is how much light excites the dye, by its
//! lanes between light and dye. The first factor is kept here. For the second, the path starts with new lanes, as if
//! from a sensor of its own. (Mojzik, Fichet & Wilkie 2018, *Handling Fluorescence in a Uni-directional Spectral Path
//! Tracer*, sample the matrix instead.)

use crate::light::LightId;
use crate::spectrum::{Draw, Lanes, Wavelength};
use crate::trace::World;
use crate::trace::received_light::{ReceivedLight, SourceId};

/// What the sensor receives from a dye that a path has seen, and how the path continues from there.
#[derive(Clone, Debug)]
pub struct Excitation<const N: usize, P> {
    /// The dye whose light reaches the sensor.
    pub source: SourceId,
    /// The lanes by which it arrives, for a brightness of 1; their meaning, whether they parted, and the polarization.
    pub lanes: Lanes<N>,
    pub sensor_draw: Draw<N>,
    pub parted: bool,
    pub polarization: P,
    /// The dye that the path's light excites: the source, or one whose light excites another dye.
    pub dye: usize,
    /// What the path's lanes stand for between the light and that dye.
    pub draw: Draw<N>,
}

impl<const N: usize, P> Excitation<N, P> {
    /// Calls `look` with what the sensor sees of light that arrives at the dye.
    pub fn with_received<T>(
        &self,
        world: &World,
        received: &ReceivedLight<N>,
        look: impl FnOnce(&ReceivedLight<N>) -> T,
    ) -> T {
        let brightness = world.dyes.as_ref().map_or(0.0, |dyes| dyes.brightness(self.dye, received));
        self.with_brightness(brightness, look)
    }

    /// Returns the brightness of the dye in light of one wavelength.
    pub fn brightness(&self, world: &World, light: LightId, wavelength: &Wavelength) -> f64 {
        world.dyes.as_ref().map_or(0.0, |dyes| wavelength.worth(dyes.excitation(self.dye, light))[0])
    }

    /// Calls `look` with what the sensor sees of the dye at a brightness.
    pub fn with_brightness<T>(&self, brightness: f64, look: impl FnOnce(&ReceivedLight<N>) -> T) -> T {
        let lanes = &(self.lanes * brightness as f32);
        look(&ReceivedLight { source: self.source, draw: &self.sensor_draw, lanes, parted: self.parted })
    }
}
