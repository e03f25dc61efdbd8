//! The rows of the stability catalog about scenes at the limits of what can be expressed: sizes, radiances, indices,
//! images and stacks that nobody would make except by mistake, and somebody does.
//!
//! ```text
//! cargo test --release --test all stability_extremes::
//! ```

mod glasses;
mod images;
mod places;
mod radiances;
mod stacks;
