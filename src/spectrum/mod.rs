//! Floor 1: what light is made of. A lane is a number that travels; only this folder knows what it stands for.

mod advice;
mod bands;
mod basis;
mod cardinals;
mod color;
#[doc(hidden)]
pub mod comparison;
mod curve;
mod curve_check;
mod curve_name;
mod curve_range;
mod curve_text;
pub mod data;
mod distinct;
mod draw;
mod emission;
mod image;
mod lanes;
mod matching;
mod mixture;
mod palette;
mod pattern;
mod response;
mod slope;
mod table;
mod texture;
mod throughput;
mod upsample;
pub mod visible;

pub use advice::{absorption_of, imitation, provenance, reach};
pub use bands::normal_reflectance;
pub use basis::Basis;
pub use color::{ColorSpace, Primaries, apply, decode_srgb, encode_srgb};
pub use curve::{Curve, CurveKind};
pub use curve_check::Refusal;
pub use distinct::Distinct;
pub use draw::Draw;
pub use emission::Emission;
pub use image::Image;
pub use lanes::Lanes;
pub use matching::{Matching, Wavelength};
pub use response::Response;
pub use table::{MAX_LANES, Quantity, Table};
pub use texture::{Channel, Encoding, ImageText, Placement, TexelFilter, Texture, Wrap, number_or_two};
pub use throughput::Throughput;
pub use upsample::{Sigmoid, Upsampler};
