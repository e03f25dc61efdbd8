//! Thin films: coated glass, metal and plastic, and films that are panes, in rendered images and in white furnaces.
//!
//! ```text
//! cargo test --test all films::
//! cargo test --release --test all films::furnaces -- --nocapture     # a table of the furnaces
//! ```

mod colors;
mod furnaces;
mod phases;
mod reference;
mod rendered;
