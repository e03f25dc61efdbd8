//! Floor 2: what is remembered of the light that arrives, and how it is written down.

mod blocks;
mod cryptomatte;
mod exr;
mod exr_attributes;
mod exr_blocks;
mod exr_file;
mod exr_layer;
mod exr_part;
mod exr_spectral;
mod file;
mod filter;
mod format;
mod guard;
mod image;
mod layers;
mod mitchell;
mod picture;
mod sample_weights;
mod shard;
mod spectral;
mod sum;
mod time;
mod window;

pub use self::exr::{Fact, Optics, Provenance, View, encode_exr, write_exr};
pub use cryptomatte::{Manifest, RANKS, id};
pub use exr_attributes::CameraMatrix;
pub use exr_file::ExrFile;
pub use exr_layer::{BEAUTY, ExrLayer};
pub use exr_part::{Channel, Part, PixelBounds, Statistics};
pub use exr_spectral::write_spectral_exr;
pub use file::{check_writable, replace_file};
pub use filter::Filter;
pub use format::{Compression, Format, Precision};
pub use image::{DEPTH_OF_NOTHING, Film, Pixel, Sample};
pub use layers::{FirstSurface, LONGEST_NAME, Layer, LayerImage, light_layer_name};
pub use mitchell::Mitchell;
pub use picture::{png, write_png, write_rgb8};
pub use sample_weights::SampleWeights;
pub use shard::{Shard, TILE, TilePlace};
pub use spectral::SpectralImage;
pub use sum::{PassSum, PixelSum, stored};
pub use window::{Overscan, Window};

pub(crate) use blocks::{BlockReader, BlockWriter, Kind, write_blocks};
pub(crate) use guard::{MOST_TEXELS, fits, guarded};
