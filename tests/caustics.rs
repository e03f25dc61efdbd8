//! Caustics by photons: the light pass and the camera's rays find the same light, each its own part of it.
//!
//! ```text
//! cargo test --release --test caustics
//! ```

mod support;

#[path = "caustics/agreement.rs"]
mod agreement;
#[path = "caustics/edges.rs"]
mod edges;
#[path = "caustics/gathered.rs"]
mod gathered;
#[path = "caustics/known.rs"]
mod known;
#[path = "caustics/materials.rs"]
mod materials;
#[path = "caustics/polarization.rs"]
mod polarization;
#[path = "caustics/wavelengths.rs"]
mod wavelengths;
