//! Rough glass: directions against their density, what is neither lost nor won, and images of it.
//!
//! ```text
//! cargo test --test all rough_glass::
//! ```

mod furnaces;
mod lamps;
mod sides;
mod weights;
