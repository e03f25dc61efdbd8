//! Measurements made with a few paths before the render, for the plan and for the paths that follow.

mod branching;
mod brightness;
mod clusters;
mod compared;
mod cost;
mod density_pilot;
mod findings;
mod gathering_worth;
mod highlights;
mod openings;
mod pilot;
mod pilot_noise;
mod prepare;
mod reach;
mod room;
mod seen_light;
mod sent_ahead;
mod sunlit;
mod visible_caps;

pub use branching::{Branching, branching, pixels_of_objects};
pub use brightness::{RoomLight, room_light};
pub use compared::polarization_error;
pub use cost::{PhotonTimes, Probe, photon_times, photons_within, probe};
pub use density_pilot::{Adaptive, adaptive};
pub use gathering_worth::{GatheredWorth, gathered_worth};
pub use highlights::small_highlights;
pub use pilot::{PhotonWorth, SampleWorth, photons_worth};
pub use pilot_noise::{Effort, PilotNoise, pilot_noise};
pub use prepare::{prepare, prepare_unguided};
pub use reach::reached_places;
pub use seen_light::most_changed;
pub use sent_ahead::{piloted, seen_photons};
pub use sunlit::with_light_vertices;
