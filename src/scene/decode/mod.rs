//! Decoders of the image files that a scene names. They return the numbers of the texels as the file has them.

mod exif;
mod exr;
mod exr_channels;
mod icc;
mod jpeg;
mod png;
mod radiance;
mod texels;

pub(super) use exr::decode as decode_exr;
pub(super) use jpeg::decode as decode_jpeg;
pub(super) use png::decode as decode_png;
pub(super) use radiance::decode as decode_radiance;
pub(super) use texels::{FloatImage, IntegerImage, IntegerTexels, Unreadable};
