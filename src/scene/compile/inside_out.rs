//! Closed meshes of clear bodies whose faces look inward, so that their inside is taken for the outside.

use super::contact::ray_into;
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::Object;
use crate::shape::Shape;

/// Rays that vote on a mesh: an odd number, so that one that grazes an edge does not decide.
const RAYS: u32 = 5;
/// Directions that are tried for one ray that meets the mesh.
const TRIES: u32 = 16;
/// Surfaces that a ray crosses at most.
const MOST: usize = 1000;

/// Clear objects (`clear` says which) that are closed meshes with their faces inward, and no bubbles: a bubble lies in
/// a body of the same material, which its faces end.
pub(super) fn inside_out(objects: &[Object], clear: impl Fn(&Object) -> bool) -> Vec<usize> {
    let is_mesh = |object: &Object| matches!(*object.shape, Shape::Mesh(_) | Shape::Instance(_));
    let candidates = (0..objects.len()).filter(|&number| {
        let object = &objects[number];
        clear(object) && is_mesh(object) && object.shape.is_closed()
    });
    candidates.filter(|&number| looks_inward(objects, number)).collect()
}

fn looks_inward(objects: &[Object], number: usize) -> bool {
    let votes = (0..RAYS).filter_map(|ray| from_inside(&objects[number].shape, ray));
    let bodies = |ray: &Ray| {
        let own = bodies_around(&objects[number].shape, ray);
        if own >= 0 {
            return own;
        }
        let others = objects.iter().enumerate();
        let same = others.filter(|(other, body)| *other != number && body.material == objects[number].material);
        own + same.map(|(_, body)| bodies_around(&body.shape, ray)).sum::<i32>()
    };
    let (against, all) = votes.fold((0, 0), |(against, all), ray| (against + u32::from(bodies(&ray) < 0), all + 1));
    2 * against > all
}

/// A ray that starts just behind the first surface of a shape that is met from outside.
fn from_inside(shape: &Shape, number: u32) -> Option<Ray> {
    let bounds = shape.bounds()?;
    (0..TRIES).find_map(|attempt| {
        let [u, v, x, y] = Sampler::new(0, [number, attempt], 0).four_plain(BranchKey::CAMERA, 0);
        let [z, ..] = Sampler::new(0, [number, attempt], 1).four_plain(BranchKey::CAMERA, 0);
        let ray = ray_into(&bounds, DVec3::new(x, y, z), [u, v])?;
        let crossing = shape.intersect(&ray, f64::INFINITY)?;
        Some(shape.point(&ray, &crossing).leave(ray.direction))
    })
}

/// How often the inside of a shape, by its normals, lies around the start of a ray: left more often than entered on the
/// way out.
pub(super) fn bodies_around(shape: &Shape, ray: &Ray) -> i32 {
    let (mut ray, mut bodies) = (*ray, 0);
    for _ in 0..MOST {
        let Some(crossing) = shape.intersect(&ray, f64::INFINITY) else { break };
        let point = shape.point(&ray, &crossing);
        bodies += if point.normal.dot(ray.direction) > 0.0 { 1 } else { -1 };
        ray = point.leave(ray.direction);
    }
    bodies
}
