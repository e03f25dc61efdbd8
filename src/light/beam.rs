use std::f64::consts::{PI, TAU};

use super::Opening;
use super::toward_ball::TowardBall;
use crate::math::{Cone, DVec3, Frame, Ray, disk_to_square, square_to_disk};
use crate::shape::Ball;

/// How one light sends photons to a ball.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// The ball to which photons are sent.
    pub ball: Ball,
    /// For a point light, the directions that photons take.
    pub cone: Cone,
    /// For a sky, the opening through which photons come, if any.
    pub opening: Option<Opening>,
    /// Estimated flux that it sends to the ball or into the cone, for an emission of 1.
    pub flux: f64,
    /// Whether the light lies apart from the ball, so that a place of the unit square stands for one way to it.
    pub is_outside_ball: bool,
}

impl Beam {
    /// Creates the beam of a light far away, with the irradiance for an emission of 1.
    pub(super) fn from_sky(ball: &Ball, irradiance: f64) -> Self {
        let flux = irradiance * PI * ball.radius * ball.radius;
        Self { ball: *ball, cone: Cone::ALL, opening: None, flux, is_outside_ball: true }
    }

    /// Creates the beam of a sky through an opening, with the mean radiance for an emission of 1.
    pub(super) fn through(opening: &Opening, ball: &Ball, radiance: f64) -> Self {
        let TowardBall { from, normal, .. } = opening.toward(ball, opening.center);
        let cone = ball.cone_from(from);
        let seen = if cone.is_all() { PI } else { TAU * cone.one_minus_cos * cone.axis.dot(normal).abs() };
        let flux = radiance * opening.area() * seen;
        let [u, v] = opening.half;
        let is_outside_ball =
            (ball.center - from).length() > ball.radius + (u.length_squared() + v.length_squared()).sqrt();
        Self { ball: *ball, cone: Cone::ALL, opening: Some(*opening), flux, is_outside_ball }
    }

    /// Returns the ray of a photon that comes from the unit vector `toward` the sky, through a disc across the ball;
    /// `None` if `guide_uv` lies beside the disc.
    pub(super) fn ray_from_sky(ball: &Ball, toward: DVec3, guide_uv: [f64; 2]) -> Option<Ray> {
        let [x, y] = square_to_disk(guide_uv)?;
        let origin = ball.center + Frame::about(toward).to_world(DVec3::new(x, y, 0.0) * ball.radius);
        Some(Ray { origin, direction: -toward })
    }

    /// Returns the place of the unit square where the line from a point to the sky crosses the disc; `None` beside it.
    pub(crate) fn place_in_disc(&self, from: DVec3, toward: DVec3) -> Option<[f64; 2]> {
        let local = Frame::about(toward).to_local(from - self.ball.center) / self.ball.radius;
        disk_to_square([local.x, local.y])
    }

    /// Returns the pdf of a photon's ray from the sky: per unit of area across the ray and, through an opening, per
    /// steradian as well; 0 for a ray that does not lead to the ball. `guide` is the density of places in the unit
    /// square.
    pub(super) fn pdf_from_sky(&self, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        if let Some(opening) = &self.opening {
            return opening.pdf_toward(&self.ball, ray, guide);
        }
        let radius = self.ball.radius;
        self.place_in_disc(ray.origin, -ray.direction).map_or(0.0, |place| guide(place) / (4.0 * radius * radius))
    }
}
