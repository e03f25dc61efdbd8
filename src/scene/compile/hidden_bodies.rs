//! Clear bodies that are invisible because another body takes their place.

use std::cmp::Ordering;

use super::inside_out::winding_number;
use super::placement::PlacedObjects;
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::checks::hit_from_outside;
use crate::scene::text::and_more;
use crate::scene::{Object, Visibility};
use crate::shape::{Shape, SurfacePoint};

/// Points of a body that must all lie in the other one.
const TEST_POINTS: u32 = 64;
/// Maximum number of clear bodies that are compared with one another.
const MAX_BODIES: usize = 2048;

/// Returns a warning about bodies that lie within another one of higher priority, or of the same priority with a
/// material that is first used later. Meshes of higher priority are exempt: they may have a cavity, filled by a body
/// that reaches into the walls.
pub(super) fn swallowed(placed: &PlacedObjects) -> Option<String> {
    let priority = |object: &Object| Some(placed.material(object).material.medium()?.priority);
    let clear = placed.objects.iter().filter_map(|object| Some((object, priority(object)?)));
    let clear: Vec<(&Object, i32)> = clear.take(MAX_BODIES).collect();
    let enclosing = |(body, own): (&Object, i32)| {
        let takes_precedence = |other: &Object, priority: i32| match priority.cmp(&own) {
            Ordering::Less => false,
            Ordering::Equal => other.material > body.material,
            Ordering::Greater => {
                other.visibility == Visibility::Shown && !matches!(&*other.shape, Shape::Mesh(_) | Shape::Instance(_))
            }
        };
        let mut others = clear.iter().filter(|(other, priority)| takes_precedence(other, *priority));
        others.find(|(other, _)| lies_within(&body.shape, &other.shape)).copied()
    };
    let mut found = clear.iter().filter_map(|&body| Some((body, enclosing(body)?)));
    let ((body, own), (other, priority)) = found.next()?;
    let why = if priority > own { "a higher priority" } else { "the same priority that is used later" };
    Some(format!(
        "{}: this body is invisible, as {} around it has a material of {why}: give material {} priority = {}",
        and_more(&body.name, found.count()),
        other.name,
        placed.material(body).name,
        i64::from(priority) + 1
    ))
}

/// Returns whether all of a bounded body lies in another closed one.
fn lies_within(body: &Shape, other: &Shape) -> bool {
    let Some(bounds) = body.bounds() else { return false };
    let is_in_box = other.bounds().is_none_or(|box_| {
        let (low, high) = (bounds.min.cmpgt(box_.min), bounds.max.cmplt(box_.max));
        low.all() && high.all()
    });
    if !is_in_box || !other.is_closed() || !body.is_closed() {
        return false;
    }
    let points = (0..TEST_POINTS).filter_map(|number| {
        let sampler = Sampler::new(6, [number, 0], 0);
        let [x, y, z, _] = sampler.get_random_4d(BranchKey::CAMERA, 0);
        let [u, v, ..] = sampler.get_random_4d(BranchKey::CAMERA, 1);
        hit_from_outside(body, DVec3::new(x, y, z), [u, v])
    });
    let points: Vec<(SurfacePoint, DVec3)> = points.collect();
    // A ray along a plane's normal leads out of what is behind the plane.
    let out = |direction| other.flat_normal().unwrap_or(direction);
    let is_inside = |(point, ray_direction): &(SurfacePoint, DVec3)| {
        winding_number(other, &Ray { origin: point.position, direction: out(*ray_direction) }) > 0
    };
    !points.is_empty() && points.iter().all(is_inside)
}
