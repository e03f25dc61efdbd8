use std::f64::consts::{PI, TAU};

use super::Opening;
use super::toward_ball::TowardBall;
use crate::math::{Cone, DVec3, Frame, Ray, disk_in_square, square_around_disk};
use crate::shape::Ball;

/// How one light sends photons to a ball.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// What they are sent to.
    pub ball: Ball,
    /// Of a light that is a point: the directions that photons take.
    pub cone: Cone,
    /// Of a sky: the opening through which they come, if it is one.
    pub opening: Option<Opening>,
    /// The flux that it sends to the ball or into the cone, per emission, about.
    pub flux: f64,
    /// Whether the light is apart from the ball, so that a place of the unit square stands for a way to it.
    pub is_apart: bool,
}

impl Beam {
    /// Of light that comes from far away, with an irradiance for its emission.
    pub(super) fn from_sky(ball: &Ball, irradiance: f64) -> Self {
        let flux = irradiance * PI * ball.radius * ball.radius;
        Self { ball: *ball, cone: Cone::ALL, opening: None, flux, is_apart: true }
    }

    /// Of a sky's light that comes through an opening, with a mean radiance for its emission.
    pub(super) fn through(opening: &Opening, ball: &Ball, radiance: f64) -> Self {
        let TowardBall { from, normal, .. } = opening.toward(ball, opening.center);
        let cone = ball.cone_from(from);
        let seen = if cone.is_all() { PI } else { TAU * cone.one_minus_cos * cone.axis.dot(normal).abs() };
        let flux = radiance * opening.area() * seen;
        let [u, v] = opening.half;
        let is_apart = (ball.center - from).length() > ball.radius + (u.length_squared() + v.length_squared()).sqrt();
        Self { ball: *ball, cone: Cone::ALL, opening: Some(*opening), flux, is_apart }
    }

    /// The ray of a photon from a unit vector toward the sky, through a disc across the ball; none beside the disc.
    pub(super) fn ray_from_sky(ball: &Ball, toward: DVec3, guide_uv: [f64; 2]) -> Option<Ray> {
        let [x, y] = disk_in_square(guide_uv)?;
        let origin = ball.center + Frame::about(toward).to_world(DVec3::new(x, y, 0.0) * ball.radius);
        Some(Ray { origin, direction: -toward })
    }

    /// The place of the unit square where the way from a point toward the sky runs through the disc; none beside it.
    pub(crate) fn place_in_disc(&self, from: DVec3, toward: DVec3) -> Option<[f64; 2]> {
        let local = Frame::about(toward).to_local(from - self.ball.center) / self.ball.radius;
        square_around_disk([local.x, local.y])
    }

    /// How densely the ray of a photon from the sky is drawn from places of a density of their own: per unit of area
    /// across its way, and through an opening per steradian as well; 0 of one that does not lead to the ball.
    pub(super) fn pdf_from_sky(&self, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        if let Some(opening) = &self.opening {
            return opening.pdf_toward(&self.ball, ray, guide);
        }
        let radius = self.ball.radius;
        self.place_in_disc(ray.origin, -ray.direction).map_or(0.0, |place| guide(place) / (4.0 * radius * radius))
    }
}
