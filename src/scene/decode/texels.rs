//! The contents of image files, and the reasons why one cannot be read.

use crate::film;
use crate::spectrum::Matrix;

/// An image of whole numbers, in rows from the top. Each texel is a gray, or red, green and blue, optionally followed
/// by alpha.
pub(in crate::scene) struct IntegerImage {
    pub(in crate::scene) width: usize,
    /// Numbers per texel, 1 to 4.
    pub(in crate::scene) channels: usize,
    /// What the file says about its colors, if they are not sRGB.
    pub(in crate::scene) not_srgb: Option<String>,
    /// Whether the file says that it has to be turned or mirrored to be upright.
    pub(in crate::scene) is_rotated: bool,
    pub(in crate::scene) steps: IntegerTexels,
}

/// Numbers of 8 or 16 bits. The largest one means 1.
pub(in crate::scene) enum IntegerTexels {
    Bytes(Vec<u8>),
    Words(Vec<u16>),
}

impl IntegerImage {
    /// Returns whether the last number of a texel is alpha.
    pub(in crate::scene) fn has_alpha(&self) -> bool {
        self.channels.is_multiple_of(2)
    }
}

/// An image of floating-point numbers, in rows from the top. Each texel is red, green and blue, or a gray, optionally
/// followed by alpha.
pub(in crate::scene) struct FloatImage {
    pub(in crate::scene) width: usize,
    /// Numbers per texel, 1 to 4.
    pub(in crate::scene) channels: usize,
    /// Whether the last number of a texel is alpha.
    pub(in crate::scene) has_alpha: bool,
    /// Whether a lossy compression has changed the numbers.
    pub(in crate::scene) is_lossy: bool,
    /// The matrix from its colors to linear Rec.709, or why it is not known.
    pub(in crate::scene) to_rec709: Result<Matrix, String>,
    pub(in crate::scene) numbers: Vec<f32>,
}

impl FloatImage {
    /// Sets a number of a texel, if that texel exists.
    pub(super) fn set(&mut self, x: usize, y: usize, number: usize, value: f32) {
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
    #[error("Abbe does not support its compression")]
    Compression,
    #[error("it is a deep image, which has many values per pixel")]
    Deep,
    /// There are no red, green and blue, only these channels.
    #[error("it has the channels {0}")]
    Channels(String),
    #[error("some of its channels do not have a number for every pixel")]
    Sparse,
    #[error("it does not begin like one")]
    Signature,
    #[error("it ends too early")]
    Short,
    #[error("its format is {0:?}, but only 32-bit_rle_rgbe is supported")]
    Format(String),
    #[error("its {0} is {1:?}, which it cannot be divided by")]
    Factors(String, String),
    #[error("its size is {0:?}, but only -Y height +X width is supported")]
    Size(String),
    #[error("row {0} (counted from 0) is not as long as the image is wide")]
    Row(usize),
}

impl Unreadable {
    /// Returns how to save an intact image in a form that can be read; none for other errors.
    pub(in crate::scene) fn remedy(&self) -> Option<&'static str> {
        match self {
            Self::Large(..) => Some("make it smaller"),
            Self::Compression => Some("save it with ZIP compression"),
            Self::Deep => Some("flatten it"),
            Self::Sparse => Some("save all channels at full resolution"),
            Self::Format(_) => Some("save it as red, green and blue"),
            Self::Size(_) => Some("save it with rows from top to bottom, each from left to right"),
            _ => None,
        }
    }
}

/// Refuses images with no texels or too many, and sizes that take more `bytes` than the file can hold.
pub(super) fn fits(width: usize, height: usize, bytes: u64, file: &[u8]) -> Result<(), Unreadable> {
    if let Some(reason) = film::too_large(width, height, film::MAX_TEXELS) {
        return Err(Unreadable::Large(reason));
    }
    film::fits(width, height, bytes, file).map_err(Unreadable::Unfit)
}
