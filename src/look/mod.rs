//! Floor 3: shows and compares images, whoever made them.

mod difference;
mod format;
mod mattes;
mod misexposure;
mod noise;
mod picture;
mod significance;
mod tone;

pub use difference::{AlphaDifference, ColorDifference, Difference, WorstPixel, compare};
pub use format::{number, percent};
pub use mattes::Mattes;
pub use misexposure::{Misexposure, Shows};
pub use noise::Noise;
pub use picture::{Exposure, Picture};
pub use tone::Tone;
