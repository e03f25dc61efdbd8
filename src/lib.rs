//! Abbe: a spectral, HDR, offline renderer.
//!
//! ```text
//! scene.toml -> Description -> Scene<Curve> -> Plan -> Scene<Table> -> radiance::<N> over tiles -> Film -> EXR
//!
//! floor 5   plan        looks at a Scene<Curve>; answers a Method and, in words, why
//! floor 4   trace       how light travels
//! floor 3   scene       the world, with every reference resolved
//! floor 2   material    how light leaves a surface     |  light   how light is aimed at  |  film   what is remembered
//! floor 1   spectrum    what light is made of          |  shape   where surfaces are
//! floor 0   math        points, directions, random numbers  |  error   what went wrong, where, and what to do
//! ```
//!
//! A room uses only rooms on lower floors; `tests/floors.rs` holds it to that.

#![deny(unsafe_code)]
#![warn(missing_docs)]

// Floor 0
mod error;
pub mod math;

// Floor 1
pub mod shape;
pub mod spectrum;

// Floor 2
pub mod film;
pub mod light;
pub mod material;

// Floor 3
pub mod scene;

// Floor 4
pub mod trace;

// Floor 5
pub mod plan;

pub use error::{Diagnostic, Error, Result, nearest};
