//! The rows of the stability catalog about lights and the media between them: lamps far from, around, beside and in the
//! plane of what they light, and surfaces in the same place.
//!
//! ```text
//! cargo test --test all stability_lights::
//! ```

mod lamps;
mod media;
mod unlit;
