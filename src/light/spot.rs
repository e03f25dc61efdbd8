use std::f64::consts::TAU;

use super::{Beam, LeSample};
use crate::math::{Cone, DVec3, Ray, unit};
use crate::shape::Ball;
use crate::spectrum::Quantity;

/// A point that shines into a cone and dims toward the cone's edge; rays never hit it.
///
/// ```toml
/// [[light]]
/// spot = { position = [0, 3, 0], toward = [0, -1, 0], cone_angle = 40, intensity = 10 }     # blend = 0.15
/// ```
#[derive(Clone, Debug)]
pub struct Spot<S> {
    /// Its position.
    pub position: [f64; 3],
    /// The axis of the cone, a direction of any length.
    pub toward: [f64; 3],
    /// Full angle of the cone in degrees, above 0 and at most 180.
    pub cone_angle: f64,
    /// The outer part of the cone's half angle in which the light fades, 0 to 1.
    pub blend: f64,
    /// Radiance times area on the axis, in scene units.
    pub intensity: S,
}

impl<S> Spot<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Spot<T> {
        let Self { position, toward, cone_angle, blend, intensity } = self;
        Spot {
            position: *position,
            toward: *toward,
            cone_angle: *cone_angle,
            blend: *blend,
            intensity: convert(Quantity::Emission, intensity),
        }
    }

    /// Returns the part of the intensity that leaves in a direction: 1 in the inner part of the cone, 0 outside of the
    /// cone, and 3 t^2 - 2 t^3 of the angle in between.
    pub fn falloff(&self, direction: DVec3) -> f64 {
        let axis = DVec3::from(self.toward).normalize();
        let angle = libm::atan2(axis.cross(direction).length(), axis.dot(direction));
        let outer = 0.5 * self.cone_angle.to_radians();
        let inner = outer * (1.0 - self.blend);
        if angle <= inner {
            return 1.0;
        }
        let t = ((outer - angle) / (outer - inner)).max(0.0);
        if angle >= outer { 0.0 } else { t * t * (3.0 - 2.0 * t) }
    }

    /// Returns the cone of directions into which it shines.
    pub fn cone(&self) -> Cone {
        let sin = libm::sin(0.25 * self.cone_angle.to_radians());
        Cone { axis: unit(DVec3::from(self.toward).normalize()), one_minus_cos: 2.0 * sin * sin }
    }

    /// Sends photons into the narrower of two cones: the spot's own, and the one that the ball subtends.
    pub(super) fn beam(&self, ball: &Ball) -> Beam {
        let (toward, own) = (ball.cone_from(self.position.into()), self.cone());
        let half_angle = |cone: &Cone| libm::acos((1.0 - cone.one_minus_cos).clamp(-1.0, 1.0));
        let angle_between = libm::acos(toward.axis.dot(own.axis).clamp(-1.0, 1.0));
        let misses = !toward.is_all() && angle_between > half_angle(&toward) + half_angle(&own);
        let cone = if own.one_minus_cos < toward.one_minus_cos { own } else { toward };
        Beam {
            ball: *ball,
            cone,
            opening: None,
            flux: if misses { 0.0 } else { TAU * cone.one_minus_cos },
            is_outside_ball: true,
        }
    }

    pub(super) fn emit(&self, u: [f64; 2]) -> Option<LeSample> {
        let cone = self.cone();
        let direction = unit(cone.sample_uniform(u));
        let factor = self.falloff(direction) / cone.uniform_pdf();
        let ray = Ray { origin: self.position.into(), direction };
        (factor > 0.0).then_some(LeSample { ray, factor, surface: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_full_in_the_middle_and_fades_to_the_edge() {
        let spot = Spot { position: [0.0; 3], toward: [0.0, -2.0, 0.0], cone_angle: 60.0, blend: 0.5, intensity: () };
        let part = |spot: &Spot<()>, degrees: f64| {
            let (sin, cos) = libm::sincos(degrees.to_radians());
            spot.falloff(DVec3::new(sin, -cos, 0.0))
        };
        let at = |degrees: f64| part(&spot, degrees);
        assert_eq!([0.0, 14.9, 30.1, 90.0, 180.0].map(at), [1.0, 1.0, 0.0, 0.0, 0.0]);
        assert!((at(22.5) - 0.5).abs() < 1e-12 && at(16.0) > at(20.0) && at(20.0) > at(29.0));
        let sharp = Spot { blend: 0.0, ..spot };
        assert_eq!([29.99, 30.01].map(|degrees| part(&sharp, degrees)), [1.0, 0.0]);
    }
}
