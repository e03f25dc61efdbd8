//! What files of images hold, and why they cannot be read.

use crate::film;
use crate::spectrum::Matrix;

/// Whole numbers, texel by texel, rows from the top: gray, or red, green and blue, and maybe alpha behind them.
pub(in crate::scene) struct Whole {
    pub(in crate::scene) width: usize,
    /// Numbers of a texel, 1 to 4.
    pub(in crate::scene) channels: usize,
    /// What the file says of its colors that is not sRGB.
    pub(in crate::scene) not_srgb: Option<String>,
    /// Whether the file says that it is upright only when it is turned or mirrored.
    pub(in crate::scene) is_turned: bool,
    pub(in crate::scene) steps: Steps,
}

/// Numbers of 8 or 16 bits, the greatest of which means 1.
pub(in crate::scene) enum Steps {
    Bytes(Vec<u8>),
    Words(Vec<u16>),
}

impl Whole {
    /// Whether the last number of a texel is alpha.
    pub(in crate::scene) fn has_alpha(&self) -> bool {
        self.channels.is_multiple_of(2)
    }
}

/// Red, green and blue of each texel, or a gray, and maybe alpha behind them, rows from the top.
pub(in crate::scene) struct Floats {
    pub(in crate::scene) width: usize,
    /// Numbers of a texel, 1 to 4.
    pub(in crate::scene) channels: usize,
    /// Whether the last number of a texel is alpha.
    pub(in crate::scene) has_alpha: bool,
    /// Whether a compression has changed numbers.
    pub(in crate::scene) is_lossy: bool,
    /// The matrix from its colors to linear Rec.709, or why it is not known.
    pub(in crate::scene) to_rec709: Result<Matrix, String>,
    pub(in crate::scene) numbers: Vec<f32>,
}

impl Floats {
    /// Sets a number of a texel, if there is that texel.
    pub(super) fn put(&mut self, x: usize, y: usize, number: usize, value: f32) {
        let at = self.channels * (y * self.width + x) + number;
        if x < self.width && at < self.numbers.len() {
            self.numbers[at] = value;
        }
    }
}

/// Why a file is not the image that its name promises.
#[derive(Debug, thiserror::Error)]
pub(in crate::scene) enum Unreadable {
    #[error("{0}")]
    Unfit(String),
    #[error("{0}")]
    Large(String),
    #[error(transparent)]
    Png(#[from] ::png::DecodingError),
    #[error("{}", .0.to_string().trim_matches('"'))]
    Jpeg(#[from] zune_jpeg::errors::DecodeErrors),
    #[error(transparent)]
    Exr(#[from] ::exr::error::Error),
    #[error("Abbe does not know its compression")]
    Compression,
    #[error("it is a deep image, which has many values to a pixel")]
    Deep,
    /// No red, green and blue, but these channels.
    #[error("it has the channels {0}")]
    Channels(String),
    #[error("some of its channels do not have a number for each pixel")]
    Sparse,
    #[error("it does not begin as one does")]
    Signature,
    #[error("it ends too early")]
    Short,
    #[error("its format is {0:?}, and only 32-bit_rle_rgbe is read")]
    Format(String),
    #[error("its {0} is {1:?}, which it cannot be divided by")]
    Factors(String, String),
    #[error("its size is {0:?}, and only -Y height +X width is read")]
    Size(String),
    #[error("row {0} (counted from 0) is not as long as the image is wide")]
    Row(usize),
}

impl Unreadable {
    /// How to save an image that is whole, but of a form that is not read; none of another.
    pub(in crate::scene) fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Large(..) => Some("make it smaller"),
            Self::Compression => Some("save it by ZIP"),
            Self::Deep => Some("flatten it"),
            Self::Sparse => Some("save all channels in full size"),
            Self::Format(_) => Some("save it as red, green and blue"),
            Self::Size(_) => Some("save it with its rows from the top, each from the left"),
            _ => None,
        }
    }
}

/// Refuses images without texels, with too many, and sizes whose `bytes` the file cannot hold.
pub(super) fn fits(width: usize, height: usize, bytes: u64, file: &[u8]) -> Result<(), Unreadable> {
    if let Some(said) = film::too_large(width, height, film::MOST_TEXELS) {
        return Err(Unreadable::Large(said));
    }
    film::fits(width, height, bytes, file).map_err(Unreadable::Unfit)
}
