//! A room, as bounces know it that begin inside.

use super::clusters::bounds_of_most;
use crate::math::{Bounds, BranchKey, DVec3, Frame, Ray, Sampler, cosine_hemisphere, unit};
use crate::shape::SurfacePoint;
use crate::trace::World;
use crate::trace::camera::Bounce;

/// Rays that look for the sky from a place, and how many may see it from inside a room: a quarter.
const LOOKS: u32 = 4;
const INSIDE: usize = 1;
/// Share of the bounces' weight inside rooms from which on it is a picture of a room.
const ENOUGH: f64 = 0.25;
/// Of the way to where a ray leaves the room, how far beyond it must go to have left.
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
        let Bounds { min, max } = bounds_of_most(&from, weight(&bounces));
        let margin = 1e-6 * (max - min).length();
        let bounds = Bounds { min: min - margin, max: max + margin };
        let bounces = bounces.into_iter().filter(|bounce| bounds.contains(bounce.from)).collect();
        Some(Self { world, bounds, bounces })
    }

    /// How much its bounces count.
    pub fn weight(&self) -> f64 {
        weight(&self.bounces)
    }

    /// Where a bounce ends, or where it leaves the room.
    pub fn end_of(&self, bounce: &Bounce) -> DVec3 {
        let leaves = self.distance_out(bounce.from, bounce.direction);
        bounce.from + bounce.direction * bounce.distance.min(leaves)
    }

    /// Where a ray leaves the room from where a bounce began, if it comes to the sky or to a place that is not inside.
    pub fn way_out(&self, bounce: &Bounce, direction: DVec3, sampler: &Sampler) -> Option<DVec3> {
        let Self { world, .. } = self;
        let ray = Ray { origin: off(bounce.from, bounce.normal), direction };
        let leaves = self.distance_out(ray.origin, direction);
        let is_out = match world.scene.nearest(&ray, f64::INFINITY, &|object| !world.is_see_through(object)) {
            None => true,
            Some(hit) if hit.crossing.t < BEYOND * leaves => false,
            Some(hit) => {
                let shape = &world.scene.objects[hit.object as usize].shape;
                let SurfacePoint { position, normal, .. } = shape.point(&ray, &hit.crossing);
                let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
                !is_inside(world, position, normal, sampler)
            }
        };
        is_out.then(|| ray.at(leaves))
    }

    /// How far it is from a point inside to the end of the box.
    fn distance_out(&self, from: DVec3, direction: DVec3) -> f64 {
        let Bounds { min, max } = self.bounds;
        let toward = |i: usize| match direction[i] {
            d if d > 0.0 => (max[i] - from[i]) / d,
            d if d < 0.0 => (min[i] - from[i]) / d,
            _ => f64::INFINITY,
        };
        (0..3).map(toward).fold(f64::INFINITY, f64::min)
    }
}

fn weight(bounces: &[Bounce]) -> f64 {
    bounces.iter().map(|bounce| bounce.weight).sum()
}

/// Whether less than a quarter of the sky, weighed by the cosine, is seen from a place.
fn is_inside(world: &World, place: DVec3, normal: DVec3, sampler: &Sampler) -> bool {
    let frame = Frame::about(normal);
    let from = off(place, normal);
    let sees = |look: &u32| {
        let u = sampler.four_plain(BranchKey::CAMERA, *look);
        let direction = unit(frame.to_world(cosine_hemisphere([u[0], u[1]])));
        let ray = Ray { origin: from, direction };
        world.scene.nearest(&ray, f64::INFINITY, &|object| !world.is_see_through(object)).is_none()
    };
    (0..LOOKS).filter(sees).count() <= INSIDE
}

/// A little off a surface: the rays only look around.
fn off(place: DVec3, normal: DVec3) -> DVec3 {
    place + normal * (1e-6 * place.length().max(1e-3))
}
