//! Floor 4: how light travels.
//!
//! What holds on every path:
//!
//! 1. A lane whose throughput is 0 is not on the ray.
//! 2. Lanes on one ray share its geometry, random numbers and density, and differ only in throughput.
//! 3. A surface answers with branches, a direction and the lanes that came by it; dispersive lanes part there.
//! 4. The walker is a loop over pending rays: it follows all branches while the weight is large, then one, then
//!    plays roulette. A weight is the mean throughput over the lanes, without the factor of radiance between media.
//! 5. Light that goes straight on, through holes and panes, makes no other kind of path: next-event estimation and
//!    photons look through them.
//! 6. In Heckbert's notation, with S for surfaces that mirror or refract and D for those that scatter widely: photons
//!    may find `L S+ D E`, and gathered photons `L S+ D (D|S)* E`; paths from the camera then leave exactly those out.
//! 7. Light that one diffuse surface sends another may be looked for at vertices of light paths: `L (S|D)* D D S* E`.
//!    Paths from the camera then go on to such a surface with the probability of the rest alone.
//! 8. Light that reaches the camera is a contribution handed to the sensor.
//! 9. Random numbers are a pure function of seed, pixel, sample, branch and use; sums have a fixed order.
//!
//! ```text
//! prepare          a world, tabulated and taught where to look
//! render, tile     an image in the making, pass by pass
//! path_tracer      camera paths: walker + direct lighting + gathered photons + light vertices, into the sensor
//! layers           what is asked for beside the image: contributions told apart, first surfaces, sums of a tile
//! photon           photons and light paths: walker + landing
//! walker           from surface to surface; interaction, media, path
//! replicates       eight renders side by side; noise, blur, stopping: what they tell, and when that is enough
//! probe, pilot ..  what the plan asks, by the same walks
//! ```

mod aimed;
mod apart;
mod arrived;
mod audit;
mod blur;
mod branching;
mod bright;
mod brightness;
mod clusters;
mod compared;
mod contribution;
mod coverage;
mod direct;
mod dispersion;
mod dyes;
mod excitation;
mod exciting;
mod first_lobe;
mod gather;
mod gathering_worth;
mod guide;
mod interaction;
mod kd_tree;
mod kernel;
mod layer_sample;
mod layer_sums;
mod layers;
mod light_pass;
mod light_vertices;
mod lit;
mod media;
mod method;
mod noise;
mod parallel;
mod pass;
mod pass_light;
mod passes;
mod path;
mod path_tracer;
mod photon;
mod photon_batch;
mod photon_map;
mod photon_targets;
mod pilot;
mod polarization;
mod polarized;
mod prepare;
mod probe;
mod rare_light;
mod reach;
mod render;
mod replicates;
mod resampling;
mod resampling_worth;
mod roulette;
mod route;
mod route_walk;
mod routes;
mod rows;
mod saved;
mod search;
mod seen_light;
mod sensor;
mod shading;
mod slots;
mod spectrum_sample;
mod stats;
mod stopping;
mod straight;
mod targets;
mod tile;
mod usefulness;
mod visible_caps;
mod walk;
mod walker;
mod watch;
mod white;
mod width;
mod world;

pub use blur::Blur;
pub use branching::{Branching, branching};
pub use bright::{BrightPlace, BrightPlaces};
pub use brightness::bright_places;
pub use compared::polarization_error;
pub use dispersion::{COLORS_NM, Dispersion, dispersion};
pub use gathering_worth::{GatheredWorth, gathered_worth};
pub use light_pass::{piloted, seen_photons};
pub use method::{LightPass, MapPasses, Method, Polarizing, Stop, Transport};
pub use noise::{Noise, Outlier, TileNoise};
pub use photon_targets::is_photon_target;
pub use pilot::{PhotonWorth, SampleWorth, photons_worth, samples_worth};
pub use prepare::{prepare, prepare_unguided};
pub use probe::{PhotonTimes, Probe, photon_times, probe};
pub use rare_light::RareLight;
pub use reach::{gathered_photons, reached_places};
pub use render::{Advance, Rendering, Report, render};
pub use resampling_worth::resampling_gain;
pub use route::{ROUTES_NM, Route, Step, Way};
pub use routes::routes;
pub use saved::Restored;
pub use seen_light::{SeenLight, seen_light};
pub use stopping::Stopped;
pub use targets::SEEN_PIXELS;
pub use world::World;
