//! The file format of an image.

use serde::{Deserialize, Serialize};

use super::layers::{FirstSurface, Layer};
use crate::spectrum::WavelengthBands;

/// What a file holds besides the image, and how its values are encoded.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Format {
    /// The layers, in the order in which they were requested.
    pub layers: Vec<Layer>,
    /// Whether the Stokes components stay among the layers even if other layers replace those of the scene.
    #[serde(skip)]
    pub stokes: bool,
    /// The surface that layers such as `N` and `albedo` describe.
    pub first: FirstSurface,
    /// The precision of colors.
    pub precision: Precision,
    /// The compression of the values.
    pub compression: Compression,
    /// Whether each layer is a part of its own. A lossy compression then applies to colors only, and everything else
    /// uses [`Compression::Zip`].
    pub multipart: bool,
    /// The bands of the additional spectral image, if there is one.
    pub spectral: Option<WavelengthBands>,
    /// The luminance in cd/m^2 of a pixel whose red, green and blue are 1, if the scene gives its lights in such units.
    pub white_luminance: Option<f64>,
    /// The owner of the image.
    pub owner: Option<String>,
    /// Comments on the image.
    pub comments: Option<String>,
    /// The frame rate of the sequence that the image belongs to: a number of frames, and the seconds that they take.
    pub frames_per_second: Option<[u32; 2]>,
}

/// The last components of the channel names that DWA compresses lossily (OpenEXR 3.3, ImfDwaCompressor.cpp).
const DWA_COLOR_CHANNELS: [&str; 6] = ["R", "G", "B", "Y", "BY", "RY"];

impl Format {
    /// Requests layers in place of the present ones.
    pub fn ask_for(&mut self, layers: &[Layer]) {
        self.layers = layers.to_vec();
        let stokes = Layer::STOKES.into_iter().filter(|layer| self.stokes && !layers.contains(layer));
        self.layers.extend(stokes);
    }

    /// Returns whether any polarization layer is requested.
    pub fn has_stokes(&self) -> bool {
        self.layers.iter().copied().any(Layer::is_of_polarization)
    }

    /// Returns why no file can hold this combination, and what to do instead, if that is so.
    ///
    /// Everything except color must be stored exactly: a depth, a normal or a matte ID that is nearly right is wrong.
    pub fn objection(&self) -> Option<(String, String)> {
        let name = self.compression.name();
        if self.compression.is_of_16_bits() && self.precision == Precision::Float {
            let message = format!("the compression {name} holds colors in 16 bits, not in 32");
            return Some((message, "write precision = \"half\", or compression = \"zip\"".into()));
        }
        if !self.compression.is_lossy() || self.multipart {
            return None;
        }
        // DWA recognizes colors by their channel names and compresses all else, such as depth, without loss. PXR24
        // rounds all 32-bit values.
        let is_dwa = self.compression.is_of_16_bits();
        let depth = Some("Z").filter(|_| !is_dwa);
        let looks_like_color = |layer: &Layer| layer.channels().iter().any(|name| DWA_COLOR_CHANNELS.contains(name));
        let is_spoiled = |layer: &&Layer| !layer.is_color() && (!is_dwa || looks_like_color(layer));
        let layers = self.layers.iter().filter(is_spoiled).map(|layer| layer.name());
        let spoiled: Vec<&str> = depth.into_iter().chain(layers).collect();
        (!spoiled.is_empty()).then(|| {
            let message = format!("the compression {name} alters data that must stay exact: {}", spoiled.join(", "));
            let help = "write multipart = true, which stores it without loss in parts of its own";
            (message, format!("{help}; or compression = \"piz\""))
        })
    }
}

/// The precision of colors. Depth, positions and statistics always have 32 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Precision {
    /// 16 bits: three significant digits, values up to 65504.
    Half,
    /// 32 bits.
    #[default]
    Float,
}

impl Precision {
    /// Both precisions by their names in a scene file.
    pub const NAMES: [(&str, Self); 2] = [("half", Self::Half), ("float", Self::Float)];
}

/// The compression of the values. It is lossless unless stated otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Compression {
    /// No compression: the largest files, and the fastest to write.
    None,
    /// Run-length encoding of bytes.
    Rle,
    /// Deflate, one row at a time.
    Zips,
    /// Deflate, 16 rows at a time.
    #[default]
    Zip,
    /// Wavelets. Files of noisy images are smaller.
    Piz,
    /// Rounds 32-bit values to 24 bits, an error of one part in 65 536 or less. 16-bit values stay as they are.
    Pxr24,
    /// A cosine transform of 8 x 8 pixels, 32 rows at a time. Colors have 16 bits and look nearly the same, in the
    /// smallest files.
    Dwaa,
    /// Like `Dwaa`, but 256 rows at a time.
    Dwab,
}

impl Compression {
    /// All compressions by their names in a scene file.
    pub const NAMES: [(&str, Self); 8] = [
        ("none", Self::None),
        ("rle", Self::Rle),
        ("zips", Self::Zips),
        ("zip", Self::Zip),
        ("piz", Self::Piz),
        ("pxr24", Self::Pxr24),
        ("dwaa", Self::Dwaa),
        ("dwab", Self::Dwab),
    ];

    /// Returns the name in a scene file.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }

    /// Returns whether the compression changes values.
    pub fn is_lossy(self) -> bool {
        matches!(self, Self::Pxr24) || self.is_of_16_bits()
    }

    /// Returns whether all colors are stored in 16 bits.
    pub fn is_of_16_bits(self) -> bool {
        matches!(self, Self::Dwaa | Self::Dwab)
    }
}
