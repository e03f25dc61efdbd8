//! Rooms behind windows: light that panes let straight on, and the sky that is seen through openings.
//!
//! ```text
//! cargo test --test windows
//! ```

#[path = "windows/openings.rs"]
mod openings;
#[path = "windows/panes.rs"]
mod panes;
#[path = "windows/photons.rs"]
mod photons;
mod support;
