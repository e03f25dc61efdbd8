use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::{BrightPlaces, SampleDensity, SkyOpenings, Smoothness, SunlitPlaces};
use crate::light::{LightId, Opening};
use crate::spectrum::Basis;

/// How to render, as plain data: what the plan decides and the tracer obeys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Method {
    /// What the lanes stand for.
    pub basis: Basis,
    /// Which branches are followed.
    pub transport: Transport,
    /// Lanes whose refracted rays lie within this angle of each other, in radians, stay together.
    pub together: f64,
    /// Camera samples per pixel, on average; with a stop rule, those that photons are counted for.
    pub samples: u32,
    /// Where more of them are taken, and where fewer; none takes as many everywhere.
    pub density: Option<SampleDensity>,
    /// When enough samples are taken; without, it is all of them.
    pub stop: Option<Stop>,
    /// Chooses the set of random numbers.
    pub seed: u64,
    /// How often light may leave a diffuse surface for another before it is gathered from the lights.
    pub diffuse_bounces: u32,
    /// How often light may leave any surface; what longer paths would have carried is reported.
    pub max_bounces: u32,
    /// Caustics by photons; none leaves them to the camera's rays and chance.
    pub light_pass: Option<LightPass>,
    /// What bounces inside a room are aimed at; none leaves their directions to the materials.
    pub bright: Option<BrightPlaces>,
    /// Whether light that surfaces send each other is also looked for at vertices of paths from the lights.
    pub light_vertices: bool,
    /// Where paths of suns and of bright parts of skies start for that; paths from the camera find the other light.
    pub sunlit: Vec<SunlitPlaces>,
    /// Openings through which paths from skies start for that.
    pub openings: SkyOpenings,
    /// Whether polarization is traced.
    pub polarization: Polarizing,
}

impl Method {
    /// Whether light is left out that surfaces send on more often than they may.
    pub(super) fn has_limits(&self) -> bool {
        self.max_bounces < u32::MAX || self.diffuse_bounces < u32::MAX
    }

    /// Whether the image ends by its error, which is of the whole: then errors count alike in all pixels, bright and
    /// dark. Else each counts relative to its pixel.
    pub fn judges_the_whole(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.noise.is_some())
    }

    /// How photons are gathered; none where they are not.
    pub fn map(&self) -> Option<MapPasses> {
        self.light_pass.as_ref().and_then(|pass| pass.map)
    }

    /// One sample of each pixel by paths of any length from the camera alone, without polarization.
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
            polarization: Polarizing::Averaged,
        }
    }
}

/// Whether polarization is traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Polarizing {
    /// No: light is taken for unpolarized at every surface.
    #[default]
    Averaged,
    /// Yes.
    Traced,
    /// Paths are those of light that is taken for unpolarized, and are told how much polarization changes.
    Compared,
}

/// When enough samples are taken: as soon as one of these says so.
///
/// The samples are then those of eight replicates, renders that know nothing of each other: how far these are apart
/// tells the noise of their mean. No pixel stops by itself, on what its own samples say: that would make it too dark
/// (Kirk & Arvo 1991, *Unbiased Sampling Techniques for Image Synthesis*).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// The relative error of the image that is enough, of noise and blur: see [`Measured`](super::Measured).
    pub noise: Option<f64>,
    /// How long it may render.
    pub time: Option<Duration>,
    /// Fewest camera samples per pixel that an error is believed of.
    pub least: u32,
    /// Most camera samples per pixel; they are a multiple of eight.
    pub most: u32,
}

/// Photons that are sent to smooth objects, for the light that these throw onto what the camera sees.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LightPass {
    /// How many, about.
    pub photons: u64,
    /// The lights that send them: points, spots, suns, what is bright in an image of the sky, skies through openings,
    /// and finite `emissive` surfaces.
    pub lights: Vec<LightId>,
    /// Openings of a room through which skies among these lights send all their light.
    pub openings: Vec<Opening>,
    /// How smooth the objects are that they are sent to.
    pub to: Vec<Smoothness>,
    /// How caustics are found that the camera does not see straight; none leaves them to the camera's rays.
    pub map: Option<MapPasses>,
}

impl LightPass {
    /// This pass with another map, where it has one.
    pub(super) fn with_map(&self, other: impl FnOnce(MapPasses) -> MapPasses) -> Self {
        Self { map: self.map.map(other), ..self.clone() }
    }
}

/// Caustics in mirrors, behind glass and lit surfaces: each pass keeps where its photons land, and the camera's paths
/// gather them.
///
/// Hachisuka & Jensen 2009, *Stochastic Progressive Photon Mapping*; Knaus & Zwicker 2011, *Progressive Photon Mapping:
/// A Probabilistic Approach*, for passes that know nothing of each other.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapPasses {
    /// How many, at most one for each camera sample of a pixel.
    pub count: u32,
    /// Photons of each, about.
    pub photons: u64,
    /// Radius of gathered photons in pixels at the path's length; smaller where a stop rule takes more samples.
    pub radius: f64,
    /// The chance that photons are gathered at a place that a path reaches, above 0 to 1; they count for the others.
    pub chance: f64,
}

impl MapPasses {
    /// Photons of all of them, about.
    pub fn all_photons(self) -> u64 {
        u64::from(self.count) * self.photons
    }
}

/// Which of a surface's branches are followed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Transport {
    /// All of them, until the weight falls below `cutoff`; what is dropped is summed and reported.
    Deterministic {
        /// Smallest weight that is followed.
        cutoff: f64,
        /// Surfaces that one camera sample may hit; beyond them it goes on by chance, to the same mean.
        most: u64,
    },
    /// All while the weight is above `split`, then one; below `roulette` a path survives with weight / roulette.
    Random {
        /// Weight above which all branches are followed and all lights are aimed at.
        split: f64,
        /// Weight below which paths are ended at random.
        roulette: f64,
    },
}

impl Transport {
    /// Surfaces after which a path is stopped and counted as lost: light caught in a clear body for good.
    ///
    /// Without chance nothing else ends it; with chance, roulette lets one path in 10^32 come as far.
    pub(super) fn last_vertex(&self) -> u32 {
        match self {
            Self::Deterministic { .. } => 1_000,
            Self::Random { .. } => 100_000,
        }
    }

    /// The name recorded in a file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Deterministic { .. } => "deterministic",
            Self::Random { .. } => "random",
        }
    }
}
