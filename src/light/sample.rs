use std::f64::consts::PI;

use crate::math::{Cone, DVec3, Frame, Ray, disk_in_square, square_around_disk};
use crate::shape::{Ball, SurfacePoint};

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
    /// Where the light is met on the image that it shows, if it shows one.
    pub uv: [f64; 2],
}

impl LightSample {
    /// Of a light whose radiance is its emission and that lies beyond everything.
    pub(super) fn of_sky(ray: Ray, pdf: Option<f64>, factor: f64) -> Self {
        Self { ray, distance: f64::INFINITY, object: None, part: None, pdf, factor, uv: [0.0; 2] }
    }

    /// Of a point that shines with a part of its intensity in each direction; none where the surface touches it, or
    /// where it is dark.
    pub(super) fn of_point(from: &SurfacePoint, light: DVec3, part: impl Fn(DVec3) -> f64) -> Option<Self> {
        let ray = from.leave((light - from.position).try_normalize()?);
        let squared = (light - ray.origin).length_squared();
        let part = part(-ray.direction);
        let factor = part / squared;
        let distance = squared.sqrt();
        (part > 0.0).then_some(Self { ray, distance, object: None, part: None, pdf: None, factor, uv: [0.0; 2] })
    }
}

/// How one light sends photons to a ball.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// What they are sent to.
    pub ball: Ball,
    /// Of a light that is a point: the directions that photons take.
    pub cone: Cone,
    /// The flux that it sends to the ball or into the cone, per emission, about.
    pub flux: f64,
    /// Whether the light is apart from the ball, so that a place of the unit square stands for a way to it.
    pub is_apart: bool,
}

impl Beam {
    /// Of light that comes from far away, with an irradiance for its emission.
    pub(super) fn from_sky(ball: &Ball, irradiance: f64) -> Self {
        Self { ball: *ball, cone: Cone::ALL, flux: irradiance * PI * ball.radius * ball.radius, is_apart: true }
    }

    /// The ray of a photon from a unit vector toward the sky, through a disc across the ball; none beside the disc.
    pub(super) fn ray_from_sky(ball: &Ball, toward: DVec3, guide_uv: [f64; 2]) -> Option<Ray> {
        let [x, y] = disk_in_square(guide_uv)?;
        let origin = ball.center + Frame::about(toward).to_world(DVec3::new(x, y, 0.0) * ball.radius);
        Some(Ray { origin, direction: -toward })
    }

    /// Where the way from a point along a unit vector toward the sky runs through the disc across the ball, as a place
    /// of the unit square; none beside it.
    pub(crate) fn place_in_disc(&self, from: DVec3, toward: DVec3) -> Option<[f64; 2]> {
        let local = Frame::about(toward).to_local(from - self.ball.center) / self.ball.radius;
        square_around_disk([local.x, local.y])
    }

    /// How densely `ray_from_sky` draws a ray of a direction from places of a density of their own, per unit of area
    /// across its way; 0 beside the ball.
    pub(super) fn pdf_from_sky(&self, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let radius = self.ball.radius;
        self.place_in_disc(ray.origin, -ray.direction).map_or(0.0, |place| guide(place) / (4.0 * radius * radius))
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
