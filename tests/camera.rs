//! Lens, shift, projections, filters and crop: rays against closed forms, blur against the thin lens, files against
//! what compositors read.
//!
//! ```text
//! cargo test --test camera
//! ```

#[path = "messages/run.rs"]
mod run;
mod support;

#[path = "camera/files.rs"]
mod files;
#[path = "camera/images.rs"]
mod images;
#[path = "camera/rays.rs"]
mod rays;
#[path = "camera/seen.rs"]
mod seen;
