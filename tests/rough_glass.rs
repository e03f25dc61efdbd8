//! Rough glass: directions against their density, what is neither lost nor won, and images of it.
//!
//! ```text
//! cargo test --test rough_glass
//! ```

#[path = "support/chi_squared.rs"]
mod chi_squared;
mod support;

mod rough_glass {
    mod furnaces;
    mod lamps;
    mod sides;
    mod weights;
}
