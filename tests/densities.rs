//! Random directions and points follow their stated densities: chi-squared tests with a significance of 1 % over all
//! shapes together and over all maps together.
//!
//! ```text
//! cargo test --test all densities::
//! ```

mod filters;
mod light_tree;
mod shapes;
mod stay_in_range;
mod warps;
