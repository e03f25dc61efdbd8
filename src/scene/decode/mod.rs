//! The files of images that a scene names: bytes in, the numbers of their texels out, as they stand in the file.

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
pub(super) use texels::{Floats, Steps, Unreadable, Whole};
