//! Surfaces, and what the camera sees of them.

use std::sync::Arc;

use super::NormalPerturbation;
use crate::light::LightId;
use crate::math::Ray;
use crate::shape::{Coordinates, Intersection, Shape, SurfacePoint};

/// Number of a material in its scene.
pub type MaterialId = u32;

/// A surface with its material.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name, or `object N` counted from 1.
    pub name: String,
    /// Where it is.
    pub shape: Arc<Shape>,
    /// What it does with light.
    pub material: MaterialId,
    /// The light it is, if it shines.
    pub light: Option<LightId>,
    /// Where its points lie in images; none of a mesh that does not say.
    pub coordinates: Option<Arc<Coordinates>>,
    /// Whether its material varies over the surface.
    pub varies: bool,
    /// The name of what it is one of, if it is one of several instances; else its own.
    pub asset: String,
    /// The group of lights that it belongs to if it shines; its asset alone if absent.
    pub group: Option<String>,
    /// What the camera sees of it.
    pub visibility: Visibility,
    /// The image that bends its normal, if there is one.
    pub relief: Option<Arc<NormalPerturbation>>,
}

/// What the camera sees of an object where it looks straight at it. Light, mirrors and shadows know no difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility {
    /// All of it.
    #[default]
    Shown,
    /// What is behind it.
    Hidden,
    /// Nothing: a hole in the image, of coverage 0.
    Holdout,
    /// What other objects change of the light on it: it stands for a surface of the plate that the image is laid over.
    ShadowCatcher,
}

impl Object {
    /// The surface at a crossing, with the normal that its relief gives it.
    #[inline]
    pub fn point(&self, ray: &Ray, intersection: &Intersection) -> SurfacePoint {
        let mut point = self.shape.point(ray, intersection);
        if let Some(relief) = &self.relief {
            point.shading = relief.normal(&self.shape, intersection, &point);
        }
        point
    }

    /// Where a point of its surface would lie in an image on it; (0, 0) if it has no coordinates.
    pub fn chart_uv(&self, intersection: &Intersection, point: &SurfacePoint) -> [f64; 2] {
        let coordinates = self.coordinates.as_ref();
        coordinates.map_or([0.0; 2], |coordinates| coordinates.at(&self.shape, intersection, point.position))
    }

    /// Where a point of its surface lies in the images of its material; (0, 0) if that is the same everywhere.
    pub fn uv(&self, intersection: &Intersection, point: &SurfacePoint) -> [f64; 2] {
        if self.varies { self.chart_uv(intersection, point) } else { [0.0; 2] }
    }
}
