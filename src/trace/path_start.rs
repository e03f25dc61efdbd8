//! How light paths start, to whose vertices paths from the camera connect.
//!
//! Paths of lamps start anywhere on them. Paths of a sun, or of the bright parts of a sky image, start toward the
//! sunlit places that paths from the camera find. They start on a disk across the light, most densely where such places
//! lie behind it. All other light of a sky starts through the openings of a room. Light outside the disk and the
//! openings is left to paths from the camera: for every ray to the sun or the sky, it is known whether it passes
//! through them.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::guide::Guide;
use super::photon_targets::{ball_around_all, started_outside};
use crate::light::{Beam, LeSample, Light, LightId, Opening};
use crate::math::{DVec3, Ray};
use crate::scene::Scene;
use crate::shape::Ball;
use crate::spectrum::Table;

/// Places lit by a sun, or by the bright parts of a sky image, that paths from the camera find.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SunlitPlaces {
    /// The sun or the sky.
    pub light: LightId,
    /// The center of a ball around nearly all of the places.
    pub center: DVec3,
    /// The radius of the ball.
    pub radius: f64,
    /// The cells of a grid across the ball behind which light was found: the number of each, and how much light.
    pub cells: Vec<(u32, f32)>,
}

/// Openings of a room through which light paths of skies start.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SkyOpenings {
    /// The openings.
    pub openings: Vec<Opening>,
    /// Rough share of the skies' light in the room that arrives by other ways, 0 to 1.
    pub missed: f64,
}

/// How the paths of a light start.
#[derive(Clone, Debug)]
pub(super) enum PathStart {
    /// Nowhere: its light is left to paths from the camera.
    Nowhere,
    /// Wherever the light emits.
    Anywhere,
    /// From a sun or a sky.
    Sky(Box<SkyStart>),
}

impl PathStart {
    /// Returns the start of one light's paths, given the sunlit places of some lights and the openings of a room.
    pub(super) fn for_light(scene: &Scene<Table>, id: LightId, sunlit: &[SunlitPlaces], openings: &[Opening]) -> Self {
        let flux = scene.lights[id].flux();
        if flux > 0.0 && flux.is_finite() {
            return Self::Anywhere;
        }
        SkyStart::new(scene, id, sunlit, openings).map_or(Self::Nowhere, |start| Self::Sky(Box::new(start)))
    }

    /// Returns the approximate flux of the paths per unit of emission; 0 if there are none.
    pub(super) fn flux(&self, light: &Light<Table>) -> f64 {
        match self {
            Self::Nowhere => 0.0,
            Self::Anywhere => light.flux(),
            Self::Sky(start) => start.beam_flux() + start.opening_flux,
        }
    }

    /// Samples the start of a path. Its factor turns emission into flux. Returns `None` where the light is dark.
    pub(super) fn emit(&self, scene: &Scene<Table>, light: &Light<Table>, u: [f64; 4]) -> Option<LeSample> {
        match self {
            Self::Nowhere => None,
            Self::Anywhere => light.emit(u),
            Self::Sky(start) => start.emit(scene, light, u),
        }
    }

    /// Returns whether paths start with all light that may matter, except for light outside a beam or openings.
    pub(super) fn finds_most(&self, light: &Light<Table>) -> bool {
        match self {
            Self::Nowhere => false,
            Self::Anywhere => true,
            Self::Sky(start) => {
                (start.beam.is_some() || !light.sends_photons())
                    && (!start.openings.is_empty() || !light.sends_photons_through_openings())
            }
        }
    }

    /// Returns whether paths start along a ray to the light.
    pub(super) fn covers(&self, light: &Light<Table>, ray: &Ray) -> bool {
        match self {
            Self::Nowhere => false,
            Self::Anywhere => true,
            Self::Sky(start) => start.covers(light, ray),
        }
    }
}

/// The starts of paths from a sun or a sky.
#[derive(Clone, Debug)]
pub(super) struct SkyStart {
    /// The beam of a sun, or of the bright parts of a sky image.
    beam: Option<SkyBeam>,
    /// Openings through which all other light of a sky starts.
    openings: Vec<Opening>,
    /// Approximate flux through the openings, per unit of emission.
    opening_flux: f64,
    /// A ball around everything finite.
    scene_ball: Ball,
}

/// A beam, and where in it paths start.
#[derive(Clone, Debug)]
struct SkyBeam {
    beam: Beam,
    guide: Guide,
    /// The flux that is worth sending, per unit of emission: toward about the area in which light was found.
    flux: f64,
}

impl SkyStart {
    /// Returns `None` if neither light nor an opening was found, or if the light is not infinitely far away.
    fn new(scene: &Scene<Table>, id: LightId, sunlit: &[SunlitPlaces], openings: &[Opening]) -> Option<Self> {
        let light = scene.lights.get(id).filter(|light| light.is_infinite())?;
        let sunlit = sunlit.iter().find(|sunlit| sunlit.light == id);
        let beam = sunlit.and_then(|sunlit| SkyBeam::new(light, sunlit));
        let openings = if light.sends_photons_through_openings() { openings.to_vec() } else { Vec::new() };
        let opening_flux = light.mean_radiance() * PI * openings.iter().map(Opening::area).sum::<f64>();
        let start = Self { beam, openings, opening_flux, scene_ball: ball_around_all(scene)? };
        (start.beam_flux() + opening_flux > 0.0).then_some(start)
    }

    fn beam_flux(&self) -> f64 {
        self.beam.as_ref().map_or(0.0, |beam| beam.flux)
    }

    fn emit(&self, scene: &Scene<Table>, light: &Light<Table>, [a, b, c, d]: [f64; 4]) -> Option<LeSample> {
        let share = self.beam_flux() / (self.beam_flux() + self.opening_flux);
        let (sample, chance) = match &self.beam {
            Some(beam) if c < share => (beam.emit(light, [a, b, c / share, d])?, share),
            _ => {
                let (ray, pdf) = Opening::ray_through(&self.openings, [a, b, (c - share) / (1.0 - share), d])?;
                let is_sent = !light.sends_photons_from(-ray.direction);
                (LeSample { ray, factor: 1.0 / pdf, surface: None }, if is_sent { 1.0 - share } else { 0.0 })
            }
        };
        let (ray, factor) = (started_outside(scene, &self.scene_ball, &sample.ray), sample.factor / chance);
        factor.is_finite().then_some(LeSample { ray, factor, ..sample })
    }

    fn covers(&self, light: &Light<Table>, ray: &Ray) -> bool {
        if light.sends_photons_from(ray.direction) {
            return self.beam.as_ref().is_some_and(|of| of.beam.place_in_disc(ray.origin, ray.direction).is_some());
        }
        let reversed_ray = Ray { direction: -ray.direction, ..*ray };
        self.openings.iter().any(|opening| opening.is_entered_by(&reversed_ray))
    }
}

impl SkyBeam {
    /// Returns `None` if no light was found.
    fn new(light: &Light<Table>, sunlit: &SunlitPlaces) -> Option<Self> {
        let beam = light.beam(&Ball { center: sunlit.center, radius: sunlit.radius })?;
        let guide = Guide::from_weights(&sunlit.cells);
        // The disk covers only a part of the guide's square.
        let flux = guide.extent() * (4.0 / PI) * beam.flux;
        (flux > 0.0 && flux.is_finite()).then_some(Self { beam, guide, flux })
    }

    fn emit(&self, light: &Light<Table>, u: [f64; 4]) -> Option<LeSample> {
        let sample = light.sample_le(&self.beam, self.guide.sample([u[0], u[1]]), [u[2], u[3]])?;
        let factor = sample.factor / light.pdf_le(&self.beam, &sample, |place| self.guide.density(place));
        Some(LeSample { factor, ..sample })
    }
}
