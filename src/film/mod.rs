//! Floor 2: what is remembered of the light that arrives, and how it is written down.

mod cryptomatte;
mod exr;
mod file;
mod filter;
mod format;
mod image;
mod layers;
mod picture;
mod sum;

pub use self::exr::{Fact, Provenance, View, write_exr};
pub use cryptomatte::{Manifest, RANKS, id};
pub use file::check_writable;
pub use filter::Filter;
pub use format::{Compression, Format, Precision};
pub use image::{DEPTH_OF_NOTHING, Film, Pixel, Sample, Window};
pub use layers::{FirstSurface, LONGEST_NAME, Layer, LayerImage, light_layer_name};
pub use picture::write_png;
pub use sum::{PassSum, PixelSum};
