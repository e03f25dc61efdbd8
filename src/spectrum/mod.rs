//! Floor 1: what light is made of. A lane is a number that travels on a ray; only this folder defines its meaning.

mod band_response;
mod bands;
mod basis;
mod cardinals;
mod color;
#[doc(hidden)]
pub mod comparison;
mod curve;
mod curve_cache;
pub mod data;
mod draw;
mod dye;
mod emission;
mod image;
mod lane_wavelengths;
mod lanes;
mod matching;
mod mixture;
mod palette;
mod projection;
mod quantity;
mod response;
mod table;
mod texture;
mod throughput;
mod upsample;
pub mod visible;
mod warnings;
mod wavelength_bands;

pub use band_response::BandResponse;
pub use bands::normal_reflectance;
pub use basis::Basis;
pub use color::{
    ColorSpace, IDENTITY, Matrix, Primaries, apply, decode_srgb, describe_file_colors, encode_srgb, file_to_rec709,
};
pub use curve::{CatalogEntry, Curve, CurveKind, cauchy_from_abbe, sellmeier_squared};
pub use curve_cache::CurveCache;
pub use draw::Draw;
pub use dye::{Dye, EnergyExcess, Excited, PreparedDye};
pub use emission::{Emission, FilmColors};
pub use image::{Image, Wrap};
pub use lane_wavelengths::Waves;
pub use lanes::{LaneSet, Lanes};
pub use matching::{Matching, Wavelength};
pub use quantity::Quantity;
pub use response::Response;
pub use table::{MAX_LANES, Table};
pub use texture::{Channel, Encoding, Placement, TexelFilter, Texture};
pub use throughput::Throughput;
pub use upsample::{Sigmoid, Upsampler};
pub use warnings::{absorption_range_warning, imitation_warning, index_range_warning, index_source};
pub use wavelength_bands::WavelengthBands;
