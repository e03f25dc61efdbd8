use std::f64::consts::TAU;

use serde::Deserialize;

use super::{Beam, LePdf, LeSample, LightSample};
use crate::math::{Cone, DVec3, Ray};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::Quantity;

/// A point that shines evenly in all directions; rays never meet it.
///
/// ```toml
/// [[light]]
/// point = { position = [0, 3, 0], intensity = 10 }     # intensity: radiance times area
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Point<S> {
    /// Where it is.
    pub position: [f64; 3],
    /// Radiance times area, in scene units.
    pub intensity: S,
}

impl<S> Point<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Point<T> {
        Point { position: self.position, intensity: convert(Quantity::Emission, &self.intensity) }
    }

    pub(super) fn sample_li(&self, from: &SurfacePoint) -> Option<LightSample> {
        LightSample::of_point(from, self.position.into(), |_| 1.0)
    }

    pub(super) fn beam(&self, ball: &Ball) -> Beam {
        let cone = ball.cone_from(self.position.into());
        Beam { ball: *ball, cone, flux: TAU * cone.one_minus_cos, is_apart: true }
    }

    pub(super) fn sample_le(&self, cone: &Cone, guide_uv: [f64; 2]) -> Option<LeSample> {
        from_point(self.position.into(), cone, guide_uv)
    }
}

/// A photon that leaves a point of intensity 1 into a cone.
pub(super) fn from_point(origin: DVec3, cone: &Cone, guide_uv: [f64; 2]) -> Option<LeSample> {
    let ray = Ray { origin, direction: cone.direction_at(guide_uv)? };
    let pdf = LePdf { guide_uv: Some(guide_uv), of_square: cone.of_square(), others: 1.0 };
    Some(LeSample { ray, factor: 1.0, pdf, surface: None })
}

/// How densely `from_point` draws a photon.
pub(super) fn pdf_from_point(cone: &Cone, sample: &LeSample) -> Option<LePdf> {
    let guide_uv = cone.place_of(sample.ray.direction)?;
    Some(LePdf { guide_uv: Some(guide_uv), of_square: cone.of_square(), others: 1.0 })
}
