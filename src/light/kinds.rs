//! A light of any kind.

use std::f64::consts::PI;

use super::{Area, Beam, Environment, LeSample, LightBounds, LightSample, Opening, Point, SkyPolarization, Spot, Sun};
use crate::math::{DVec3, Ray};
use crate::shape::{Ball, Intersection, Sides, SurfacePoint};
use crate::spectrum::{Draw, Lanes, Quantity, Table};

/// Number of a light in its scene.
pub type LightId = usize;

/// Something that shines.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Light<S> {
    /// A surface that shines.
    Area(Area<S>),
    /// A point that shines equally in all directions.
    Point(Point<S>),
    /// A point that shines into a cone.
    Spot(Spot<S>),
    /// What rays see that miss everything.
    Environment(Environment<S>),
    /// A disc in the sky.
    Sun(Sun<S>),
}

impl<S> Light<S> {
    /// Returns the light with its spectrum converted.
    pub fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Light<T> {
        match self {
            Self::Area(area) => Light::Area(area.map(convert)),
            Self::Point(point) => Light::Point(point.map(convert)),
            Self::Spot(spot) => Light::Spot(spot.map(convert)),
            Self::Environment(environment) => Light::Environment(environment.map(convert)),
            Self::Sun(sun) => Light::Sun(sun.map(convert)),
        }
    }

    /// Returns the radiance, the intensity of a point or a spot, or the irradiance of a sun.
    pub fn emission(&self) -> &S {
        match self {
            Self::Area(area) => &area.radiance,
            Self::Point(point) => &point.intensity,
            Self::Spot(spot) => &spot.intensity,
            Self::Environment(environment) => &environment.radiance,
            Self::Sun(sun) => &sun.irradiance,
        }
    }

    /// Returns the polarization of its light; `None` if it is unpolarized.
    pub fn polarization(&self) -> Option<&SkyPolarization> {
        if let Self::Environment(environment) = self { environment.polarization.as_ref() } else { None }
    }

    /// Returns whether next-event estimation samples it; otherwise its light is only found by hitting it.
    pub fn is_sampled(&self) -> bool {
        if let Self::Area(area) = self { area.is_sampled } else { true }
    }

    /// Returns whether one of several parts is chosen before a direction, which uses digits of the first random number.
    pub fn has_parts(&self) -> bool {
        if let Self::Area(area) = self { area.has_parts() } else { false }
    }

    /// Samples a ray from a point of a surface toward the light; `None` if the light does not shine that way, or if an
    /// area lies below the surface's horizon there. `normal` is the unit normal on the lit side, toward which most
    /// samples lead.
    pub fn sample_li(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        match self {
            Self::Area(area) => area.sample_li(from, normal, u),
            Self::Point(point) => LightSample::of_point(from, point.position.into(), |_| 1.0),
            Self::Spot(spot) => LightSample::of_point(from, spot.position.into(), |direction| spot.falloff(direction)),
            Self::Environment(environment) => environment.sample_li(from, normal, u),
            Self::Sun(sun) => Some(sun.sample_li(from, u)),
        }
    }

    /// Samples the light like `sample_li`, but the caller has to test whether other triangles occlude its `part`.
    pub fn sample_li_in_part(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        if let Self::Area(area) = self {
            area.sample_li_in_part(from, normal, u)
        } else {
            self.sample_li(from, normal, u)
        }
    }

    /// Returns the pdf per steradian with which `sample_li` draws the direction of a ray that leaves a surface with the
    /// given unit normal; `None` if it cannot. `intersection` is where the ray first hits an emissive surface, if
    /// known.
    pub fn pdf_li(&self, ray: &Ray, normal: DVec3, intersection: Option<&Intersection>) -> Option<f64> {
        match self {
            Self::Area(area) if area.is_sampled => match intersection {
                Some(intersection) => area.pdf_at(ray, normal, intersection),
                None => area.pdf_at(ray, normal, &area.shape.intersect(ray, f64::INFINITY)?),
            },
            Self::Environment(environment) => Some(environment.pdf(ray.direction, normal)),
            Self::Sun(sun) => sun.pdf(ray),
            Self::Area(_) | Self::Point(_) | Self::Spot(_) => None,
        }
    }

    /// Returns whether photons can be sent from it.
    pub fn sends_photons(&self) -> bool {
        match self {
            Self::Area(area) => area.sends_photons(),
            Self::Environment(environment) => environment.bright_part().is_some(),
            Self::Point(_) | Self::Spot(_) | Self::Sun(_) => true,
        }
    }

    /// Returns whether photons can be sent from it through openings, as from a sky that is not polarized.
    pub fn sends_photons_through_openings(&self) -> bool {
        matches!(self, Self::Environment(environment) if environment.polarization.is_none())
    }

    /// Returns whether photons can be sent from it in a room with these openings. Through openings, skies send all
    /// light but that of their bright parts.
    pub fn sends_photons_with(&self, openings: &[Opening]) -> bool {
        self.sends_photons() || (!openings.is_empty() && self.sends_photons_through_openings())
    }

    /// Returns the mean radiance of a sky for an emission of 1; 0 for other lights.
    pub fn mean_radiance(&self) -> f64 {
        if let Self::Environment(environment) = self { environment.mean() } else { 0.0 }
    }

    /// Returns whether photons carry what it emits along a direction toward it, wherever that light goes, if it sends
    /// photons at all.
    pub fn sends_photons_from(&self, direction: DVec3) -> bool {
        if let Self::Environment(environment) = self { environment.is_bright(direction) } else { true }
    }

    /// Returns the direction toward the center of a sun, or a random one toward the bright part of a sky; `None` for
    /// other lights.
    pub(crate) fn bright_direction(&self, u: [f64; 2]) -> Option<DVec3> {
        match self {
            Self::Sun(sun) => Some(sun.center_direction()),
            Self::Environment(environment) => Some(environment.sample_bright(u)?.0),
            Self::Area(_) | Self::Point(_) | Self::Spot(_) => None,
        }
    }

    /// Returns how photons are sent to a ball; `None` if the light sends none there.
    pub fn beam(&self, ball: &Ball) -> Option<Beam> {
        let beam = match self {
            Self::Area(area) => area.beam(ball),
            Self::Point(point) => point.beam(ball),
            Self::Spot(spot) => spot.beam(ball),
            Self::Sun(_) => Beam::from_sky(ball, 1.0),
            Self::Environment(environment) => environment.beam(ball)?,
        };
        Some(beam).filter(|beam| beam.flux > 0.0)
    }

    /// Returns how photons of a sky are sent to a ball through an opening; `None` for other lights, or if the sky sends
    /// none there.
    pub fn beam_through(&self, opening: &Opening, ball: &Ball) -> Option<Beam> {
        let Self::Environment(environment) = self else { return None };
        environment.beam_through(opening, ball).filter(|beam| beam.flux > 0.0)
    }

    /// Samples the start of a photon; `None` where the light is dark. `guide_uv` is the place in the unit square that
    /// stands for the photon's way.
    pub fn sample_le(&self, beam: &Beam, guide_uv: [f64; 2], u: [f64; 2]) -> Option<LeSample> {
        match self {
            Self::Area(area) => area.sample_le(&beam.ball, guide_uv, u),
            Self::Point(point) => LeSample::of_point(point.position.into(), &beam.cone, guide_uv, |_| 1.0),
            Self::Spot(spot) => LeSample::of_point(spot.position.into(), &beam.cone, guide_uv, |way| spot.falloff(way)),
            Self::Sun(sun) => sun.sample_le(&beam.ball, guide_uv, u),
            Self::Environment(environment) => environment.sample_le(beam, guide_uv, u),
        }
    }

    /// Returns the pdf with which `sample_le` draws the start of a photon of this light for a beam, which may differ
    /// from the photon's own; 0 if it cannot. `guide` is the density of places in the unit square.
    pub fn pdf_le(&self, beam: &Beam, sample: &LeSample, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        match self {
            Self::Area(area) => area.pdf_le(&beam.ball, sample, guide),
            Self::Point(_) | Self::Spot(_) => beam.cone.pdf(sample.ray.direction, guide),
            Self::Sun(_) => beam.pdf_from_sky(&sample.ray, guide),
            Self::Environment(environment) => environment.pdf_le(beam, &sample.ray, guide),
        }
    }

    /// Samples the start of a light path toward anything. Its factor converts the emission to flux. `None` where the
    /// light does not shine, and for an environment or a sun.
    pub fn emit(&self, u: [f64; 4]) -> Option<LeSample> {
        match self {
            Self::Area(area) => area.emit(u),
            Self::Point(point) => Some(point.emit([u[0], u[1]])),
            Self::Spot(spot) => spot.emit([u[0], u[1]]),
            Self::Environment(_) | Self::Sun(_) => None,
        }
    }

    /// Estimates the flux that `emit` sends for an emission of 1; 0 if it sends nothing, or not all of the light.
    pub fn flux(&self) -> f64 {
        match self {
            Self::Area(area) => area.flux(),
            Self::Point(_) => 4.0 * PI,
            Self::Spot(spot) => 2.0 * PI * spot.cone().one_minus_cos,
            Self::Environment(_) | Self::Sun(_) => 0.0,
        }
    }

    /// Returns what a scene file calls such a light.
    pub fn kind_name(&self) -> &'static str {
        match self {
            Self::Area(_) => "emissive",
            Self::Environment(_) => "environment",
            Self::Point(_) => "point",
            Self::Spot(_) => "spot",
            Self::Sun(_) => "sun",
        }
    }

    /// Returns whether it is hit by rays that hit nothing else.
    pub fn is_infinite(&self) -> bool {
        matches!(self, Self::Environment(_) | Self::Sun(_))
    }

    /// Returns whether it is a sky that looks the same in all directions.
    pub fn is_even_sky(&self) -> bool {
        matches!(self, Self::Environment(environment) if environment.image.is_none())
    }

    /// Returns whether it has an extent, so that its light reaches a point from many directions.
    pub fn is_extended(&self) -> bool {
        match self {
            Self::Area(_) | Self::Environment(_) => true,
            Self::Point(_) | Self::Spot(_) => false,
            Self::Sun(sun) => sun.angular_diameter > 0.0,
        }
    }
}

impl Light<Table> {
    /// Returns the emission along a direction toward the light, which hits it at `uv`, lane by lane.
    pub fn toward<const N: usize>(&self, draw: &Draw<N>, direction: DVec3, uv: [f64; 2]) -> Lanes<N> {
        match self {
            Self::Environment(environment) => environment.toward(draw, direction),
            _ => draw.read_at(self.emission(), uv),
        }
    }

    /// Returns the mean brightness of the image on a lamp, which may be a small part of the image file.
    pub fn image_brightness(&self) -> Option<f64> {
        if let Self::Area(area) = self { area.emission_map().map(|map| map.mean) } else { None }
    }

    /// Returns the largest irradiance from a sky; 0 for other lights.
    pub fn irradiance(&self) -> f64 {
        let brightest = || self.emission().range().1.max(0.0);
        match self {
            Self::Area(_) | Self::Point(_) | Self::Spot(_) => 0.0,
            Self::Environment(environment) => brightest() * environment.mean() * PI,
            Self::Sun(_) => brightest(),
        }
    }

    /// Returns the light's place, orientation and intensity for a light tree; `None` if the light is infinite.
    pub fn bounds(&self) -> Option<LightBounds> {
        let bounds = match self {
            Self::Area(area) => LightBounds::of_shape(&area.shape, area.sides == Sides::Both)?,
            Self::Point(point) => LightBounds::of_point(point.position.into()),
            // A spot that shines elsewhere turns out to be dark when it is sampled.
            Self::Spot(spot) => LightBounds::of_point(spot.position.into()),
            Self::Environment(_) | Self::Sun(_) => return None,
        };
        let brightness = match self.image_brightness() {
            Some(mean) => mean * self.emission().range().1.max(0.0),
            None => self.emission().brightness(),
        };
        Some(LightBounds { intensity: bounds.intensity * brightness, ..bounds })
    }
}
