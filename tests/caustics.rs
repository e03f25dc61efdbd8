//! Caustics by photons: the light pass and the camera's rays find the same light, each its own part of it.
//!
//! ```text
//! cargo test --release --test all caustics::
//! ```

mod agreement;
mod bent;
mod blur;
mod coats;
mod edges;
mod gathered;
mod known;
mod large;
mod materials;
mod nearly_smooth;
mod openings;
mod polarization;
mod wavelengths;
