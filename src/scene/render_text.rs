//! How the image is made, as the scene says.

/// How the image is made.
///
/// ```toml
/// [render]
/// samples = 256
/// seed = 0
/// ```
#[derive(Clone, Debug, Default)]
pub struct RenderText {
    /// How spectra are carried.
    pub model: ModelText,
    /// Relative error of the image that is wanted: a third of it is what the model of color may miss.
    pub error: Option<f64>,
    /// Length of a scene unit in meters: needed where a glass brings its own absorption.
    pub meters_per_unit: Option<f64>,
    /// Camera samples per pixel.
    pub samples: Option<u32>,
    /// Chooses another set of random numbers.
    pub seed: u64,
    /// How often light may leave a diffuse surface for another before it is gathered from the lights; no limit if
    /// absent.
    pub diffuse_bounces: Option<u32>,
    /// How often light may leave any surface, glass and mirrors included; no limit if absent.
    pub max_bounces: Option<u32>,
    /// Whether caustics may have a light pass of their own.
    pub caustics: CausticsText,
}

/// Whether caustics may have a light pass of their own.
///
/// ```toml
/// render.caustics = "auto"     # "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CausticsText {
    /// Photons, where the scene needs them.
    #[default]
    Auto,
    /// Left to chance.
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
