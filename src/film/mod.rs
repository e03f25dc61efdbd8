//! Floor 2: what is remembered of the light that arrives, and how it is written down.

mod cryptomatte;
mod exr;
mod exr_attributes;
mod exr_blocks;
mod exr_file;
mod exr_layer;
mod exr_part;
mod file;
mod filter;
mod format;
mod guard;
mod image;
mod layers;
mod picture;
mod sum;
mod time;

pub use self::exr::{Fact, Optics, Provenance, View, write_exr};
pub use cryptomatte::{Manifest, RANKS, id};
pub use exr_attributes::CameraMatrix;
pub use exr_file::ExrFile;
pub use exr_layer::{BEAUTY, ExrLayer};
pub use exr_part::{Channel, Part, PixelBounds, Statistics};
pub use file::check_writable;
pub use filter::Filter;
pub use format::{Compression, Format, Precision};
pub use image::{DEPTH_OF_NOTHING, Film, Pixel, Sample, Window};
pub use layers::{FirstSurface, LONGEST_NAME, Layer, LayerImage, light_layer_name};
pub use picture::{png, write_png, write_rgb8};
pub use sum::{PassSum, PixelSum, stored};

pub(crate) use guard::{MOST_TEXELS, fits, guarded};
