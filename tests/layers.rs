//! Materials made of layers and of other materials: plastic, mixes and masks.
//!
//! ```text
//! cargo test --test layers
//! ```

#[path = "support/chi_squared.rs"]
mod chi_squared;
mod support;

mod layers {
    mod arrivals;
    mod densities;
    mod furnaces;
    mod lamps;
    mod masks;
    mod plans;
}
