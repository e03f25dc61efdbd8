//! Surfaces, and what the camera sees of them.

use std::sync::Arc;

use super::NormalPerturbation;
use crate::light::LightId;
use crate::math::Ray;
use crate::shape::{Coordinates, Intersection, Shape, SurfacePoint};

/// Index of a material in its scene.
pub type MaterialId = u32;

/// A surface with its material.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name, or `object N` counted from 1.
    pub name: String,
    /// Its geometry.
    pub shape: Arc<Shape>,
    /// The material of its surface.
    pub material: MaterialId,
    /// The light that it is, if it shines.
    pub light: Option<LightId>,
    /// The texture coordinates of its points; none for a mesh without any.
    pub coordinates: Option<Arc<Coordinates>>,
    /// Whether its material varies over the surface.
    pub varies: bool,
    /// The name of the object of which it is an instance, or its own name if it is not one of several.
    pub asset: String,
    /// The light group that it belongs to if it shines; if absent, its asset alone.
    pub group: Option<String>,
    /// What the camera sees of it.
    pub visibility: Visibility,
    /// The image that perturbs its normal, if there is one.
    pub relief: Option<Arc<NormalPerturbation>>,
    /// Within this distance, a clear and an opaque surface count as one; 0 if the object shares none with another.
    pub contact: f64,
}

/// What the camera sees of an object when it looks at it directly. Lighting, reflections and shadows do not depend on
/// it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Visibility {
    /// All of it.
    #[default]
    Shown,
    /// What is behind it.
    Hidden,
    /// Nothing: a hole in the image, of coverage 0.
    Holdout,
    /// The change that other objects make to the light on it. It stands for a surface in the plate that the image is
    /// composited over.
    ShadowCatcher,
}

impl Object {
    /// Returns the surface at an intersection, with its shading normal perturbed by the relief if there is one.
    ///
    /// Its error includes another surface that counts as one with it: rays that leave one of them start beyond both.
    #[inline]
    pub fn point(&self, ray: &Ray, intersection: &Intersection) -> SurfacePoint {
        let mut point = self.shape.point(ray, intersection);
        point.error += self.contact;
        if let Some(relief) = &self.relief {
            point.shading = relief.normal(&self.shape, intersection, &point);
        }
        point
    }

    /// Returns the texture coordinates of a point on its surface, or (0, 0) if it has none.
    pub fn chart_uv(&self, intersection: &Intersection, point: &SurfacePoint) -> [f64; 2] {
        let coordinates = self.coordinates.as_ref();
        coordinates.map_or([0.0; 2], |coordinates| coordinates.at(&self.shape, intersection, point.position))
    }

    /// Returns the texture coordinates that its material uses at a point, or (0, 0) if the material is the same
    /// everywhere.
    pub fn uv(&self, intersection: &Intersection, point: &SurfacePoint) -> [f64; 2] {
        if self.varies { self.chart_uv(intersection, point) } else { [0.0; 2] }
    }
}
