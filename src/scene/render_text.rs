//! How the image is rendered, as the scene file says.

use std::ops::RangeInclusive;
use std::time::Duration;

/// How the image is rendered.
///
/// ```toml
/// [render]
/// samples = 256
/// seed = 0
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderText {
    /// The model of color: how spectra are carried.
    pub model: ModelText,
    /// Target relative error of the image, at which no more samples are taken. A third of it is the budget of the color
    /// model, the rest is noise.
    pub error: Option<f64>,
    /// Time limit of the render.
    pub time: Option<Duration>,
    /// Length of a scene unit in meters. Needed for the absorption of catalog glasses, and for intensities in absolute
    /// units.
    pub meters_per_unit: Option<f64>,
    /// Camera samples per pixel; with an error or a time, the maximum.
    pub samples: Option<u32>,
    /// Seed that selects another set of random numbers.
    pub seed: u64,
    /// Maximum number of times that light may leave a diffuse surface for another before it is gathered from the
    /// lights; no limit if absent.
    pub diffuse_bounces: Option<u32>,
    /// Maximum number of times that light may leave any surface, glass and mirrors included; no limit if absent.
    pub max_bounces: Option<u32>,
    /// Whether caustics may get a light pass of their own, which traces photons where the scene needs them.
    pub caustics: AutoText,
    /// Whether pixels may take more samples where there is more noise, and fewer elsewhere, if that reaches an equal
    /// error clearly sooner.
    pub adaptive: AutoText,
    /// Whether polarization is traced.
    pub polarization: PolarizationText,
    /// Whether only a part of the image is rendered. A part does not know the error of the whole, so all samples are
    /// taken.
    pub is_part: bool,
}

impl RenderText {
    /// The relative errors that may be requested.
    pub const ERRORS: RangeInclusive<f64> = 1e-6..=1.0;
}

/// Whether polarization is traced.
///
/// ```toml
/// render.polarization = "auto"     # "on", "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolarizationText {
    /// Where ignoring it would cause more than the tolerated error.
    #[default]
    Auto,
    /// Yes.
    On,
    /// No: light is treated as unpolarized at every surface.
    Off,
}

/// Whether a render may use other techniques where plain paths are slow.
///
/// ```toml
/// render.adaptive = "auto"     # "off"
/// render.caustics = "auto"     # "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AutoText {
    /// Where the plan finds that it pays off.
    #[default]
    Auto,
    /// No: all pixels take the same number of samples, and caustics are left to chance.
    Off,
}

/// How spectra are carried.
///
/// ```toml
/// render.model = "auto"     # "rgb", { bands = 16 }, "hero"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModelText {
    /// The cheapest model that is accurate enough for the scene.
    #[default]
    Auto,
    /// Three bands: red, green, blue.
    Rgb,
    /// A number of fixed wavelengths: 8, 12, 16 or 32.
    Bands(u32),
    /// Fixed wavelengths, and some that are drawn at random and part in dispersive glass.
    Hero,
}
