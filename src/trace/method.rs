use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{BrightPlaces, Highlight, LensLight, SampleDensity, SkyOpenings, Smoothness, SunlitPlaces};
use crate::light::{LightId, Opening};
use crate::spectrum::Basis;

/// How to render, as plain data: the plan decides it, and the tracer follows it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// What the lanes stand for.
    pub basis: Basis,
    /// Which branches are followed.
    pub transport: Transport,
    /// Lanes whose refracted rays lie within this angle of each other, in radians, stay together.
    pub together: f64,
    /// Camera samples per pixel, on average. With a stop rule, the number of samples that photon counts refer to.
    pub samples: u32,
    /// Where more samples are taken, and where fewer; `None` takes the same number everywhere.
    pub density: Option<SampleDensity>,
    /// When enough samples are taken; `None` takes all of them.
    pub stop: Option<Stop>,
    /// Chooses the set of random numbers.
    pub seed: u64,
    /// How many times a path may leave a diffuse surface. After that, diffuse surfaces are lit by light sampling alone.
    pub diffuse_bounces: u32,
    /// How many times light may leave any surface. What longer paths would have carried is reported.
    pub max_bounces: u32,
    /// Photons for caustics; `None` leaves these to the camera's rays and chance.
    pub light_pass: Option<LightPass>,
    /// What bounces inside a room are aimed at; `None` leaves their directions to the materials.
    pub bright: Option<BrightPlaces>,
    /// Whether light that surfaces send each other is also estimated at vertices of light paths.
    pub light_vertices: bool,
    /// Where light paths of suns and of bright parts of skies start. Paths from the camera find the other light.
    pub sunlit: Vec<SunlitPlaces>,
    /// Openings through which light paths of skies start.
    pub openings: SkyOpenings,
    /// Small highlights at which some samples of their pixels are aimed.
    pub highlights: Vec<Highlight>,
    /// Small lights that the lens blurs, at which some samples are aimed.
    pub lens_lights: Vec<LensLight>,
    /// Whether polarization is traced.
    pub polarization: Polarizing,
}

impl Method {
    /// Returns whether a limit of bounces leaves out light.
    pub(super) fn has_limits(&self) -> bool {
        self.max_bounces < u32::MAX || self.diffuse_bounces < u32::MAX
    }

    /// Returns whether the image stops by its error, which is that of the whole image. Errors then count alike in all
    /// pixels, bright and dark. Otherwise each error is relative to its pixel.
    pub fn judges_the_whole(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.noise.is_some())
    }

    /// Returns how photons are gathered; `None` if they are not.
    pub fn map(&self) -> Option<MapPasses> {
        self.light_pass.as_ref().and_then(|pass| pass.map)
    }

    /// Returns a method of one sample per pixel, by paths of any length from the camera alone, without polarization.
    pub fn of_paths(basis: Basis, transport: Transport, seed: u64) -> Self {
        Self {
            basis,
            transport,
            together: 0.0,
            samples: 1,
            density: None,
            stop: None,
            seed,
            diffuse_bounces: u32::MAX,
            max_bounces: u32::MAX,
            light_pass: None,
            bright: None,
            light_vertices: false,
            sunlit: Vec::new(),
            openings: SkyOpenings::default(),
            highlights: Vec::new(),
            lens_lights: Vec::new(),
            polarization: Polarizing::Averaged,
        }
    }
}

/// Whether polarization is traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Polarizing {
    /// No: light is taken to be unpolarized at every surface.
    #[default]
    Averaged,
    /// Yes.
    Traced,
    /// Paths are those of light that is taken to be unpolarized, and measure how much polarization changes.
    Compared,
}

/// When enough samples are taken: as soon as one of these conditions is met.
///
/// The samples are then those of eight replicates, which are statistically independent renders. The differences between
/// them estimate the noise of their mean. No pixel stops on its own, based on its own samples: that would make it too
/// dark (Kirk & Arvo 1991, *Unbiased Sampling Techniques for Image Synthesis*).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// The relative error of the image that is small enough, of noise and blur: see [`Measured`](super::Measured).
    pub noise: Option<f64>,
    /// Maximum render time.
    pub time: Option<Duration>,
    /// Minimum number of camera samples per pixel for which an error is trusted.
    pub min_samples: u32,
    /// Maximum number of camera samples per pixel, a multiple of eight.
    pub max_samples: u32,
}

/// Photons that are sent to smooth objects, for the caustics that these cast onto what the camera sees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightPass {
    /// Approximate number of photons.
    pub photons: u64,
    /// The lights that send them: point lights, spots, suns, bright parts of sky images, skies through openings, and
    /// finite `emissive` surfaces.
    pub lights: Vec<LightId>,
    /// Openings of a room through which the skies among these lights send all their light.
    pub openings: Vec<Opening>,
    /// How smooth the objects are that photons are sent to.
    pub to: Vec<Smoothness>,
    /// How caustics are found that the camera does not see directly; `None` leaves these to the camera's rays.
    pub map: Option<MapPasses>,
}

impl LightPass {
    /// Returns this pass with its map replaced, if it has one.
    pub(super) fn with_map(&self, other: impl FnOnce(MapPasses) -> MapPasses) -> Self {
        Self { map: self.map.map(other), ..self.clone() }
    }
}

/// Caustics in mirrors, behind glass and on surfaces that caustics light: each pass stores where its photons land, and
/// the camera's paths gather them.
///
/// Hachisuka & Jensen 2009, *Stochastic Progressive Photon Mapping*; Knaus & Zwicker 2011, *Progressive Photon Mapping:
/// A Probabilistic Approach*, for passes that are statistically independent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapPasses {
    /// Number of passes, at most one for each camera sample of a pixel.
    pub count: u32,
    /// Approximate number of photons in each.
    pub photons: u64,
    /// Radius of the gathering kernel, in pixels at the path's length; smaller if a stop rule takes more samples.
    pub radius: f64,
    /// Probability, above 0 and up to 1, of gathering photons where a path can. They also count for the other places.
    pub chance: f64,
}

impl MapPasses {
    /// Returns the approximate number of photons of all passes.
    pub fn all_photons(self) -> u64 {
        u64::from(self.count) * self.photons
    }
}

/// Which of a surface's branches are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Transport {
    /// All of them, until the weight falls below `cutoff`. The weight that is dropped is summed and reported.
    Deterministic {
        /// Smallest weight that is followed.
        cutoff: f64,
        /// Surfaces that one camera sample may hit. Beyond them it continues at random, with the same mean.
        max_sample_surfaces: u64,
    },
    /// All while the weight is above `split`, then one. Below `roulette`, a path survives with chance weight /
    /// roulette.
    Random {
        /// Weight above which all branches are followed and all lights are sampled.
        split: f64,
        /// Weight below which paths are ended at random.
        roulette: f64,
    },
}

impl Transport {
    /// Returns the number of surfaces after which a path is stopped and counted as lost: its light is caught in a clear
    /// body for good.
    ///
    /// Without chance nothing else ends it; with chance, roulette lets one path in 10^32 come as far.
    pub(super) fn max_surfaces(&self) -> u32 {
        match self {
            Self::Deterministic { .. } => 1_000,
            Self::Random { .. } => 100_000,
        }
    }

    /// Returns the name recorded in a file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Deterministic { .. } => "deterministic",
            Self::Random { .. } => "random",
        }
    }
}
