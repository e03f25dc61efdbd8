//! Measurements made with a few paths before the render, for the plan and for the paths that follow.

mod branching;
mod brightness;
mod camera_events;
mod clusters;
mod cost;
mod density_pilot;
mod gathering_worth;
mod highlights;
mod lamp_part;
mod openings;
mod photon_pilot;
mod pilot;
mod pilot_noise;
mod polarization_error;
mod prepare;
mod reached_places;
mod room;
mod seen_light;
mod small_light;
mod specular_chain;
mod sunlit;
mod visible_caps;

pub use branching::{Branching, branching, pixels_of_objects};
pub use brightness::{RoomLight, room_light};
pub use cost::{PhotonTimes, Probe, photon_times, photons_within, probe};
pub use density_pilot::{Adaptive, adaptive};
pub use gathering_worth::{GatheredWorth, gathered_worth};
pub use highlights::small_highlights;
pub use photon_pilot::{piloted, seen_photons};
pub use pilot::{PhotonWorth, SampleWorth, photons_worth};
pub use pilot_noise::{Effort, PilotNoise, pilot_noise};
pub use polarization_error::polarization_error;
pub use prepare::{prepare, prepare_unguided};
pub use reached_places::reached_places;
pub use seen_light::most_changed;
pub use sunlit::with_light_vertices;
