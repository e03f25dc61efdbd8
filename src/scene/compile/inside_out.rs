//! Closed meshes of clear bodies whose faces point inward, so that their inside is taken for the outside.

use super::placement::PlacedObjects;
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::Object;
use crate::scene::checks::hit_from_outside;
use crate::scene::text::and_more;
use crate::shape::Shape;

/// Rays that vote on a mesh: an odd number, so that one ray that grazes an edge does not decide.
const VOTING_RAYS: u32 = 5;
/// Directions that are tried until a ray hits the mesh.
const MAX_TRIES: u32 = 16;
/// Maximum number of surfaces that a ray crosses.
const MAX_SURFACES: usize = 1000;

/// Returns a warning about closed meshes of clear bodies whose faces point inward. Such a body fills everything outside
/// of the mesh, and light that hits it is lost. Bubbles are exempt: they lie in a body of the same material, which ends
/// at their faces.
pub(super) fn inside_out(placed: &PlacedObjects) -> Option<String> {
    let objects = &placed.objects;
    let is_mesh = |object: &Object| matches!(*object.shape, Shape::Mesh(_) | Shape::Instance(_));
    let is_body = |object: &Object| placed.is_clear(object) && is_mesh(object) && object.shape.is_closed();
    let mut found = (0..objects.len()).filter(|&number| is_body(&objects[number]) && faces_inward(objects, number));
    let first = found.next()?;
    Some(format!(
        "{}: the faces of this closed mesh point inward, so its outside is taken for its inside: reverse the order of \
         each face's corners",
        and_more(&objects[first].name, found.count())
    ))
}

fn faces_inward(objects: &[Object], number: usize) -> bool {
    let votes = (0..VOTING_RAYS).filter_map(|ray| ray_from_inside(&objects[number].shape, ray));
    let winding = |ray: &Ray| {
        let own_winding = winding_number(&objects[number].shape, ray);
        if own_winding >= 0 {
            return own_winding;
        }
        let others = objects.iter().enumerate();
        let same = others.filter(|(other, body)| *other != number && body.material == objects[number].material);
        own_winding + same.map(|(_, body)| winding_number(&body.shape, ray)).sum::<i32>()
    };
    let (against, all) = votes.fold((0, 0), |(against, all), ray| (against + u32::from(winding(&ray) < 0), all + 1));
    2 * against > all
}

/// Returns a ray that starts just behind the first surface of a shape that is hit from outside.
fn ray_from_inside(shape: &Shape, number: u32) -> Option<Ray> {
    (0..MAX_TRIES).find_map(|attempt| {
        let [u, v, x, y] = Sampler::new(0, [number, attempt], 0).get_random_4d(BranchKey::CAMERA, 0);
        let [z, ..] = Sampler::new(0, [number, attempt], 1).get_random_4d(BranchKey::CAMERA, 0);
        let (point, direction) = hit_from_outside(shape, DVec3::new(x, y, z), [u, v])?;
        Some(point.leave(direction))
    })
}

/// Returns how many times the inside of a shape, by its normals, surrounds the start of a ray: how much more often the
/// ray leaves the shape than it enters it.
pub(super) fn winding_number(shape: &Shape, ray: &Ray) -> i32 {
    let (mut ray, mut winding) = (*ray, 0);
    for _ in 0..MAX_SURFACES {
        let Some(intersection) = shape.intersect(&ray, f64::INFINITY) else { break };
        let point = shape.point(&ray, &intersection);
        winding += if point.normal.dot(ray.direction) > 0.0 { 1 } else { -1 };
        ray = point.leave(ray.direction);
    }
    winding
}
