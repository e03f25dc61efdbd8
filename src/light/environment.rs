use std::f64::consts::PI;

use serde::Deserialize;

use super::View;
use crate::math::{DVec3, Frame, Ray, cosine_hemisphere, unit};
use crate::shape::Sighting;
use crate::spectrum::Quantity;

/// The same radiance from all directions, where rays miss everything.
///
/// ```toml
/// [[light]]
/// environment = { radiance = 1 }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Environment<S> {
    /// What rays show that miss everything.
    pub radiance: S,
}

impl<S> Environment<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Environment<T> {
        Environment { radiance: convert(Quantity::Emission, &self.radiance) }
    }

    /// Draws directions by their cosine to the normal, as the irradiance of an even sky weighs them.
    pub(super) fn aim(&self, normal: DVec3, u: [f64; 2]) -> Sighting {
        let direction = unit(Frame::about(normal).to_world(cosine_hemisphere(u)));
        Sighting { direction, part: None, density: None }
    }

    /// Density with which `aim` draws the direction of a ray, at a surface of the given normal.
    pub fn pdf(&self, ray: &Ray, normal: DVec3) -> f64 {
        ray.direction.dot(normal).max(0.0) / PI
    }

    pub(super) fn view(&self, ray: &Ray, normal: DVec3) -> View {
        View { distance: f64::INFINITY, object: None, pdf: Some(self.pdf(ray, normal)), factor: 1.0 }
    }
}
