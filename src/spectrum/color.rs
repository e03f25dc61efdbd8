//! Film color spaces and the one transfer curve a picture for looking needs.

use palette::{LinSrgb, Srgb};
use serde::Deserialize;

/// A linear, scene-referred RGB space, by its Color Interop Forum identifier.
///
/// ```toml
/// film.color_space = "lin_rec709_scene"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
pub enum ColorSpace {
    /// Linear light on the Rec.709 (sRGB) primaries, white D65.
    #[default]
    #[serde(rename = "lin_rec709_scene")]
    Rec709,
}

/// CIE 1931 (x, y) of an RGB space's primaries and white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Primaries {
    /// Red primary.
    pub red: [f32; 2],
    /// Green primary.
    pub green: [f32; 2],
    /// Blue primary.
    pub blue: [f32; 2],
    /// White point.
    pub white: [f32; 2],
}

impl ColorSpace {
    /// The `colorInteropID` of the space.
    pub fn interop_id(self) -> &'static str {
        match self {
            Self::Rec709 => "lin_rec709_scene",
        }
    }

    /// Primaries and white: ITU-R BT.709-6, table 1.
    pub fn primaries(self) -> Primaries {
        match self {
            Self::Rec709 => {
                Primaries { red: [0.64, 0.33], green: [0.30, 0.60], blue: [0.15, 0.06], white: [0.3127, 0.3290] }
            }
        }
    }
}

/// Eight-bit sRGB of a linear Rec.709 color: clipped to 0..1, then encoded (IEC 61966-2-1).
pub fn encode_srgb(linear: [f32; 3]) -> [u8; 3] {
    let [red, green, blue] = linear.map(|x| x.clamp(0.0, 1.0));
    Srgb::<u8>::from_linear(LinSrgb::new(red, green, blue)).into()
}
