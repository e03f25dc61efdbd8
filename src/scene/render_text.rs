//! How the image is made, as the scene says.

use std::ops::RangeInclusive;
use std::time::Duration;

/// How the image is made.
///
/// ```toml
/// [render]
/// samples = 256
/// seed = 0
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderText {
    /// How spectra are carried.
    pub model: ModelText,
    /// Relative error of the image at which it is good enough: a third of it is what the model of color may miss, the
    /// rest is noise. Then no more samples are taken.
    pub error: Option<f64>,
    /// How long it may render.
    pub time: Option<Duration>,
    /// Length of a scene unit in meters: needed where a glass brings its own absorption.
    pub meters_per_unit: Option<f64>,
    /// Camera samples per pixel; beside an error or a time, the most.
    pub samples: Option<u32>,
    /// Chooses another set of random numbers.
    pub seed: u64,
    /// How often light may leave a diffuse surface for another before it is gathered from the lights; no limit if
    /// absent.
    pub diffuse_bounces: Option<u32>,
    /// How often light may leave any surface, glass and mirrors included; no limit if absent.
    pub max_bounces: Option<u32>,
    /// Whether caustics may have a light pass of their own: photons, where the scene needs them.
    pub caustics: AutoText,
    /// Whether pixels may take more samples where the noise is, and fewer elsewhere: if an equal error comes clearly
    /// sooner.
    pub adaptive: AutoText,
    /// Whether polarization is traced.
    pub polarization: PolarizationText,
    /// Whether a part of the image is made, which does not know the error of the whole: then all samples are taken.
    pub is_part: bool,
}

impl RenderText {
    /// Relative errors that may be asked for.
    pub const ERRORS: RangeInclusive<f64> = 1e-6..=1.0;
}

/// Whether polarization is traced.
///
/// ```toml
/// render.polarization = "auto"     # "on", "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolarizationText {
    /// Where leaving it out would be wrong by more than is tolerated.
    #[default]
    Auto,
    /// Yes.
    On,
    /// No: light is taken for unpolarized at every surface.
    Off,
}

/// Whether a render may help itself where plain paths are slow.
///
/// ```toml
/// render.adaptive = "auto"     # "off"
/// render.caustics = "auto"     # "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AutoText {
    /// Where the plan finds that it pays.
    #[default]
    Auto,
    /// No: all pixels take as many samples, and caustics are left to chance.
    Off,
}

/// How spectra are carried.
///
/// ```toml
/// render.model = "auto"     # "rgb", { bands = 16 }, "hero"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModelText {
    /// The least that the scene needs.
    #[default]
    Auto,
    /// Three bands: red, green, blue.
    Rgb,
    /// As many fixed wavelengths: 8, 12, 16 or 32.
    Bands(u32),
    /// Fixed wavelengths, and some that are drawn and part in dispersive glass.
    Hero,
}
