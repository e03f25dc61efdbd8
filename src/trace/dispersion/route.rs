//! A route of light to the camera: what it hits, how far it has been followed back, and the surface that it hits there.

use super::color_walk::visible_facet;
use crate::light::LightId;
use crate::material::Facets;
use crate::math::{BranchKey, DVec3, Ray};
use crate::scene::MaterialId;
use crate::shape::SurfacePoint;
use crate::spectrum::Lanes;
use crate::trace::World;
use crate::trace::media::Media;

/// Something that light hits on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The material.
    pub material: MaterialId,
    /// Which of the materials that it is composed of, in the order of
    /// [`Material::with_parts`](crate::material::Material::with_parts).
    pub part: usize,
    /// What light does there.
    pub way: RouteEvent,
}

/// What light does at a surface, or in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RouteEvent {
    /// It is mirrored, by a surface or by a facet of it that is hit at an angle of this cosine.
    Reflected(f64),
    /// It crosses the surface.
    Crossed,
    /// It is scattered diffusely.
    Scattered,
    /// It travels this distance through the body.
    Inside(f64),
}

/// A route of light from a light to the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// What it hits, the nearest to the camera first.
    pub steps: Vec<Step>,
    /// The light that it comes from.
    pub light: LightId,
    /// What is left of the light, without the effect of the steps.
    pub weight: f64,
    /// Number of diffuse surfaces among the steps.
    pub scattered: u32,
}

/// Wavelengths, in nm, of the lanes that decide which routes matter.
pub const ROUTES_NM: [f64; 4] = [450.0, 520.0, 590.0, 650.0];

/// The end of a route that is followed back from the camera.
#[derive(Clone)]
pub struct RouteWalk {
    pub ray: Ray,
    /// Whether the camera directly sees what the route hits next, if it sees that at all.
    pub is_from_camera: bool,
    pub media: Media,
    pub key: BranchKey,
    pub steps: Vec<Step>,
    pub weight: f64,
    /// What is left of the light, with the effect of the steps.
    pub throughput: Lanes<4>,
    pub scattered: u32,
    /// Number of surfaces hit, without those that it passes through: `max_bounces` limits it.
    pub surfaces: u32,
}

impl RouteWalk {
    pub fn from_camera(world: &World, ray: Ray) -> Self {
        let (media, key, steps) = (world.media_at_camera(&ray), BranchKey::CAMERA, Vec::new());
        let (weight, throughput, is_from_camera) = (1.0, Lanes::ONE, true);
        Self { ray, is_from_camera, media, key, steps, weight, throughput, scattered: 0, surfaces: 0 }
    }

    pub fn max_throughput(&self) -> f32 {
        self.throughput.0.into_iter().fold(0.0, f32::max)
    }

    /// Returns the route after a step that leaves `tint` of each lane, times a factor.
    pub fn after(&self, step: Option<Step>, tint: Lanes<4>, factor: f64) -> Self {
        let mut next =
            Self { throughput: self.throughput * tint * factor as f32, weight: self.weight * factor, ..self.clone() };
        next.steps.extend(step);
        next
    }
}

/// A surface that a route hits.
pub struct RouteVertex<'a> {
    pub walk: &'a RouteWalk,
    pub material: MaterialId,
    pub point: &'a SurfacePoint,
    /// The unit normal on the side of the viewer.
    pub normal: DVec3,
    pub uv: [f64; 2],
    pub part: usize,
    pub u: [f64; 4],
}

impl RouteVertex<'_> {
    pub fn step(&self, way: RouteEvent) -> Step {
        Step { material: self.material, part: self.part, way }
    }

    /// Returns the unit vector to the viewer.
    pub fn wo(&self) -> DVec3 {
        -self.walk.ray.direction
    }

    /// Returns the normal of a facet that the viewer sees.
    pub fn facet(&self, facets: &Facets) -> DVec3 {
        visible_facet(facets, self.wo(), self.normal, [self.u[0], self.u[1]])
    }
}
