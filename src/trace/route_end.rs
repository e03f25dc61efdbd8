//! How far a way that is followed back from the camera has come, and the surface that it meets there.

use super::media::Media;
use super::routes::{Step, Way};
use crate::material::Facets;
use crate::math::{BranchKey, DVec3, Frame, Ray};
use crate::scene::MaterialId;
use crate::shape::SurfacePoint;
use crate::spectrum::Lanes;

/// The end of a way that is followed back from the camera.
#[derive(Clone)]
pub(super) struct Walk {
    pub(super) ray: Ray,
    pub(super) media: Media,
    pub(super) key: BranchKey,
    pub(super) steps: Vec<Step>,
    pub(super) weight: f64,
    /// What is left of the light, with the steps.
    pub(super) left: Lanes<4>,
    pub(super) scattered: u32,
}

impl Walk {
    pub(super) fn brightest(&self) -> f32 {
        self.left.0.into_iter().fold(0.0, f32::max)
    }

    /// After a step that leaves a share of each lane, and a factor besides.
    pub(super) fn after(&self, step: Option<Step>, tint: Lanes<4>, factor: f64) -> Self {
        let mut next = Self { left: self.left * tint * factor as f32, weight: self.weight * factor, ..self.clone() };
        next.steps.extend(step);
        next
    }
}

/// Where a way meets a surface.
pub(super) struct At<'a> {
    pub(super) walk: &'a Walk,
    pub(super) material: MaterialId,
    pub(super) point: &'a SurfacePoint,
    /// Unit normal on the side of the viewer.
    pub(super) normal: DVec3,
    pub(super) uv: [f64; 2],
    pub(super) part: usize,
    pub(super) u: [f64; 4],
}

impl At<'_> {
    pub(super) fn step(&self, way: Way) -> Step {
        Step { material: self.material, part: self.part, way }
    }

    /// The normal of a facet that the viewer sees.
    pub(super) fn facet(&self, facets: &Facets) -> DVec3 {
        let frame = Frame::about(self.normal);
        let local = frame.to_local(-self.walk.ray.direction);
        frame.to_world(facets.visible_normal(DVec3 { z: local.z.max(0.0), ..local }, [self.u[0], self.u[1]]))
    }
}
