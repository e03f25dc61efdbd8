//! Rooms behind windows: light that panes let straight on.
//!
//! ```text
//! cargo test --test all windows::
//! ```

mod panes;
mod photons;
