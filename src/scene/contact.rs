//! Clear bodies that share a part of their surface with something else.

use super::Object;
use crate::math::{Bounds, BranchKey, DVec3, Ray, Sampler, ball_surface};

/// Rays by which two bodies are compared: enough to find one that shares a fiftieth of what is seen of it.
const RAYS: u32 = 256;
/// Surfaces of a body that one ray is followed through.
const DEEP: usize = 4;
/// Surfaces nearer than this part of a body's size lie in one place: far above rounding, far below anything meant.
const NEAR: f64 = 1e-9;
/// Pairs of bodies that are compared at most; a scene with more is not searched further.
const MOST_PAIRS: usize = 20_000;

/// Pairs of objects, the first one clear, whose surfaces coincide in part; `clear` says which objects are.
///
/// A ray that leaves one of them starts beyond the other and never meets it (row M2 of the stability catalog).
pub(super) fn coinciding(objects: &[Object], clear: impl Fn(&Object) -> bool) -> Vec<(usize, usize)> {
    let boxes: Vec<Option<Bounds>> = objects.iter().map(|object| object.shape.bounds()).collect();
    let mut compared = 0;
    let mut found = Vec::new();
    for (first, body) in objects.iter().enumerate().filter(|(_, object)| clear(object)) {
        for (second, other) in objects.iter().enumerate() {
            if first == second || (clear(other) && second < first) || !may_touch(boxes[first], boxes[second]) {
                continue;
            }
            compared += 1;
            if compared > MOST_PAIRS {
                return found;
            }
            if share_a_surface(body, other) {
                found.push((first, second));
            }
        }
    }
    found
}

/// Whether a body's box and another's meet; infinite ones have none.
fn may_touch(a: Option<Bounds>, b: Option<Bounds>) -> bool {
    let Some(a) = a else { return false };
    let Some(b) = b else { return true };
    let reach = (a.max - a.min).max_element() * NEAR;
    (a.min - reach).cmple(b.max).all() && (b.min - reach).cmple(a.max).all()
}

fn share_a_surface(body: &Object, other: &Object) -> bool {
    let Some(bounds) = body.shape.bounds() else { return false };
    let (center, size) = (bounds.center(), (bounds.max - bounds.min).length());
    let step = 1e-3 * size;
    (0..RAYS).any(|number| {
        let [u, v, x, y] = Sampler::new(0, [0, 0], number).four(BranchKey::CAMERA, 0);
        let [z, ..] = Sampler::new(0, [1, 0], number).four(BranchKey::CAMERA, 0);
        let target = bounds.min + (bounds.max - bounds.min) * DVec3::new(x, y, z);
        let Some(direction) = (target - (center + ball_surface([u, v]) * size)).try_normalize() else { return false };
        let mut ray = Ray { origin: target - direction * (2.0 * size), direction };
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
