//! Clear bodies and flat lamps that share a part of their surface with another object.

use super::context::Context;
use super::near_pairs::{MAX_PAIRS, NEAR, near_pairs};
use super::placement::PlacedObjects;
use crate::material::Material;
use crate::math::{Bounds, BranchKey, DVec3, Ray, Sampler};
use crate::scene::Object;
use crate::scene::checks::ray_into;
use crate::shape::{Plane, Shape};

/// Rays by which two bodies are compared: enough to find a shared part that is a fiftieth of the visible surface.
const COMPARED_RAYS: u32 = 256;
/// Maximum number of surfaces of a body that a ray is followed through.
const MAX_SURFACES: usize = 4;

/// Reports objects that share a surface. Clear bodies may overlap but not share a surface, since rounding would decide
/// which of the two a ray hits. Where a clear one lies on an opaque one, rays hit the opaque one. A flat lamp that lies
/// in another surface may be invisible.
pub(super) fn contacts(context: &mut Context, placed: &mut PlacedObjects) {
    for (first, second) in coinciding_pairs(placed) {
        let [body, other] = [first, second].map(|number| &placed.objects[number]);
        let (name, other_name) = (&body.name, &other.name);
        if placed.is_clear(body) && placed.is_clear(other) {
            let message = format!("the surfaces of {name} and {other_name} partly coincide");
            let help = "let one reach a little into the other, where the higher `priority` decides, or leave a gap";
            placed.shapes[first.max(second)].advise::<()>(message, help);
            continue;
        }
        let contact = contact(placed, body, other);
        context.warn(match contact {
            Some(_) => format!(
                "a part of the surface of {name} lies exactly on {other_name}, and there is no air between them: if \
                 there should be some, move it a little"
            ),
            None if is_flat_lamp(placed, body) => format!(
                "a part of {name}, which emits light, lies exactly on {other_name}, which may hide it: move it a little"
            ),
            None => format!(
                "a part of the surface of {name} lies exactly on {other_name}, where light may miss it: move it a \
                 little, apart from the other or into it"
            ),
        });
        for number in [first, second] {
            let object = &mut placed.objects[number];
            object.contact = object.contact.max(contact.unwrap_or_default());
        }
    }
}

/// Returns the distance within which a clear and an opaque object that share a surface count as one there. `None` if
/// light has to cross both.
fn contact(placed: &PlacedObjects, one: &Object, another: &Object) -> Option<f64> {
    let is_opaque = |object: &Object| {
        let material = &placed.material(object).material;
        material.medium().is_none() && !material.is_see_through()
    };
    let (clear, other) = if placed.is_clear(one) { (one, another) } else { (another, one) };
    let size = clear.shape.bounds()?.size().length();
    (placed.is_clear(clear) && is_opaque(other)).then_some(NEAR * size)
}

/// Returns whether an object is a lamp that has no inside.
fn is_flat_lamp(placed: &PlacedObjects, object: &Object) -> bool {
    let shines = matches!(placed.material(object).material, Material::Emissive(_));
    shines && matches!(*object.shape, Shape::Quad(_) | Shape::Disc(_) | Shape::Triangle(_))
}

/// Returns the pairs of objects whose surfaces partly coincide. The first one is a clear body or a flat lamp.
///
/// A ray that leaves one of them starts beyond the other and never hits it (row M2 of the stability catalog).
fn coinciding_pairs(placed: &PlacedObjects) -> Vec<(usize, usize)> {
    let objects = &placed.objects;
    let is_checked: Vec<bool> =
        objects.iter().map(|object| placed.is_clear(object) || is_flat_lamp(placed, object)).collect();
    let boxes: Vec<Option<Bounds>> = objects.iter().map(|object| object.shape.bounds()).collect();
    let mut pairs = near_pairs(&boxes, &is_checked);
    pairs.extend(pairs_with_planes(objects, &is_checked).take(MAX_PAIRS));
    pairs.sort_unstable();
    pairs.retain(|&(first, second)| share_surface(&objects[first], &objects[second]));
    pairs
}

/// Returns the pairs of an object marked in `is_checked` and a plane that cuts its box or lies beside it. Two planes
/// always make a pair, since they may be the same.
fn pairs_with_planes(objects: &[Object], is_checked: &[bool]) -> impl Iterator<Item = (usize, usize)> {
    let plane = |number: usize| match &*objects[number].shape {
        Shape::Plane(plane) => Some((number, plane)),
        _ => None,
    };
    let planes: Vec<(usize, &Plane)> = (0..objects.len()).filter_map(plane).collect();
    let pair = move |first: usize, &(second, plane): &(usize, &Plane)| {
        let is_near = match objects[first].shape.bounds() {
            Some(bounds) => plane.meets(&bounds, NEAR),
            None => first < second || first > second && !is_checked[second],
        };
        is_near.then_some((first, second))
    };
    let checked = (0..objects.len()).filter(|&number| is_checked[number]);
    checked.flat_map(move |first| planes.iter().filter_map(|plane| pair(first, plane)).collect::<Vec<_>>())
}

fn share_surface(body: &Object, other: &Object) -> bool {
    if let (Shape::Plane(one), Shape::Plane(another)) = (&*body.shape, &*other.shape) {
        return one.coincides(another, NEAR);
    }
    if let (Shape::Sphere(one), Shape::Sphere(another)) = (&*body.shape, &*other.shape)
        && !one.may_coincide(another)
    {
        return false;
    }
    let Some(bounds) = body.shape.bounds() else { return false };
    let size = bounds.size().length();
    let step = 1e-3 * size;
    (0..COMPARED_RAYS).any(|number| {
        let [u, v, x, y] = Sampler::new(0, [0, 0], number).get_4d(BranchKey::CAMERA, 0);
        let [z, ..] = Sampler::new(0, [1, 0], number).get_4d(BranchKey::CAMERA, 0);
        let Some(mut ray) = ray_into(&bounds, DVec3::new(x, y, z), [u, v]) else { return false };
        let direction = ray.direction;
        for _ in 0..MAX_SURFACES {
            let Some(intersection) = body.shape.intersect(&ray, f64::INFINITY) else { return false };
            let point = body.shape.point(&ray, &intersection);
            let before = Ray { origin: point.position - direction * step, direction };
            if let Some(hit) = other.shape.intersect(&before, step + NEAR * size) {
                let parallel = other.shape.point(&before, &hit).normal.cross(point.normal).length() < 1e-6;
                if hit.t >= step - NEAR * size && parallel {
                    return true;
                }
            }
            ray = point.leave(direction);
        }
        false
    })
}
