//! Floor 1: what light is made of. A lane is a number that travels; only this folder knows what it stands for.

mod basis;
mod color;
mod curve;
mod curve_check;
pub mod data;
mod draw;
mod lanes;
mod response;
mod throughput;

pub use basis::{Basis, Quantity, Table};
pub use color::{ColorSpace, Primaries, encode_srgb};
pub use curve::{Curve, CurveKind};
pub use curve_check::Refusal;
pub use draw::Draw;
pub use lanes::Lanes;
pub use response::Response;
pub use throughput::Throughput;
