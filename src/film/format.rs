//! How an image is written.

use super::layers::{FirstSurface, Layer};
use crate::spectrum::WavelengthBands;

/// What a file holds beside the image, and how its numbers are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Format {
    /// Layers, in the order in which they were asked for.
    pub layers: Vec<Layer>,
    /// Which surface layers such as `N` and `albedo` are of.
    pub first: FirstSurface,
    /// Bits of a color.
    pub precision: Precision,
    /// How the numbers are packed.
    pub compression: Compression,
    /// Whether each layer is a part of its own.
    pub multipart: bool,
    /// The bands of the spectral image that is made beside it, if one is.
    pub spectral: Option<WavelengthBands>,
    /// Who owns the image.
    pub owner: Option<String>,
    /// What there is to say about it.
    pub comments: Option<String>,
}

/// Bits of a color. Depth, places and statistics always have 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Precision {
    /// 16 bits: three digits, up to 65504.
    Half,
    /// 32 bits.
    #[default]
    Float,
}

impl Precision {
    /// Both by their names in a scene file.
    pub const NAMES: [(&str, Self); 2] = [("half", Self::Half), ("float", Self::Float)];
}

/// How numbers are packed without losing a bit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compression {
    /// Not at all: the largest files, the fastest to write.
    None,
    /// Runs of equal bytes.
    Rle,
    /// Deflate, each row by itself.
    Zips,
    /// Deflate, 16 rows at a time.
    #[default]
    Zip,
    /// Wavelets: smaller for noisy images.
    Piz,
}

impl Compression {
    /// All by their names in a scene file.
    pub const NAMES: [(&str, Self); 5] =
        [("none", Self::None), ("rle", Self::Rle), ("zips", Self::Zips), ("zip", Self::Zip), ("piz", Self::Piz)];
}
