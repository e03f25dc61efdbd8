use crate::math::{Cone, DVec3, Ray};
use crate::shape::SurfacePoint;

/// Light that may reach a point along one ray, unless something occludes it.
///
/// Its contribution is `factor` times the light's emission, divided by `pdf`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSample {
    /// The ray from the point to the light.
    pub ray: Ray,
    /// Distance to the light along the ray, infinite for a sky. Anything nearer occludes the light.
    pub distance: f64,
    /// The object that is the light, which cannot occlude itself.
    pub object: Option<u32>,
    /// The triangle of the object that is hit, if its other triangles may still occlude it.
    pub part: Option<u32>,
    /// Pdf per steradian of the ray's direction; `None` if no other direction can be drawn.
    pub pdf: Option<f64>,
    /// Factor from the light's emission to radiance or, without a pdf, to irradiance at normal incidence.
    pub factor: f64,
    /// Where the ray hits the image that the light shows, if any.
    pub uv: [f64; 2],
}

impl LightSample {
    /// Creates the sample of a light that lies beyond everything.
    pub(super) fn of_sky(ray: Ray, pdf: Option<f64>, factor: f64) -> Self {
        Self { ray, distance: f64::INFINITY, object: None, part: None, pdf, factor, uv: [0.0; 2] }
    }

    /// Creates the sample of a point that shines with a part of its intensity in each direction; `None` at the point,
    /// or where it is dark.
    pub(super) fn of_point(from: &SurfacePoint, light: DVec3, part: impl Fn(DVec3) -> f64) -> Option<Self> {
        let ray = from.leave((light - from.position).try_normalize()?);
        let distance_squared = (light - ray.origin).length_squared();
        let part = part(-ray.direction);
        let factor = part / distance_squared;
        let distance = distance_squared.sqrt();
        (part > 0.0).then_some(Self { ray, distance, object: None, part: None, pdf: None, factor, uv: [0.0; 2] })
    }
}

/// The start of a photon.
#[derive(Clone, Copy, Debug)]
pub struct LeSample {
    /// Its ray from the light.
    pub ray: Ray,
    /// Factor from the light's emission to flux, before the division by the pdf of the sample.
    pub factor: f64,
    /// The point where it leaves an emissive surface.
    pub surface: Option<EmissionPoint>,
}

/// A point of an emissive surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissionPoint {
    /// The point.
    pub point: SurfacePoint,
    /// Where it lies on the image that the light shows, if any.
    pub uv: [f64; 2],
    /// Pdf of the point per unit of area, if that does not depend on what photons are sent to.
    pub density: Option<f64>,
}

impl EmissionPoint {
    /// Creates a point of a light that emits evenly.
    pub(super) fn without_image(point: SurfacePoint) -> Self {
        Self { point, uv: [0.0; 2], density: None }
    }
}

impl LeSample {
    /// Returns where it starts on the image that the light shows, if any.
    pub fn uv(&self) -> [f64; 2] {
        self.surface.map_or([0.0; 2], |surface| surface.uv)
    }

    /// Samples a photon of a point that shines with a part of its intensity in each direction.
    pub(super) fn of_point(light: DVec3, cone: &Cone, guide_uv: [f64; 2], part: impl Fn(DVec3) -> f64) -> Option<Self> {
        let direction = cone.sample(guide_uv)?;
        Some(Self { ray: Ray { origin: light, direction }, factor: part(direction), surface: None })
    }
}
