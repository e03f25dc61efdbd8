//! Floor 4: how light travels.
//!
//! What holds on every path:
//!
//! 1. A lane whose throughput is 0 is not on the ray.
//! 2. Lanes on one ray share its geometry, random numbers and density, and differ only in throughput.
//! 3. A surface answers with branches, each a direction and the lanes that take it; dispersive lanes part there.
//! 4. The walker is a loop over pending rays. It follows all branches while the weight is large, then one, and then
//!    plays Russian roulette. A weight is the mean throughput over the lanes, without the factor of radiance between
//!    media.
//! 5. Passing through holes and panes does not change the kind of a path: next-event estimation and photons look
//!    through them.
//! 6. In Heckbert's notation, with S for surfaces that mirror or refract and D for those that scatter widely: photons
//!    may find `L S+ D E`, and gathered photons `L S+ D (D|S)* E`. Paths from the camera then leave out exactly these.
//! 7. Light from one diffuse surface to another may be estimated at vertices of light paths and photons:
//!    `L (S|D)* D D S* E`. Paths from the camera then continue to such a surface, and gather photons there, only with
//!    the complementary probability, or for other lights.
//! 8. Light that reaches the camera is a contribution that the sensor receives.
//! 9. Random numbers are a pure function of seed, pixel, sample, branch and use; sums have a fixed order.
//!
//! A folder uses the files beside it and the folders above it in this list, never those below:
//!
//! ```text
//! (files here)  what all share: the world, its method and layers, media, a pass, contributions of light
//! walk          from surface to surface: paths, interactions, polarization, dyes, energy audit
//! photon        photons and light paths: how they are followed, what is kept of them, how it is gathered
//! camera        paths from the camera: walk + direct lighting + gathered photons + light vertices, into the sensor
//! image         an image in the making, pass by pass over its tiles: sums, noise, when it is enough, what is saved
//! probe         what the plan asks, by the same walks; `prepare` teaches a world where to look
//! dispersion    how far colors are pulled apart, and what tints light on its ways: rays of few colors
//! ```

mod bright;
mod budget;
mod camera;
mod contribution;
mod counted;
mod density;
mod dispersion;
mod dyes;
mod first_lobe;
mod guide;
mod highlight;
mod highlight_set;
mod image;
mod layers;
mod lens_light;
mod media;
mod method;
mod parallel;
mod pass;
mod path_start;
mod photon;
mod photon_focus;
mod photon_targets;
mod probe;
mod received_light;
mod replicates;
mod spectrum_sample;
mod stats;
mod walk;
mod white;
mod width;
mod world;

pub use bright::{BrightPlace, BrightPlaces};
pub use budget::RAYS_OF_A_LOOK;
pub use density::SampleDensity;
pub use dispersion::{COLORS_NM, Dispersion, ROUTES_NM, Route, RouteEvent, SEEN_PIXELS, Step, dispersion, routes};
pub use highlight::Highlight;
pub use highlight_set::SmallHighlights;
pub use image::{
    Advance, Estimate, FIRST_LOOK, Measured, Noise, Outlier, PhotonCost, RareLight, Rendering, Report, Restored,
    Stopped, TileNoise, bytes_of_film, render,
};
pub use lens_light::LensLight;
pub use media::MAX_MEDIA;
pub use method::{LightPass, MapPasses, Method, Polarizing, Stop, Transport};
pub use parallel::run_on;
pub use path_start::{SkyOpenings, SunlitPlaces};
pub use photon::light_paths_reach;
pub use photon_focus::Smoothness;
pub use probe::{
    Adaptive, Branching, Effort, GatheredWorth, PhotonTimes, PhotonWorth, PilotNoise, Probe, RoomLight, SampleWorth,
    adaptive, branching, gathered_worth, most_changed, photon_times, photons_within, photons_worth, pilot_noise,
    piloted, polarization_error, prepare, prepare_unguided, probe, reached_places, room_light, seen_photons,
    small_highlights, with_light_vertices,
};
pub use replicates::REPLICATES;
pub use world::World;
