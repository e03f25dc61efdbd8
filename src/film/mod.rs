//! Floor 2: what is remembered of the light that arrives, and how it is written down.

mod exr;
mod file;
mod filter;
mod image;
mod picture;
mod sum;

pub use self::exr::{Fact, Provenance, View, write_exr};
pub use file::check_writable;
pub use filter::Filter;
pub use image::{DEPTH_OF_NOTHING, Film, Pixel, Sample, Window};
pub use picture::write_png;
pub use sum::{PassSum, PixelSum};
