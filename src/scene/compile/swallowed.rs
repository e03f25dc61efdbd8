//! Clear bodies of which nothing is seen, as another of the same priority is there in their place.

use super::contact::ray_into;
use super::inside_out::bodies_around;
use super::place::Placed;
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::Object;
use crate::shape::Shape;

/// Points of a body that all have to lie in the other.
const POINTS: u32 = 64;
/// Most clear bodies that are compared with one another.
const MOST: usize = 2048;

/// What is wrong with each body that lies within another of the same priority whose material objects use later.
pub(super) fn swallowed(placed: &Placed) -> Vec<String> {
    let priority = |object: &Object| Some(placed.materials[object.material as usize].material.medium()?.priority);
    let clear = placed.objects.iter().filter_map(|object| Some((object, priority(object)?)));
    let clear: Vec<(&Object, i32)> = clear.take(MOST).collect();
    let around = |(body, own): (&Object, i32)| {
        let mut others = clear.iter().filter(|(other, priority)| other.material > body.material && *priority == own);
        others.find(|(other, _)| lies_within(&body.shape, &other.shape)).map(|(other, _)| *other)
    };
    let mut found = clear.iter().filter_map(|&body| Some((body, around(body)?)));
    let Some(((body, priority), other)) = found.next() else { return Vec::new() };
    let more = found.count();
    let others = if more > 0 { format!(" and {more} more") } else { String::new() };
    let material = &placed.materials[body.material as usize].name;
    vec![format!(
        "{}{others}: nothing is seen of this body, as {} around it has a material of the same priority that is used later: \
         give material {material} priority = {}",
        body.name,
        other.name,
        i64::from(priority) + 1
    )]
}

/// Whether all of a bounded body lies in another closed one.
fn lies_within(body: &Shape, other: &Shape) -> bool {
    let Some(bounds) = body.bounds() else { return false };
    let is_in_box = other.bounds().is_none_or(|box_| {
        let (low, high) = (bounds.min.cmpgt(box_.min), bounds.max.cmplt(box_.max));
        low.all() && high.all()
    });
    if !is_in_box || !other.is_closed() || !body.is_closed() {
        return false;
    }
    let points = (0..POINTS).filter_map(|number| {
        let sampler = Sampler::new(6, [number, 0], 0);
        let [x, y, z, _] = sampler.four_plain(BranchKey::CAMERA, 0);
        let [u, v, ..] = sampler.four_plain(BranchKey::CAMERA, 1);
        let ray = ray_into(&bounds, DVec3::new(x, y, z), [u, v])?;
        let crossing = body.intersect(&ray, f64::INFINITY)?;
        Some((body.point(&ray, &crossing).position, ray.direction))
    });
    let points: Vec<(DVec3, DVec3)> = points.collect();
    // One of a plane leads out of what is behind it.
    let out = |direction| other.flat_normal().unwrap_or(direction);
    let is_inside = |&(origin, way): &(DVec3, DVec3)| bodies_around(other, &Ray { origin, direction: out(way) }) > 0;
    !points.is_empty() && points.iter().all(is_inside)
}
