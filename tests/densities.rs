//! Random directions and points follow the densities that are claimed for them: chi-squared tests, with significance
//! 1 % over all shapes together and over all maps together.
//!
//! ```text
//! cargo test --test densities
//! ```

#[path = "support/bodies.rs"]
mod bodies;
#[path = "support/chi_squared.rs"]
mod chi_squared;
#[path = "support/random.rs"]
mod random;

#[path = "densities/emitters.rs"]
mod emitters;
#[path = "densities/filters.rs"]
mod filters;
#[path = "densities/shapes.rs"]
mod shapes;
#[path = "densities/stay_in_range.rs"]
mod stay_in_range;
#[path = "densities/warps.rs"]
mod warps;
