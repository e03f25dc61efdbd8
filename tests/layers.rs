//! Materials made of layers and of other materials: plastic, mixes and masks.
//!
//! ```text
//! cargo test --test all layers::
//! ```

mod densities;
mod furnaces;
mod lamps;
mod masks;
mod plans;
