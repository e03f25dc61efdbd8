use std::sync::Arc;

use super::View;
use crate::math::Ray;
use crate::shape::{Crossing, Shape, Sides};
use crate::spectrum::Quantity;

/// A surface that shines: an object whose material emits.
#[derive(Clone, Debug)]
pub struct Area<S> {
    /// The surface.
    pub shape: Arc<Shape>,
    /// The object it belongs to.
    pub object: u32,
    /// What it shows.
    pub radiance: S,
    /// The sides that show it.
    pub sides: Sides,
    /// Whether next-event estimation aims at it: finite `emissive` surfaces. Planes and glowing glass are only met.
    pub aimed_at: bool,
}

impl<S> Area<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Area<T> {
        Area {
            shape: self.shape.clone(),
            object: self.object,
            radiance: convert(Quantity::Emission, &self.radiance),
            sides: self.sides,
            aimed_at: self.aimed_at,
        }
    }

    /// Looks for the light exactly as a ray that happens to meet it would: no distance needs a tolerance.
    pub(super) fn view(&self, ray: &Ray, part: Option<u32>) -> Option<View> {
        let crossing = self.shape.intersect(ray, f64::INFINITY)?;
        if part.is_some_and(|part| part != crossing.part) {
            return None;
        }
        let front = self.shape.point(ray, &crossing).normal.dot(ray.direction) < 0.0;
        let pdf = self.pdf(ray, &crossing)?;
        let view = View { distance: crossing.t, object: Some(self.object), pdf: Some(pdf), factor: 1.0 };
        self.sides.shine(front).then_some(view)
    }

    /// Density with which the light is aimed at along a ray that meets it, none where it is seen exactly edge-on.
    pub fn pdf(&self, ray: &Ray, crossing: &Crossing) -> Option<f64> {
        Some(self.shape.pdf_toward(ray, crossing)).filter(|pdf| pdf.is_finite() && *pdf > 0.0)
    }
}
