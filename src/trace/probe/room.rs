//! A room, as bounces know it that begin inside.

use super::clusters::bounds_of_most;
use crate::math::{Bounds, BranchKey, DVec3, Ray, Sampler, cosine_about};
use crate::shape::SurfacePoint;
use crate::trace::World;
use crate::trace::camera::Bounce;

/// Rays that look for the sky from a place, and how many may see it from inside a room: a quarter.
const LOOKS: u32 = 4;
const INSIDE: usize = 1;
/// Share of the bounces' weight inside rooms from which on it is a picture of a room.
const ENOUGH: f64 = 0.25;
/// How much is added around a box; and how many times as far as to its side a ray must go to have left it.
const MARGIN: f64 = 1e-6;
const BEYOND: f64 = 1.0 + 1e-6;

/// A room in which bounces begin.
pub struct Room<'a> {
    pub world: &'a World,
    /// The box in which they do, but for a few.
    pub bounds: Bounds,
    pub bounces: Vec<Bounce>,
}

impl<'a> Room<'a> {
    /// The bounces that began inside a room, if they are many. `seed` sets random numbers apart.
    pub fn of(world: &'a World, bounces: Vec<Bounce>, seed: u64) -> Option<Self> {
        let all = weight(&bounces);
        let is_inside = |(number, bounce): (u32, &Bounce)| {
            is_inside(world, bounce.from, bounce.normal, &Sampler::new(world.method.seed ^ seed, [number, 0], 0))
        };
        let inside: Vec<bool> = (0..).zip(&bounces).map(is_inside).collect();
        let bounces: Vec<Bounce> =
            bounces.into_iter().zip(inside).filter_map(|(bounce, inside)| inside.then_some(bounce)).collect();
        if bounces.is_empty() || weight(&bounces) < ENOUGH * all {
            return None;
        }
        let from: Vec<(DVec3, f64)> = bounces.iter().map(|bounce| (bounce.from, bounce.weight)).collect();
        let bounds = box_around(&from, weight(&bounces));
        let bounces = bounces.into_iter().filter(|bounce| bounds.contains(bounce.from)).collect();
        Some(Self { world, bounds, bounces })
    }

    /// Where a bounce ends, or where it leaves the box.
    pub fn end_of(&self, bounce: &Bounce) -> DVec3 {
        let leaves = distance_out(&self.bounds, bounce.from, bounce.direction);
        bounce.from + bounce.direction * bounce.distance.min(leaves)
    }

    /// Where a ray from where a bounce began ends, if that is inside.
    pub fn end_inside(&self, bounce: &Bounce, direction: DVec3, sampler: &Sampler) -> Option<DVec3> {
        let met = WallHit::of(self.world, &leaving(bounce, direction))?;
        is_inside(self.world, met.position, met.normal, sampler).then_some(met.position)
    }

    /// Where such a ray leaves a box around the room, if it comes to the sky or to a place that is not inside.
    pub fn way_out(&self, walls: &Bounds, bounce: &Bounce, direction: DVec3, sampler: &Sampler) -> Option<DVec3> {
        let ray = leaving(bounce, direction);
        let leaves = distance_out(walls, ray.origin, direction);
        let is_out = WallHit::of(self.world, &ray)
            .is_none_or(|met| met.t > BEYOND * leaves && !is_inside(self.world, met.position, met.normal, sampler));
        is_out.then(|| ray.at(leaves))
    }
}

/// Where a ray hits a surface that ends it.
struct WallHit {
    t: f64,
    position: DVec3,
    /// Toward where it came from.
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

/// A box around most of some weighted points, and a little more.
pub fn box_around(points: &[(DVec3, f64)], weight: f64) -> Bounds {
    let most = bounds_of_most(points, weight);
    let margin = MARGIN * most.size().length();
    Bounds { min: most.min - margin, max: most.max + margin }
}

/// How far it is from a point in a box to its end.
fn distance_out(Bounds { min, max }: &Bounds, from: DVec3, direction: DVec3) -> f64 {
    let toward = |i: usize| match direction[i] {
        d if d > 0.0 => (max[i] - from[i]) / d,
        d if d < 0.0 => (min[i] - from[i]) / d,
        _ => f64::INFINITY,
    };
    (0..3).map(toward).fold(f64::INFINITY, f64::min)
}

fn leaving(bounce: &Bounce, direction: DVec3) -> Ray {
    Ray { origin: off(bounce.from, bounce.normal), direction }
}

pub fn weight(bounces: &[Bounce]) -> f64 {
    bounces.iter().map(|bounce| bounce.weight).sum()
}

/// Whether less than a quarter of the sky, weighed by the cosine, is seen from a place.
fn is_inside(world: &World, place: DVec3, normal: DVec3, sampler: &Sampler) -> bool {
    let origin = off(place, normal);
    let sees = |look: &u32| {
        let [u, v, ..] = sampler.four_plain(BranchKey::CAMERA, *look);
        let ray = Ray { origin, direction: cosine_about(normal, [u, v]) };
        world.scene.nearest(&ray, f64::INFINITY, &|object| !world.is_see_through(object)).is_none()
    };
    (0..LOOKS).filter(sees).count() <= INSIDE
}

/// A little off a surface: the rays only look around.
fn off(place: DVec3, normal: DVec3) -> DVec3 {
    place + normal * (1e-6 * place.length().max(1e-3))
}
