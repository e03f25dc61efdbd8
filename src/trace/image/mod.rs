//! A render in progress, pass by pass over its tiles: sums, noise, when it is enough, and what is saved.

mod blur;
mod coverage;
mod layer_sums;
mod light_pass;
mod noise;
mod passes;
mod rare_light;
mod rendering;
mod saved;
mod stopping;
mod tile;
mod values;

pub use light_pass::for_each_splat;
pub use noise::{Estimate, Measured, Noise, Outlier, TileNoise};
pub use rare_light::RareLight;
pub use rendering::{Advance, PhotonCost, Rendering, Report, render};
pub use saved::Restored;
pub use stopping::{FIRST_LOOK, Stopped};
pub use tile::bytes_of_film;
