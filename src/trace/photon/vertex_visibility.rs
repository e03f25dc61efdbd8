//! Which light vertices are visible from surfaces that the camera sees: those behind walls need to be tried less often.

use std::cell::Cell;

use crate::math::{BranchKey, DVec2, DVec3, Ray, Sampler, unit};
use crate::scene::{Primitive, RayEnds};
use crate::shape::SurfacePoint;
use crate::trace::World;

/// Camera rays along each side of the image.
const RAYS_PER_SIDE: u32 = 24;
/// Neighboring vertices that are tested together, and visibility tests of each group.
const GROUP_SIZE: usize = 64;
const TESTS_PER_GROUP: u32 = 32;
/// Most that vertices that no test reached may contribute, relative to those that were reached.
const UNSEEN_SHARE: f64 = 0.05;
/// Sets these random numbers apart from the others.
const SEED: u64 = 0x6c6f_6f6b;

/// A place on a diffuse surface that the camera sees directly.
pub struct DiffusePlace {
    point: SurfacePoint,
    primitive: Primitive,
}

/// Returns for each vertex how often places that the camera sees also see its neighborhood: above 0, at most 1.
/// Vertices in sequence are neighbors, and `powers` holds what leaves them. Uses the whole image, whatever is rendered.
pub fn usefulness(world: &World, places: &[DiffusePlace], vertices: &[DVec3], powers: &[f64]) -> Vec<f32> {
    if places.is_empty() {
        return vec![1.0; vertices.len()];
    }
    let last_occluder = Cell::new(None);
    let seen_counts = |(number, group): (usize, &[DVec3])| {
        let seen_pairs = (0..TESTS_PER_GROUP).filter(|&look| {
            let [u, v, ..] =
                Sampler::new(world.method.seed ^ SEED, [number as u32, 0], look).get_4d(BranchKey::CAMERA, 0);
            sees(world, pick(places, v), *pick(group, u), &last_occluder)
        });
        std::iter::repeat_n(seen_pairs.count(), group.len())
    };
    let seen: Vec<usize> = vertices.chunks(GROUP_SIZE).enumerate().flat_map(seen_counts).collect();
    // Count one more test that succeeds: a vertex that chance alone kept from being seen must not be left out.
    let share = |seen: usize| (seen + 1) as f64 / f64::from(TESTS_PER_GROUP + 1);
    let mut sums = [0.0; 2];
    seen.iter().zip(powers).for_each(|(&seen, power)| sums[usize::from(seen > 0)] += share(seen) * power);
    let [unseen_sum, seen_sum] = sums;
    // Stay above 0: a vertex that is never tried is left out.
    let scale =
        if seen_sum > 0.0 { (UNSEEN_SHARE * seen_sum / unseen_sum).clamp(f64::from(f32::EPSILON), 1.0) } else { 1.0 };
    seen.into_iter().map(|seen| (share(seen) * if seen > 0 { 1.0 } else { scale }) as f32).collect()
}

/// Whether one of a few tests from places that the camera sees reaches a vertex. `key` sets their random numbers apart.
pub fn is_seen(world: &World, places: &[DiffusePlace], vertex: DVec3, key: [u32; 2]) -> bool {
    let last_occluder = Cell::new(None);
    let looks = Sampler::new(world.method.seed ^ SEED, key, TESTS_PER_GROUP).get_4d(BranchKey::CAMERA, 0);
    places.is_empty() || looks.iter().any(|&u| sees(world, pick(places, u), vertex, &last_occluder))
}

/// Returns one of some elements, each equally likely, for a random number.
fn pick<T>(elements: &[T], u: f64) -> &T {
    &elements[((u * elements.len() as f64) as usize).min(elements.len() - 1)]
}

/// Returns some of the diffuse places that the camera sees, all over the image.
pub fn places(world: &World) -> Vec<DiffusePlace> {
    let (scene, film) = (&world.scene, world.scene.film);
    let place = |number: u32| {
        let [x, y] = film.whole().middle_of_cell(RAYS_PER_SIDE, number).map(|x| f64::from(x) + 0.5);
        let ray = scene.camera.ray(DVec2::new(x, y));
        let hit = scene.intersect_seen(&ray, None)?;
        let point = scene.objects[hit.object as usize].point(&ray, &hit.intersection);
        let is_diffuse = world.lobes[scene.objects[hit.object as usize].material as usize].is_diffuse();
        is_diffuse.then_some(DiffusePlace { point, primitive: hit.primitive() })
    };
    (0..RAYS_PER_SIDE * RAYS_PER_SIDE).filter_map(place).collect()
}

/// Whether nothing blocks the way from a place to a vertex. The sides of their surfaces do not matter.
fn sees(world: &World, place: &DiffusePlace, vertex: DVec3, last_occluder: &Cell<Option<u32>>) -> bool {
    let way = vertex - place.point.position;
    let Some(direction) = way.try_normalize() else { return true };
    let ray = Ray { direction: unit(direction), ..place.point.leave(direction) };
    let ends = RayEnds { start: Some(place.primitive), ..RayEnds::default() };
    let is_opaque = |object| !world.is_see_through(object);
    !world.scene.is_occluded_by(&ray, way.length() * LENGTH_FACTOR, ends, last_occluder, &is_opaque)
}

/// Tests end a little before the vertex: they only guide.
const LENGTH_FACTOR: f64 = 1.0 - 1e-6;
