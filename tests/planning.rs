//! The plan models no more than a scene needs, and its stated errors of a model hold.
//!
//! ```text
//! cargo test --release --test all planning:: -- --nocapture     # prints predicted and true errors
//! ```

mod caustics;
mod chains;
mod choices;
mod ordinary;
mod rooms;
mod small;
mod stokes;
mod twenty;
