//! Lens, shift, projections, filters and crop: rays are compared with closed forms, blur with the thin-lens formula,
//! and files with what compositors read.
//!
//! ```text
//! cargo test --test all camera::
//! ```

mod files;
mod images;
mod rays;
mod seen;
