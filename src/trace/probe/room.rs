//! A room, as known from the bounces that begin inside it.

use super::clusters::trimmed_bounds;
use crate::math::{Bounds, BranchKey, DVec3, Ray, Sampler, sample_cosine_about};
use crate::shape::SurfacePoint;
use crate::trace::World;
use crate::trace::camera::Bounce;

/// Rays that look for the sky from a place, and how many may see it from inside a room: a quarter.
const SKY_RAYS: u32 = 4;
const MAX_SKY_HITS: usize = 1;
/// Share of the bounces' weight inside rooms above which the image shows a room.
const MIN_INSIDE_SHARE: f64 = 0.25;
/// Margin around a box, relative to its size; and the multiple of the way to its side beyond which a ray has left it.
const BOX_MARGIN: f64 = 1e-6;
const EXIT_FACTOR: f64 = 1.0 + 1e-6;

/// A room in which bounces begin.
pub struct Room<'a> {
    pub world: &'a World,
    /// The box in which they begin, except for a few.
    pub bounds: Bounds,
    pub bounces: Vec<Bounce>,
}

impl<'a> Room<'a> {
    /// Returns the room of those bounces that begin inside one, if they are enough. `seed` sets random numbers apart.
    pub fn from_bounces(world: &'a World, bounces: Vec<Bounce>, seed: u64) -> Option<Self> {
        let all = weight(&bounces);
        let is_inside = |(number, bounce): (u32, &Bounce)| {
            is_inside(world, bounce.from, bounce.normal, &Sampler::new(world.method.seed ^ seed, [number, 0], 0))
        };
        let inside: Vec<bool> = (0..).zip(&bounces).map(is_inside).collect();
        let bounces: Vec<Bounce> =
            bounces.into_iter().zip(inside).filter_map(|(bounce, inside)| inside.then_some(bounce)).collect();
        if bounces.is_empty() || weight(&bounces) < MIN_INSIDE_SHARE * all {
            return None;
        }
        let from: Vec<(DVec3, f64)> = bounces.iter().map(|bounce| (bounce.from, bounce.weight)).collect();
        let bounds = box_around(&from, weight(&bounces));
        let bounces = bounces.into_iter().filter(|bounce| bounds.contains(bounce.from)).collect();
        Some(Self { world, bounds, bounces })
    }

    /// Returns where a bounce ends, or where it leaves the box if that is nearer.
    pub fn end_of(&self, bounce: &Bounce) -> DVec3 {
        let exit = exit_distance(&self.bounds, bounce.from, bounce.direction);
        bounce.from + bounce.direction * bounce.distance.min(exit)
    }

    /// Returns where a ray from the start of a bounce ends, if that is inside.
    pub fn end_inside(&self, bounce: &Bounce, direction: DVec3, sampler: &Sampler) -> Option<DVec3> {
        let wall = WallHit::of(self.world, &ray_from(bounce, direction))?;
        is_inside(self.world, wall.position, wall.normal, sampler).then_some(wall.position)
    }

    /// Returns where a ray from the start of a bounce leaves a box around the room, if it reaches the sky or a place
    /// beyond the box that is not inside.
    pub fn way_out(&self, walls: &Bounds, bounce: &Bounce, direction: DVec3, sampler: &Sampler) -> Option<DVec3> {
        let ray = ray_from(bounce, direction);
        let exit = exit_distance(walls, ray.origin, direction);
        let is_out = WallHit::of(self.world, &ray).is_none_or(|wall| {
            wall.t > EXIT_FACTOR * exit && !is_inside(self.world, wall.position, wall.normal, sampler)
        });
        is_out.then(|| ray.at(exit))
    }
}

/// The point where a ray hits a surface that stops it.
struct WallHit {
    t: f64,
    position: DVec3,
    /// On the side that the ray came from.
    normal: DVec3,
}

impl WallHit {
    fn of(world: &World, ray: &Ray) -> Option<Self> {
        let hit = world.scene.nearest(ray, f64::INFINITY, &|object| !world.is_see_through(object))?;
        let shape = &world.scene.objects[hit.object as usize].shape;
        let SurfacePoint { position, normal, .. } = shape.point(ray, &hit.intersection);
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        Some(Self { t: hit.intersection.t, position, normal })
    }
}

/// Returns a box around most of some weighted points, with a small margin.
pub fn box_around(points: &[(DVec3, f64)], weight: f64) -> Bounds {
    let trimmed = trimmed_bounds(points, weight);
    let margin = BOX_MARGIN * trimmed.size().length();
    Bounds { min: trimmed.min - margin, max: trimmed.max + margin }
}

/// Returns the distance from a point in a box to its boundary.
fn exit_distance(Bounds { min, max }: &Bounds, from: DVec3, direction: DVec3) -> f64 {
    let toward = |i: usize| match direction[i] {
        d if d > 0.0 => (max[i] - from[i]) / d,
        d if d < 0.0 => (min[i] - from[i]) / d,
        _ => f64::INFINITY,
    };
    (0..3).map(toward).fold(f64::INFINITY, f64::min)
}

fn ray_from(bounce: &Bounce, direction: DVec3) -> Ray {
    Ray { origin: offset_point(bounce.from, bounce.normal), direction }
}

pub fn weight(bounces: &[Bounce]) -> f64 {
    bounces.iter().map(|bounce| bounce.weight).sum()
}

/// Whether at most a quarter of the sky, weighted by the cosine, is seen from a place.
fn is_inside(world: &World, place: DVec3, normal: DVec3, sampler: &Sampler) -> bool {
    let origin = offset_point(place, normal);
    let sees_sky = |look: &u32| {
        let [u, v, ..] = sampler.get_random_4d(BranchKey::CAMERA, *look);
        let ray = Ray { origin, direction: sample_cosine_about(normal, [u, v]) };
        world.scene.nearest(&ray, f64::INFINITY, &|object| !world.is_see_through(object)).is_none()
    };
    (0..SKY_RAYS).filter(sees_sky).count() <= MAX_SKY_HITS
}

/// Returns a point slightly off a surface: good enough for rays that only look around.
fn offset_point(place: DVec3, normal: DVec3) -> DVec3 {
    place + normal * (1e-6 * place.length().max(1e-3))
}
