//! Floor 2: how lights are sampled.
//!
//! Every source of light is a [`Light`]. Next-event estimation samples one from a point (`sample_li`). It also
//! evaluates the pdf of a direction that was drawn by other means (`pdf_li`), so that the weights of both techniques
//! add up to 1. Photons start from lights (`sample_le`, `pdf_le`). A [`LightSampler`] chooses one of many lights.

mod area;
mod beam;
mod bounds;
mod emission_map;
mod environment;
mod kinds;
mod opening;
mod panorama;
mod parts;
mod point;
mod sample;
mod sampler;
mod spot;
mod sun;
mod toward_ball;
mod tree;

pub use area::{Area, ShownImage};
pub use beam::Beam;
pub use bounds::LightBounds;
pub use emission_map::EmissionMap;
pub use environment::{Environment, Sky, SkyPolarization};
pub use kinds::{Light, LightId};
pub use opening::Opening;
pub use panorama::{BrightPart, Panorama};
pub use parts::{LightParts, MeshPartsCache};
pub use point::Point;
pub use sample::{EmissionPoint, LeSample, LightSample};
pub use sampler::{LightSampler, SampledLight};
pub use spot::Spot;
pub use sun::Sun;
pub use tree::LightTree;
