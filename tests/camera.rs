//! Lens, shift, projections, filters and crop: rays against closed forms, blur against the thin lens, files against
//! what compositors read.
//!
//! ```text
//! cargo test --test all camera::
//! ```

mod files;
mod images;
mod rays;
mod seen;
