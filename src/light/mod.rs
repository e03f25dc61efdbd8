//! Floor 2: how light is aimed at.
//!
//! Everything that shines is a [`Light`], whether rays meet it or next-event estimation aims at it; both use the same
//! radiance and the same density, so that their weights add up to 1.

mod area;
mod environment;
mod panorama;
mod point;
mod spot;
mod sun;

pub use area::Area;
pub use environment::{Environment, Sky};
pub use panorama::Panorama;
pub use point::Point;
pub use spot::Spot;
pub use sun::Sun;

use crate::math::{Bounds, DVec3, Ray};
use crate::shape::{Emitter, Facing, Sides, Sighting};
use crate::spectrum::{Draw, Lanes, Quantity, Table};

/// Number of a light in its scene.
pub type LightId = usize;

/// Something that shines.
#[derive(Clone, Debug)]
pub enum Light<S> {
    /// A surface that shines.
    Area(Area<S>),
    /// A point that shines evenly.
    Point(Point<S>),
    /// A point that shines into a cone.
    Spot(Spot<S>),
    /// What rays meet that miss everything.
    Environment(Environment<S>),
    /// A disc in the sky.
    Sun(Sun<S>),
}

/// A light as seen along one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Distance to the light; anything nearer hides it.
    pub distance: f64,
    /// The object the light is, which cannot hide itself.
    pub object: Option<u32>,
    /// Density per steradian with which `aim` draws the ray's direction; none if it can draw no other.
    pub pdf: Option<f64>,
    /// Factor on the light's table that makes radiance (or, without a pdf, irradiance at right angles) of it.
    pub factor: f64,
    /// Where it is seen on the image that a surface shows, if it shows one.
    pub uv: [f64; 2],
}

impl<S> Light<S> {
    /// The same light with its spectrum converted.
    pub fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Light<T> {
        match self {
            Self::Area(area) => Light::Area(area.map(convert)),
            Self::Point(point) => Light::Point(point.map(convert)),
            Self::Spot(spot) => Light::Spot(spot.map(convert)),
            Self::Environment(environment) => Light::Environment(environment.map(convert)),
            Self::Sun(sun) => Light::Sun(sun.map(convert)),
        }
    }

    /// The radiance, intensity of a point or a spot, or irradiance of a sun.
    pub fn emission(&self) -> &S {
        match self {
            Self::Area(area) => &area.radiance,
            Self::Point(point) => &point.intensity,
            Self::Spot(spot) => &spot.intensity,
            Self::Environment(environment) => &environment.radiance,
            Self::Sun(sun) => &sun.irradiance,
        }
    }

    /// Whether next-event estimation aims at it; otherwise it shines by being met.
    pub fn is_aimed_at(&self) -> bool {
        match self {
            Self::Area(area) => area.aimed_at,
            Self::Point(_) | Self::Spot(_) | Self::Environment(_) | Self::Sun(_) => true,
        }
    }

    /// A direction from a surface toward the light; `normal` is the surface's unit normal on the lit side.
    pub fn aim(&self, from: DVec3, normal: DVec3, u: [f64; 2]) -> Option<Sighting> {
        match self {
            Self::Area(area) => area.aim(from, normal, u),
            Self::Point(point) => point.aim(from),
            Self::Spot(spot) => spot.aim(from),
            Self::Environment(environment) => Some(environment.aim(normal, u)),
            Self::Sun(sun) => Some(sun.aim(u)),
        }
    }

    /// The light along a ray that leaves a surface of the given normal, if it shines that way.
    ///
    /// `sighting` is what `aim` drew.
    pub fn view(&self, ray: &Ray, normal: DVec3, sighting: &Sighting) -> Option<View> {
        match self {
            Self::Area(area) => area.view(ray, normal, sighting),
            Self::Point(point) => Some(point.view(ray)),
            Self::Spot(spot) => Some(spot.view(ray)),
            Self::Environment(environment) => environment.view(ray, normal),
            Self::Sun(sun) => sun.view(ray),
        }
    }

    /// Whether it is met by rays that meet nothing else.
    pub fn is_sky(&self) -> bool {
        matches!(self, Self::Environment(_) | Self::Sun(_))
    }

    /// Whether it is a sky that looks the same in all directions.
    pub fn is_even_sky(&self) -> bool {
        matches!(self, Self::Environment(environment) if environment.image.is_none())
    }

    /// Whether it has an extent, so that what it sends to a point comes from many directions.
    pub fn is_extended(&self) -> bool {
        match self {
            Self::Area(_) | Self::Environment(_) => true,
            Self::Point(_) | Self::Spot(_) => false,
            Self::Sun(sun) => sun.angular_diameter > 0.0,
        }
    }
}

impl Light<Table> {
    /// What the light sends along a direction toward it, which meets it at `uv`: its emission, lane by lane.
    pub fn toward<const N: usize>(&self, draw: &Draw<N>, direction: DVec3, uv: [f64; 2]) -> Lanes<N> {
        match self {
            Self::Environment(environment) => environment.toward(draw, direction),
            _ => draw.read_at(self.emission(), uv),
        }
    }

    /// The largest irradiance that a sky gives; 0 of other lights.
    pub fn irradiance(&self) -> f64 {
        let brightest = self.emission().range().1.max(0.0);
        match self {
            Self::Area(_) | Self::Point(_) | Self::Spot(_) => 0.0,
            Self::Environment(environment) => brightest * environment.mean() * std::f64::consts::PI,
            Self::Sun(_) => brightest,
        }
    }

    /// The light as one of many that may be aimed at; none if it is a sky, or infinite.
    pub fn emitter(&self) -> Option<Emitter> {
        let emitter = match self {
            Self::Area(area) => area.shape.emitter(area.sides == Sides::Both)?,
            Self::Point(point) => {
                let bounds = Bounds::around([DVec3::from(point.position)]);
                Emitter { bounds, facing: Facing::ALL, both: false, intensity: 1.0 }
            }
            // A spot that shines elsewhere is found dark when it is aimed at.
            Self::Spot(spot) => {
                let bounds = Bounds::around([DVec3::from(spot.position)]);
                Emitter { bounds, facing: Facing::ALL, both: false, intensity: 1.0 }
            }
            Self::Environment(_) | Self::Sun(_) => return None,
        };
        Some(Emitter { intensity: emitter.intensity * self.emission().brightness(), ..emitter })
    }
}
