//! Photons and light paths: where they are sent, what is kept of them, and how paths from the camera gather it.

mod batch;
mod follow;
mod gather;
mod kd_tree;
mod kernel;
mod light_paths;
mod light_vertices;
mod pass_light;
mod photon_map;
mod splat;
mod vertex_visibility;

pub use batch::{Batch, batches, batches_of_pass, trace_batch};
pub use gather::{GatherPoint, Gathered, PhotonShare, PhotonSpectrum, gather};
pub use light_paths::{LightPaths, SAMPLES_PER_SET, can_trace_light_paths, light_paths_reach, pilot_vertices};
pub use light_vertices::{LightVertex, LightVertices, holds_vertices};
pub use pass_light::PassLight;
pub use photon_map::{PhotonMap, photons, store_photon};
pub use splat::{Splat, splat_photon};
