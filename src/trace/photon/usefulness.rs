//! Which light vertices are visible from surfaces that the camera sees: those behind walls need to be tried less often.

use std::cell::Cell;

use crate::math::{BranchKey, DVec2, DVec3, Ray, Sampler, unit};
use crate::scene::{Primitive, RayEnds};
use crate::shape::SurfacePoint;
use crate::trace::World;

/// Camera rays along each side of the image.
const SIDE: u32 = 24;
/// Neighboring vertices that are tested together, and visibility tests of each group.
const ALIKE: usize = 64;
const LOOKS: u32 = 32;
/// Most that vertices that no test reached may contribute, relative to those that were reached.
const UNSEEN: f64 = 0.05;
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
    let of_group = |(number, group): (usize, &[DVec3])| {
        let seen = (0..LOOKS).filter(|&look| {
            let [u, v, ..] =
                Sampler::new(world.method.seed ^ SEED, [number as u32, 0], look).four(BranchKey::CAMERA, 0);
            sees(world, chosen(places, v), *chosen(group, u), &last_occluder)
        });
        std::iter::repeat_n(seen.count(), group.len())
    };
    let seen: Vec<usize> = vertices.chunks(ALIKE).enumerate().flat_map(of_group).collect();
    // Count one more test that succeeds: a vertex that chance alone kept from being seen must not be left out.
    let share = |seen: usize| (seen + 1) as f64 / f64::from(LOOKS + 1);
    let mut sums = [0.0; 2];
    seen.iter().zip(powers).for_each(|(&seen, power)| sums[usize::from(seen > 0)] += share(seen) * power);
    let [unseen, of_seen] = sums;
    // Stay above 0: a vertex that is never tried is left out.
    let fewer = if of_seen > 0.0 { (UNSEEN * of_seen / unseen).clamp(f64::from(f32::EPSILON), 1.0) } else { 1.0 };
    seen.into_iter().map(|seen| (share(seen) * if seen > 0 { 1.0 } else { fewer }) as f32).collect()
}

/// Whether one of a few tests from places that the camera sees reaches a vertex. `key` sets their random numbers apart.
pub fn is_seen(world: &World, places: &[DiffusePlace], vertex: DVec3, key: [u32; 2]) -> bool {
    let last_occluder = Cell::new(None);
    let looks = Sampler::new(world.method.seed ^ SEED, key, LOOKS).four(BranchKey::CAMERA, 0);
    places.is_empty() || looks.iter().any(|&u| sees(world, chosen(places, u), vertex, &last_occluder))
}

/// Returns one of some elements, each equally likely, for a random number.
fn chosen<T>(some: &[T], u: f64) -> &T {
    &some[((u * some.len() as f64) as usize).min(some.len() - 1)]
}

/// Returns some of the diffuse places that the camera sees, all over the image.
pub fn places(world: &World) -> Vec<DiffusePlace> {
    let (scene, film) = (&world.scene, world.scene.film);
    let place = |number: u32| {
        let [x, y] = film.whole().middle_of_cell(SIDE, number).map(|x| f64::from(x) + 0.5);
        let ray = scene.camera.ray(DVec2::new(x, y));
        let hit = scene.intersect_seen(&ray, None)?;
        let point = scene.objects[hit.object as usize].point(&ray, &hit.intersection);
        let is_diffuse = world.lobes[scene.objects[hit.object as usize].material as usize].is_diffuse();
        is_diffuse.then_some(DiffusePlace { point, primitive: hit.primitive() })
    };
    (0..SIDE * SIDE).filter_map(place).collect()
}

/// Whether nothing blocks the way from a place to a vertex. The sides of their surfaces do not matter.
fn sees(world: &World, place: &DiffusePlace, vertex: DVec3, last_occluder: &Cell<Option<u32>>) -> bool {
    let way = vertex - place.point.position;
    let Some(direction) = way.try_normalize() else { return true };
    let ray = Ray { direction: unit(direction), ..place.point.leave(direction) };
    let ends = RayEnds { left: Some(place.primitive), ..RayEnds::default() };
    let counts = |object| !world.is_see_through(object);
    !world.scene.is_occluded_by(&ray, way.length() * NEARLY, ends, last_occluder, &counts)
}

/// Tests end a little before the vertex: they only guide.
const NEARLY: f64 = 1.0 - 1e-6;
