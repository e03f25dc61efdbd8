use std::f64::consts::{PI, TAU};

use super::{Beam, LeSample};
use crate::math::{Ray, sample_sphere};
use crate::shape::Ball;
use crate::spectrum::Quantity;

/// A point that shines equally in all directions; rays never hit it.
///
/// ```toml
/// [[light]]
/// point = { position = [0, 3, 0], intensity = 10 }     # intensity: radiance times area
/// ```
#[derive(Clone, Debug)]
pub struct Point<S> {
    /// Its position.
    pub position: [f64; 3],
    /// Radiance times area, in scene units.
    pub intensity: S,
}

impl<S> Point<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Point<T> {
        Point { position: self.position, intensity: convert(Quantity::Emission, &self.intensity) }
    }

    pub(super) fn beam(&self, ball: &Ball) -> Beam {
        let cone = ball.cone_from(self.position.into());
        Beam { ball: *ball, cone, opening: None, flux: TAU * cone.one_minus_cos, is_outside_ball: true }
    }

    pub(super) fn emit(&self, u: [f64; 2]) -> LeSample {
        let ray = Ray { origin: self.position.into(), direction: sample_sphere(u) };
        LeSample { ray, factor: 4.0 * PI, surface: None }
    }
}
