//! Clear bodies and flat lamps that share a part of their surface with something else.

use super::context::Context;
use super::place::Placed;
use crate::material::Material;
use crate::math::{Bounds, BranchKey, DVec3, Ray, Sampler};
use crate::scene::Object;
use crate::scene::checks::ray_into;
use crate::shape::Shape;

/// Rays by which two bodies are compared: enough to find one that shares a fiftieth of what is seen of it.
const RAYS: u32 = 256;
/// Surfaces of a body that one ray is followed through.
const DEEP: usize = 4;
/// Surfaces nearer than this part of a body's size lie in one place: far above rounding, far below anything meant.
const NEAR: f64 = 1e-9;
/// Pairs of bodies that are compared at most; a scene with more is not searched further.
const MOST_PAIRS: usize = 20_000;

/// Clear bodies may overlap but not share a surface: rounding would decide which of the two a ray meets. Of a flat lamp
/// in another surface nothing may be seen.
pub(super) fn contacts(context: &mut Context, placed: &Placed) {
    for (first, second) in coinciding(placed) {
        let [body, other] = [first, second].map(|number| &placed.objects[number]);
        let (name, other_name) = (&body.name, &other.name);
        if placed.is_clear(body) && placed.is_clear(other) {
            let message = format!("a part of the surfaces of {name} and {other_name} lies in one place");
            let help = "let one reach a little into the other: there the one of higher `priority` is; or leave a gap";
            placed.shapes[first.max(second)].advise::<()>(message, help);
            continue;
        }
        context.warn(match is_flat_lamp(placed, body) {
            true => {
                format!("a part of {name}, which shines, lies exactly in {other_name}, which may hide it: move it a little")
            }
            false => format!(
                "a part of the surface of {name} lies exactly in {other_name}, where light may pass by it: move it a little, \
                 apart or into the other"
            ),
        });
    }
}

/// A lamp that has no inside.
fn is_flat_lamp(placed: &Placed, object: &Object) -> bool {
    let shines = matches!(placed.material(object).material, Material::Emissive(_));
    shines && matches!(*object.shape, Shape::Quad(_) | Shape::Disc(_) | Shape::Triangle(_))
}

/// Pairs of objects whose surfaces coincide in part, the first one a clear body or a flat lamp.
///
/// A ray that leaves one of them starts beyond the other and never meets it (row M2 of the stability catalog).
fn coinciding(placed: &Placed) -> Vec<(usize, usize)> {
    let objects = &placed.objects;
    let counting: Vec<bool> =
        objects.iter().map(|object| placed.is_clear(object) || is_flat_lamp(placed, object)).collect();
    let boxes: Vec<Option<Bounds>> = objects.iter().map(|object| object.shape.bounds()).collect();
    let mut pairs = near_pairs(&boxes, &counting);
    pairs.sort_unstable();
    pairs.retain(|&(first, second)| share_a_surface(&objects[first], &objects[second]));
    pairs
}

/// Pairs whose boxes meet, the first one such as counts: of objects in the order in which they begin along the longest
/// side of the scene, each is compared with those that have not ended (Cohen et al. 1995, *I-COLLIDE*, sweep and
/// prune).
fn near_pairs(boxes: &[Option<Bounds>], counting: &[bool]) -> Vec<(usize, usize)> {
    if !counting.contains(&true) {
        return Vec::new();
    }
    let size = Bounds::around(boxes.iter().flatten().map(Bounds::center));
    let size = size.max - size.min;
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let from = |object: usize| boxes[object].map_or(f64::NEG_INFINITY, |of| of.min[axis] - reach(&of));
    let to = |object: usize| boxes[object].map_or(f64::INFINITY, |of| of.max[axis] + reach(&of));
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| from(a).total_cmp(&from(b)));
    let (mut open, mut pairs) = (Vec::<usize>::new(), Vec::new());
    for object in order {
        open.retain(|&other| to(other) >= from(object));
        for &other in &open {
            let (low, high) = (object.min(other), object.max(other));
            // Of a plane there is no box to look around: where both count, the other one is the body.
            let is_first = counting[low] && (boxes[low].is_some() || !counting[high]);
            let (first, second) = if is_first { (low, high) } else { (high, low) };
            if counting[first] && may_touch(boxes[first], boxes[second]) {
                pairs.push((first, second));
                if pairs.len() == MOST_PAIRS {
                    return pairs;
                }
            }
        }
        open.push(object);
    }
    pairs
}

/// How far apart surfaces of a body and another may lie in one place.
fn reach(of: &Bounds) -> f64 {
    (of.max - of.min).max_element() * NEAR
}

/// Whether a body's box and another's meet; infinite ones have none, and are compared with one another and as what a
/// body meets.
fn may_touch(a: Option<Bounds>, b: Option<Bounds>) -> bool {
    let (a, b) = match (a, b) {
        (Some(a), Some(b)) => (a, b),
        (a, b) => return a.is_some() || b.is_none(),
    };
    let reach = reach(&a);
    (a.min - reach).cmple(b.max).all() && (b.min - reach).cmple(a.max).all()
}

fn share_a_surface(body: &Object, other: &Object) -> bool {
    if let (Shape::Plane(one), Shape::Plane(another)) = (&*body.shape, &*other.shape) {
        return one.coincides(another, NEAR);
    }
    let Some(bounds) = body.shape.bounds() else { return false };
    let size = (bounds.max - bounds.min).length();
    let step = 1e-3 * size;
    (0..RAYS).any(|number| {
        let [u, v, x, y] = Sampler::new(0, [0, 0], number).four(BranchKey::CAMERA, 0);
        let [z, ..] = Sampler::new(0, [1, 0], number).four(BranchKey::CAMERA, 0);
        let Some(mut ray) = ray_into(&bounds, DVec3::new(x, y, z), [u, v]) else { return false };
        let direction = ray.direction;
        for _ in 0..DEEP {
            let Some(crossing) = body.shape.intersect(&ray, f64::INFINITY) else { return false };
            let point = body.shape.point(&ray, &crossing);
            let before = Ray { origin: point.position - direction * step, direction };
            if let Some(met) = other.shape.intersect(&before, step + NEAR * size) {
                let parallel = other.shape.point(&before, &met).normal.cross(point.normal).length() < 1e-6;
                if met.t >= step - NEAR * size && parallel {
                    return true;
                }
            }
            ray = point.leave(direction);
        }
        false
    })
}
