//! Paths from the camera. They pass direct light, gathered photons and light vertices to the sensor.

mod aimed;
mod aimed_samples;
mod catcher;
mod direct;
mod emitter_hit;
mod layer_sample;
mod numbers;
mod path_tracer;
mod resampling;
mod sensor;
mod surface;

pub use layer_sample::SampleRow;
pub use path_tracer::PathTracer;
pub use sensor::{Bounce, SensorEvent};
