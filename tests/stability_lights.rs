//! The rows of the stability catalog about lights and the media between them: lamps far away, around, beside and within
//! the plane of what they light, and surfaces that lie in one place.
//!
//! ```text
//! cargo test --test all stability_lights::
//! ```

mod lamps;
mod media;
mod unlit;
