//! How light paths start whose vertices paths from the camera look at.
//!
//! Those of lamps start anywhere on them. Those of a sun, or of what is bright in an image of the sky, start toward the
//! places in its light that paths from the camera find: on a disc across that light, densest where such places lie
//! behind. Light beside the disc is left to paths from the camera: of every ray to the sun it is known whether it runs
//! through the disc.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::guide::Guide;
use super::photon_targets::{ball_around_all, started_outside};
use crate::light::{Beam, LeSample, Light, LightId};
use crate::math::{DVec3, Ray};
use crate::scene::Scene;
use crate::shape::Ball;
use crate::spectrum::Table;

/// Places in the light of a sun, or of what is bright in an image of the sky, that paths from the camera find.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SunlitPlaces {
    /// The sun or the sky.
    pub light: LightId,
    /// A ball around nearly all of them.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
    /// The numbers of those cells of a grid across the ball behind which light was found, and how much.
    pub cells: Vec<(u32, f32)>,
}

/// How paths of a light start.
#[derive(Clone, Debug)]
pub(super) enum PathStart {
    /// They do not: its light is left to paths from the camera.
    Nowhere,
    /// Wherever the light leaves it.
    Anywhere,
    /// In a beam from the sky.
    Beam(Box<SkyBeam>),
}

impl PathStart {
    /// Of one light, where places in the light of some are known.
    pub(super) fn of(scene: &Scene<Table>, id: LightId, sunlit: &[SunlitPlaces]) -> Self {
        let flux = scene.lights[id].flux();
        if flux > 0.0 && flux.is_finite() {
            return Self::Anywhere;
        }
        let beam = || SkyBeam::new(scene, sunlit.iter().find(|sunlit| sunlit.light == id)?);
        beam().map_or(Self::Nowhere, |beam| Self::Beam(Box::new(beam)))
    }

    /// The flux of the paths, per emission, about; 0 where there are none.
    pub(super) fn flux(&self, light: &Light<Table>) -> f64 {
        match self {
            Self::Nowhere => 0.0,
            Self::Anywhere => light.flux(),
            Self::Beam(beam) => beam.flux,
        }
    }

    /// The start of a path, for four random numbers; its factor makes flux of the emission. None where the light does
    /// not shine.
    pub(super) fn emit(&self, scene: &Scene<Table>, light: &Light<Table>, u: [f64; 4]) -> Option<LeSample> {
        match self {
            Self::Nowhere => None,
            Self::Anywhere => light.emit(u),
            Self::Beam(beam) => beam.emit(scene, light, u),
        }
    }

    /// Whether paths start along a ray to the light.
    pub(super) fn covers(&self, light: &Light<Table>, ray: &Ray) -> bool {
        match self {
            Self::Nowhere => false,
            Self::Anywhere => true,
            Self::Beam(from) => {
                light.sends_photons_from(ray.direction) && from.beam.place_in_disc(ray.origin, ray.direction).is_some()
            }
        }
    }
}

/// Paths from a sun or a sky, ready to be started.
#[derive(Clone, Debug)]
pub(super) struct SkyBeam {
    beam: Beam,
    guide: Guide,
    /// The flux that is worth sending, per emission: to about the area in which light was found.
    flux: f64,
    /// A ball around all that is finite.
    world: Ball,
}

impl SkyBeam {
    /// None where no light was found, or the light does not come from far away.
    fn new(scene: &Scene<Table>, sunlit: &SunlitPlaces) -> Option<Self> {
        let light = scene.lights.get(sunlit.light).filter(|light| light.is_infinite())?;
        let beam = light.beam(&Ball { center: sunlit.center, radius: sunlit.radius })?;
        let world = ball_around_all(scene)?;
        let guide = Guide::weighted(&sunlit.cells);
        // The disc is a part of the square of the guide.
        let flux = guide.extent() * (4.0 / PI) * beam.flux;
        (flux > 0.0 && flux.is_finite()).then_some(Self { beam, guide, flux, world })
    }

    fn emit(&self, scene: &Scene<Table>, light: &Light<Table>, u: [f64; 4]) -> Option<LeSample> {
        let sample = light.sample_le(&self.beam, self.guide.sample([u[0], u[1]]), [u[2], u[3]])?;
        let factor = sample.factor / light.pdf_le(&self.beam, &sample, |place| self.guide.density(place));
        let ray = started_outside(scene, &self.world, &sample.ray);
        factor.is_finite().then_some(LeSample { ray, factor, ..sample })
    }
}
