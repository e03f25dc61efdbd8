//! Light on its way into the sensor.

use super::first_lobe::FirstLobe;
use crate::light::LightId;
use crate::math::DVec3;

/// Light that reaches the sensor by one path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// The light it comes from; none where photons of several were gathered.
    pub(super) light: Option<LightId>,
    pub(super) found: FoundBy,
    /// How much, in the film's color space.
    pub(super) rgb: [f64; 3],
    /// How much of it polarization may change, as X + Y + Z.
    pub(super) moved: f64,
    /// How the first surface sent it to the camera, if layers tell that apart.
    pub(super) first: Option<FirstLobe>,
    /// How often surfaces scattered, mirrored or refracted it on its way.
    pub(super) bounces: u32,
    /// Whether its wavelengths parted on the way.
    pub(super) dispersed: bool,
}

/// The technique by which light was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FoundBy {
    /// A path hit the light: a surface, with its unit normal on the front, or none of a sky; and whether the direction
    /// was drawn where lights were sampled as well.
    Hit { normal: Option<DVec3>, scattered: bool },
    /// The light was sampled.
    Sampled,
    /// A path from the light was hit.
    Connected,
    /// Photons were gathered, or one was hit where it had landed.
    Gathered,
    /// A photon was shown to the camera.
    Splatted,
}

/// Adds a color to the numbers at the beginning of a row, or to another color.
pub(super) fn add(sums: &mut [f64], color: [f64; 3]) {
    for (sum, more) in sums.iter_mut().zip(color) {
        *sum += more;
    }
}
