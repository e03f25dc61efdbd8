//! Rooms behind windows: light that panes let straight on.
//!
//! ```text
//! cargo test --test windows
//! ```

#[path = "windows/bright.rs"]
mod bright;
#[path = "windows/panes.rs"]
mod panes;
#[path = "windows/photons.rs"]
mod photons;
mod support;
