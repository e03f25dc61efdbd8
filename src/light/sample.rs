use crate::math::{Cone, DVec3, Ray};
use crate::shape::SurfacePoint;

/// Light that may reach a point along one ray, unless something hides it.
///
/// What it brings is `factor` times the light's emission, per unit of `pdf`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// From the point to the light.
    pub ray: Ray,
    /// Distance to the light along the ray, infinite for a sky: what is nearer hides it.
    pub distance: f64,
    /// The object that the light is, which cannot hide itself.
    pub object: Option<u32>,
    /// The triangle of that object, where others may still hide it.
    pub part: Option<u32>,
    /// Density per steradian with which the ray's direction is drawn; none where no other can be drawn.
    pub pdf: Option<f64>,
    /// Factor on the light's emission that makes radiance of it or, without a pdf, irradiance at right angles.
    pub factor: f64,
    /// Where the light is hit on the image that it shows, if it shows one.
    pub uv: [f64; 2],
}

impl LightSample {
    /// Of a light whose radiance is its emission and that lies beyond everything.
    pub(super) fn of_sky(ray: Ray, pdf: Option<f64>, factor: f64) -> Self {
        Self { ray, distance: f64::INFINITY, object: None, part: None, pdf, factor, uv: [0.0; 2] }
    }

    /// Of a point that shines by a part of its intensity in each direction; none at the point, or where it is dark.
    pub(super) fn of_point(from: &SurfacePoint, light: DVec3, part: impl Fn(DVec3) -> f64) -> Option<Self> {
        let ray = from.leave((light - from.position).try_normalize()?);
        let squared = (light - ray.origin).length_squared();
        let part = part(-ray.direction);
        let factor = part / squared;
        let distance = squared.sqrt();
        (part > 0.0).then_some(Self { ray, distance, object: None, part: None, pdf: None, factor, uv: [0.0; 2] })
    }
}

/// The start of a photon.
#[derive(Clone, Copy, Debug)]
pub struct LeSample {
    /// Its way from the light.
    pub ray: Ray,
    /// The factor on the light's emission that makes flux of it, over the density of the sample.
    pub factor: f64,
    /// Where it leaves a surface that shines.
    pub surface: Option<EmissionPoint>,
}

/// A point of a surface that shines.
#[derive(Clone, Copy, Debug)]
pub struct EmissionPoint {
    /// The point.
    pub point: SurfacePoint,
    /// Where it lies on the image that the light shows, if it shows one.
    pub uv: [f64; 2],
    /// How many such points are drawn per unit of area, where that does not depend on what photons are sent to.
    pub density: Option<f64>,
}

impl EmissionPoint {
    /// Of a light that shines everywhere alike.
    pub(super) fn of_even(point: SurfacePoint) -> Self {
        Self { point, uv: [0.0; 2], density: None }
    }
}

impl LeSample {
    /// Where it starts on the image that the light shows, if it shows one.
    pub fn uv(&self) -> [f64; 2] {
        self.surface.map_or([0.0; 2], |surface| surface.uv)
    }

    /// Of a point that shines with a part of its intensity in each direction.
    pub(super) fn of_point(light: DVec3, cone: &Cone, guide_uv: [f64; 2], part: impl Fn(DVec3) -> f64) -> Option<Self> {
        let direction = cone.sample(guide_uv)?;
        Some(Self { ray: Ray { origin: light, direction }, factor: part(direction), surface: None })
    }
}
