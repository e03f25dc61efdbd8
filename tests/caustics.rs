//! Caustics by photons: the light pass and the camera paths each find their own part of the same light.
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
