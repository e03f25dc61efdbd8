//! Floor 6: renders a scene to an image. This is the interface for programs, including the `render` command.

mod account;
mod checkpoint;
mod identity;
mod image;
mod image_error;
mod options;
mod part;
mod parts;
mod plan_file;
mod provenance;
mod render;
mod timer;
mod warnings;

pub use account::{ErrorAccount, PlanAccount, RenderAccount};
pub use checkpoint::{Resumed, has_finished, is_checkpoint};
pub use image::Image;
pub use image_error::ImageError;
pub use options::Options;
pub use parts::{Parts, merge};
pub use plan_file::write_plan;
pub use render::{Rendering, render};
pub use timer::Timer;
