//! Paths from the camera. They pass direct light, gathered photons and light vertices to the sensor.

mod aimed_samples;
mod aimed_scattering;
mod camera_sample;
mod catcher;
mod dimensions;
mod direct;
mod emitter_hit;
mod layer_sample;
mod light_vertex_gathering;
mod path_tracer;
mod sensor;
mod surface;

pub use camera_sample::take_sample;
pub use layer_sample::SampleRow;
pub use path_tracer::PathTracer;
pub use sensor::{Bounce, SensorEvent};
