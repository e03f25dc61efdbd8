//! Rooms behind windows: light that passes straight through panes.
//!
//! ```text
//! cargo test --test all windows::
//! ```

mod bright;
mod openings;
mod panes;
mod photons;
