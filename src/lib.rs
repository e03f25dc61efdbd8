//! Abbe: a spectral, HDR, offline renderer.
//!
//! ```
//! let scene = abbe::Scene::parse(
//!     r#"
//!     camera = { position = [0, 1, 5], look_at = [0, 1, 0], vertical_fov = 40 }
//!     film = { width = 32, height = 24 }
//!     light = [{ environment = { radiance = 1 } }]
//!     [material.glass]
//!     dielectric = { index = "N-BK7" }
//!     [[object]]
//!     shape.sphere = { center = [0, 1, 0], radius = 1 }
//!     material = "glass"
//!     "#,
//!     "",
//! )?;
//! let image = abbe::render(&scene, &abbe::Options { samples: Some(4), ..Default::default() })?;
//! let [red, green, blue] = image.rgb_at(16, 12);
//! # assert!((red - green).abs() < 1e-3 && (green - blue).abs() < 1e-3);
//! // image.write_exr("ball.exr")?;
//! # Ok::<(), abbe::Error>(())
//! ```
//!
//! [`Scene::read`] reads a scene file, and [`Scene::from_table`] takes a scene that a program has built.
//! [`scene::Source`] overrides values of a scene, for example for each frame of an animation or each step of a sweep.
//! [`Rendering`] gives access to the plan and the progress of a render. The modules below are public too, for example
//! to plan without rendering ([`plan::plan`]), to look up the index of a glass ([`spectrum::data::glass`]) or to trace
//! a single ray ([`Scene::intersect`]).
//!
//! ```text
//! scene.toml -> Document -> Scene<Curve> -> Plan -> World -> PathTracer<N> over tiles, pass by pass -> Film -> EXR
//!
//! floor 6   rendering   a scene made into an image
//! floor 5   plan        looks at a Scene<Curve>; answers a Method and, in words, why
//! floor 4   trace       how light travels
//! floor 3   scene       the world, with every reference resolved  |  look   images shown and compared
//! floor 2   material    how light leaves a surface     |  light   how lights are sampled  |  film   what is remembered
//! floor 1   spectrum    what light is made of          |  shape   where surfaces are
//! floor 0   math        points, directions, random numbers  |  error   what went wrong, where, and what to do
//! ```
//!
//! The modules are called rooms. A room uses only rooms on lower floors; `tests/floors.rs` checks this.

#![deny(unsafe_code)]
#![warn(missing_debug_implementations, missing_docs, unnameable_types)]

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
pub mod look;
pub mod scene;

// Floor 4
pub mod trace;

// Floor 5
pub mod plan;

// Floor 6
mod rendering;

pub use error::{Diagnostic, Error, Lines, Result, nearest};
pub use rendering::{
    ErrorAccount, Image, ImageError, Options, Parts, PlanAccount, RenderAccount, Rendering, Resumed, Timer,
    has_finished, is_checkpoint, merge, render, write_plan,
};
pub use scene::Scene;
pub use toml;
pub use trace::Advance;
