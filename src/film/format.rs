//! How an image is written.

use serde::{Deserialize, Serialize};

use super::layers::{FirstSurface, Layer};
use crate::spectrum::WavelengthBands;

/// What a file holds beside the image, and how its numbers are written.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Format {
    /// Layers, in the order in which they were asked for.
    pub layers: Vec<Layer>,
    /// Whether the components of Stokes vectors are among them, whatever others are asked for in place of the scene's.
    #[serde(skip)]
    pub stokes: bool,
    /// Which surface layers such as `N` and `albedo` are of.
    pub first: FirstSurface,
    /// Bits of a color.
    pub precision: Precision,
    /// How the numbers are packed.
    pub compression: Compression,
    /// Whether each layer is a part of its own. Then a compression that loses packs colors alone, and
    /// [`Compression::Zip`] what is no color.
    pub multipart: bool,
    /// The bands of the spectral image that is made beside it, if one is.
    pub spectral: Option<WavelengthBands>,
    /// Luminance of red, green and blue of 1, in cd/m^2, where the scene gives its lights in such units.
    pub white_luminance: Option<f64>,
    /// Who owns the image.
    pub owner: Option<String>,
    /// What there is to say about it.
    pub comments: Option<String>,
    /// Frame rate of the sequence to which it belongs: frames, and the seconds that they take.
    pub frames_per_second: Option<[u32; 2]>,
}

/// Last parts of the names of channels that DWA packs with loss (OpenEXR 3.3, ImfDwaCompressor.cpp).
const COLORS_OF_DWA: [&str; 6] = ["R", "G", "B", "Y", "BY", "RY"];

impl Format {
    /// Asks for some layers in place of others.
    pub fn ask_for(&mut self, layers: &[Layer]) {
        self.layers = layers.to_vec();
        let stokes = Layer::STOKES.into_iter().filter(|layer| self.stokes && !layers.contains(layer));
        self.layers.extend(stokes);
    }

    /// Whether anything is asked for of Stokes vectors.
    pub fn has_stokes(&self) -> bool {
        self.layers.iter().copied().any(Layer::is_of_polarization)
    }

    /// Why no file can hold this, and what to do instead, if that is so.
    ///
    /// What is no color must stay as it is: a depth, a normal or the number of a matte that is nearly right is wrong.
    pub fn objection(&self) -> Option<(String, String)> {
        let name = self.compression.name();
        if self.compression.is_of_16_bits() && self.precision == Precision::Float {
            let message = format!("the compression {name} holds colors of 16 bits, not of 32");
            return Some((message, "write precision = \"half\", or compression = \"zip\"".into()));
        }
        if !self.compression.is_lossy() || self.multipart {
            return None;
        }
        // DWA packs what it does not take for a color by its channel's name without loss, and so a depth; PXR24 rounds
        // all of 32 bits.
        let is_dwa = self.compression.is_of_16_bits();
        let depth = Some("Z").filter(|_| !is_dwa);
        let takes_for_color = |layer: &Layer| layer.channels().iter().any(|name| COLORS_OF_DWA.contains(name));
        let is_spoiled = |layer: &&Layer| !layer.is_color() && (!is_dwa || takes_for_color(layer));
        let layers = self.layers.iter().filter(is_spoiled).map(|layer| layer.name());
        let spoiled: Vec<&str> = depth.into_iter().chain(layers).collect();
        (!spoiled.is_empty()).then(|| {
            let message = format!("the compression {name} changes what is no color: {}", spoiled.join(", "));
            let help = "write multipart = true, which packs that without loss in parts of its own";
            (message, format!("{help}; or compression = \"piz\""))
        })
    }
}

/// Bits of a color. Depth, places and statistics always have 32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// How numbers are packed: without losing a bit, but for those that say so.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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
    /// Numbers of 32 bits rounded to 24, one part in 65 536 or less; those of 16 bits stay as they are.
    Pxr24,
    /// Cosines of 8 x 8 pixels: colors of 16 bits nearly as they look, in the smallest files; 32 rows at a time.
    Dwaa,
    /// The same, 256 rows at a time.
    Dwab,
}

impl Compression {
    /// All by their names in a scene file.
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

    /// The name in a scene file.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, known)| *known == self).map_or("", |(name, _)| name)
    }

    /// Whether numbers come back changed.
    pub fn is_lossy(self) -> bool {
        matches!(self, Self::Pxr24) || self.is_of_16_bits()
    }

    /// Whether it makes 16 bits of every color.
    pub fn is_of_16_bits(self) -> bool {
        matches!(self, Self::Dwaa | Self::Dwab)
    }
}
