use std::f64::consts::PI;

use crate::math::{DVec3, sample_cosine_about};
use crate::shape::Ball;

/// How a photon leaves a point of a surface toward a ball: in the cone that the ball subtends or, from inside of the
/// ball, cosine-distributed.
pub(super) struct TowardBall<'a> {
    pub(super) ball: &'a Ball,
    pub(super) from: DVec3,
    pub(super) normal: DVec3,
    /// From inside of the ball, the probability of leaving on the side of the normal.
    pub(super) front_probability: f64,
}

impl TowardBall<'_> {
    /// Returns the direction for a place of the unit square.
    pub(super) fn sample(&self, [a, b]: [f64; 2]) -> Option<DVec3> {
        let (front_probability, cone) = (self.front_probability, self.ball.cone_from(self.from));
        if !cone.is_all() {
            return cone.sample([a, b]);
        }
        let (side, a) = if a < front_probability {
            (self.normal, a / front_probability)
        } else {
            (-self.normal, (a - front_probability) / (1.0 - front_probability))
        };
        Some(sample_cosine_about(side, [a, b]))
    }

    /// Returns the pdf per steradian with which `sample` draws a direction. `guide` is the density of places in the
    /// unit square.
    pub(super) fn pdf(&self, direction: DVec3, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let cone = self.ball.cone_from(self.from);
        if !cone.is_all() {
            return cone.pdf(direction, guide);
        }
        let cos = self.normal.dot(direction);
        let side = if cos > 0.0 { self.front_probability } else { 1.0 - self.front_probability };
        side * cos.abs() / PI
    }
}
