//! Light on its way into the sensor.

use super::first_lobe::FirstLobe;
use crate::light::LightId;
use crate::math::DVec3;

/// Light that reaches the sensor along one path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// The light that it comes from; `None` where photons of several lights were gathered.
    pub(super) light: Option<LightId>,
    pub(super) found: FoundBy,
    /// Its color in the film's color space.
    pub(super) rgb: [f64; 3],
    /// How much of it polarization may change, as X + Y + Z.
    pub(super) polarization_change: f64,
    /// The lobe by which the first surface sent it to the camera, if layers need that.
    pub(super) first: Option<FirstLobe>,
    /// Number of times that surfaces scattered, mirrored or refracted it on its way.
    pub(super) bounces: u32,
    /// Whether its wavelengths parted on the way.
    pub(super) dispersed: bool,
}

impl Contribution {
    /// Returns it with this factor on its light.
    pub fn scaled(self, factor: f64) -> Self {
        Self { rgb: self.rgb.map(|x| factor * x), polarization_change: factor * self.polarization_change, ..self }
    }
}

/// The technique by which light was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FoundBy {
    /// A path hit the light. `normal` is the unit normal on the front of a surface, `None` for a sky. `scattered` tells
    /// whether the direction was sampled where lights were sampled as well.
    Hit { normal: Option<DVec3>, scattered: bool },
    /// The light was sampled by next-event estimation.
    Sampled,
    /// The path was connected to a vertex of a light path.
    Connected,
    /// Photons were gathered, or the path was connected to the vertex where one had landed.
    Gathered,
    /// A photon was splatted.
    Splatted,
}

/// Adds a color to the first numbers of a row, or to another color.
pub(super) fn add(sums: &mut [f64], color: [f64; 3]) {
    for (sum, more) in sums.iter_mut().zip(color) {
        *sum += more;
    }
}
