//! Flat surfaces of clear bodies that nothing closes.

use super::probe::hit_from_outside;
use crate::math::{BranchKey, DVec3, Sampler, sample_cosine_about};
use crate::scene::Scene;
use crate::scene::text::and_more;
use crate::shape::Shape;
use crate::spectrum::Curve;

/// Maximum number of flat surfaces that are checked.
const MAX_SURFACES: usize = 1024;
/// Rays into the body behind each surface.
const RAYS_PER_SURFACE: u32 = 64;

/// Returns a warning about quads, discs and triangles of a dielectric behind which light may go on forever.
///
/// There is none if light that enters always meets another surface: one that closes the body, or an opaque one such as
/// the ground of a pond.
pub(super) fn open_glass(scene: &Scene<Curve>) -> Option<String> {
    let is_flat = |shape: &Shape| matches!(shape, Shape::Quad(_) | Shape::Disc(_) | Shape::Triangle(_));
    let objects = (0..).zip(scene.objects.iter());
    let flat = objects.filter(|(number, object)| is_flat(&object.shape) && scene.is_clear(*number));
    let mut open = flat.take(MAX_SURFACES).map(|(_, object)| object).filter(|object| is_open(scene, &object.shape));
    let first = open.next()?;
    Some(format!(
        "{}: light that enters this dielectric through a flat surface may never leave it, as nothing closes the body \
         behind it; for a pane use thin = {{ index = 1.5 }}, or a cube",
        and_more(&first.name, open.count())
    ))
}

/// Returns whether light that enters through a surface may meet nothing else.
fn is_open(scene: &Scene<Curve>, shape: &Shape) -> bool {
    (0..RAYS_PER_SURFACE).any(|number| {
        let sampler = Sampler::new(5, [number, 0], 0);
        let [x, y, z, _] = sampler.get_random_4d(BranchKey::CAMERA, 0);
        let [a, b, c, d] = sampler.get_random_4d(BranchKey::CAMERA, 1);
        let Some((point, _)) = hit_from_outside(shape, DVec3::new(x, y, z), [a, b]) else { return false };
        let inward = sample_cosine_about(-point.normal, [c, d]);
        scene.intersect(&point.leave(inward)).is_none()
    })
}
