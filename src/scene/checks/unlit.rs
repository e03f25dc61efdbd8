//! Lights that light nothing that the camera can see.
//!
//! Paths from the camera look for places that a light reaches, and paths from the light look for places that the camera
//! sees. One find in either direction is enough. Light behind a clear body is not followed: a light gets the benefit of
//! the doubt.

use super::probe::hit_from_outside;
use super::view::{SurfaceSide, View};
use crate::light::{Area, Light, LightId};
use crate::material::Material;
use crate::math::{BranchKey, DVec3, Ray, Sampler, sample_cosine_about, sample_sphere, unit};
use crate::scene::Scene;
use crate::shape::{Shape, Sides, SurfacePoint};
use crate::spectrum::Curve;

/// Paths traced from one light.
const PATHS_PER_LIGHT: u32 = 256;
/// Points in all clear bodies that are tested for light from the sky.
const TEST_POINTS: usize = 1024;
/// Rays that look for a hole to the sky. If one of the `FIRST_HOLE_RAYS` finds a hole, it is not a small one.
const HOLE_RAYS: u32 = 1 << 19;
const FIRST_HOLE_RAYS: u32 = 1 << 8;
/// Number of rays after which no more lights are checked.
const MAX_RAYS: u64 = 1 << 20;
/// Maximum number of lights that get a warning each.
const MAX_WARNINGS: usize = 4;

/// Returns a warning about each light of which nothing can be seen.
pub(super) fn unlit(scene: &Scene<Curve>) -> Vec<String> {
    let mut view = View::new(scene);
    // A light that is switched off gets no warning.
    let shines = |id: &LightId| scene.lights[*id].is_sampled() && !scene.lights[*id].emission().is_dark();
    let mut dark: Vec<LightId> = (0..scene.lights.len()).filter(shines).collect();
    view.look(|view, places| {
        let reaches = |id: &LightId| places.iter().any(|place| reaches(view, &scene.lights[*id], place));
        dark.retain(|id| !reaches(id));
        dark.is_empty() || view.rays.get() > MAX_RAYS
    });
    if view.places.is_empty() {
        return empty_view(&view).into_iter().collect();
    }
    if view.rays.get() > MAX_RAYS {
        return Vec::new();
    }
    let is_infinite = |id: &LightId| scene.lights[*id].is_infinite();
    if dark.iter().any(is_infinite) && sees_through_a_hole(&view) {
        dark.retain(|id| !is_infinite(id));
    }
    let mut found: Vec<String> = dark.iter().filter_map(|&id| what_is_wrong(&view, id)).collect();
    if found.len() > MAX_WARNINGS {
        let more = found.len() - MAX_WARNINGS;
        found.truncate(MAX_WARNINGS);
        found.push(format!("{more} more lights light nothing that the camera sees"));
    }
    found
}

/// Returns a warning if the camera sees neither an object nor a sky.
fn empty_view(view: &View) -> Option<String> {
    let Scene { lights, hidden_lights, .. } = view.scene;
    let shows_sky = (0..lights.len()).any(|id| lights[id].is_infinite() && !hidden_lights.contains(&id));
    let is_empty = !lights.is_empty()
        && !shows_sky
        && view.first_objects().all(|first| first.is_none())
        && !view.may_miss_an_object();
    is_empty
        .then(|| "the camera sees no object: none of 576 rays hits one; `look_at` is the point that it looks at".into())
}

/// Returns the name of the object that the camera is inside of, if it sees nothing but the inside of one object. That
/// object is assumed to be opaque.
fn around_the_camera(view: &View) -> Option<String> {
    let mut first = view.first_objects();
    let (object, _) = first.next()??;
    let is_opaque = !view.scene.is_clear(object) && !view.scene.material_of(object).is_see_through();
    let is_inside = is_opaque && first.all(|first| first == Some((object, true)));
    is_inside.then(|| view.scene.objects[object as usize].name.clone())
}

/// Returns what is wrong with a light that no path from the camera has found.
fn what_is_wrong(view: &View, id: LightId) -> Option<String> {
    let light = &view.scene.lights[id];
    let problem = match light {
        _ if view.rays.get() > MAX_RAYS => return None,
        _ if light.is_infinite() => (!reaches_a_clear_body(view, light)).then(|| unseen_text(light)),
        _ => match trace_paths(view, light) {
            Paths::Seen => None,
            Paths::PastEverything => Some(past_everything_text(light)),
            Paths::Unseen => Some(unseen_text(light)),
        },
    }?;
    let name = name(view.scene, id);
    Some(match around_the_camera(view).filter(|_| light.is_infinite()) {
        Some(body) => {
            format!("{name} lights nothing that the camera sees: the camera is inside {body}, which is opaque")
        }
        None => format!("{name} {problem}"),
    })
}

/// The result of paths from a light.
enum Paths {
    /// The camera sees the light or something that it lights, or may do so through a clear body.
    Seen,
    /// They meet no object except the light itself.
    PastEverything,
    /// They meet only what the camera does not see.
    Unseen,
}

/// Returns whether a light reaches a place, or is itself at that place.
fn reaches(view: &View, light: &Light<Curve>, place: &SurfaceSide) -> bool {
    let digits = place.point.position.to_array().map(|x| x.to_bits() as u32);
    let [u, v, ..] = Sampler::new(2, [digits[0], digits[1]], digits[2]).get_random_4d(BranchKey::CAMERA, 0);
    let sample_reaches = || {
        let sample = light.sample_li(&place.point, place.normal, [u, v]).filter(|sample| sample.factor > 0.0)?;
        let is_above = sample.ray.direction.dot(place.normal) > 0.0;
        Some(is_above && !view.is_occluded(&sample.ray, sample.distance, sample.object))
    };
    // Nearly all samples of a sky image may go toward its sun.
    let sees_sky = || {
        let direction = sample_cosine_about(place.normal, [u, v]);
        let shines = matches!(light, Light::Environment(sky) if sky.shines_toward(direction));
        shines && !view.is_occluded(&place.point.leave(direction), f64::INFINITY, None)
    };
    place.shines(light) || sample_reaches() == Some(true) || sees_sky()
}

/// Returns whether light from a sky reaches a clear body, which may send it anywhere.
fn reaches_a_clear_body(view: &View, light: &Light<Curve>) -> bool {
    let clear = (0..view.scene.objects.len()).filter(|&object| view.scene.is_clear(object as u32));
    let boxes: Vec<_> = clear.filter_map(|object| view.scene.objects[object].shape.bounds()).collect();
    (0..TEST_POINTS).filter(|_| !boxes.is_empty()).any(|number| {
        let sampler = Sampler::new(4, [number as u32, 0], 0);
        let ([x, y, z, _], [u, v, ..]) =
            (sampler.get_random_4d(BranchKey::CAMERA, 0), sampler.get_random_4d(BranchKey::CAMERA, 1));
        let bounds = boxes[number % boxes.len()];
        let origin = bounds.min + bounds.size() * DVec3::new(x, y, z);
        let sample = light.sample_li(&SurfacePoint::in_space(origin), sample_sphere([u, v]), [z, x]);
        sample.is_some_and(|sample| !view.is_occluded(&sample.ray, f64::INFINITY, None))
    })
}

/// Returns whether the sky is visible only through a hole that few rays find. What the sky lights beyond the hole may
/// then be visible through it as well.
fn sees_through_a_hole(view: &View) -> bool {
    let sees = |number: u32| {
        let place = &view.places[number as usize % view.places.len()];
        let [u, v, ..] = Sampler::new(5, [number, 0], 0).get_random_4d(BranchKey::CAMERA, 0);
        let ray = place.point.leave(sample_cosine_about(place.normal, [u, v]));
        !view.is_occluded(&ray, f64::INFINITY, None)
    };
    !(0..FIRST_HOLE_RAYS).any(sees) && (FIRST_HOLE_RAYS..HOLE_RAYS).any(sees)
}

/// Traces paths from a lamp, a point light or a spotlight.
fn trace_paths(view: &View, light: &Light<Curve>) -> Paths {
    let own_object = if let Light::Area(area) = light { Some(area.object) } else { None };
    let mut meets_others = false;
    for number in 0..PATHS_PER_LIGHT {
        let sampler = Sampler::new(3, [number, 0], 0);
        let Some(Start { ray, surface }) = sample_start(light, &sampler) else { continue };
        if surface.is_some_and(|place| view.is_in_view(&place)) {
            return Paths::Seen;
        }
        let first = view.scene.intersect(&ray);
        if first.is_some_and(|hit| view.scene.is_clear(hit.object)) {
            return Paths::Seen;
        }
        let seen = view.walk(false, ray, &sampler, |place| {
            meets_others |= own_object != Some(place.object);
            let shines = matches!(view.scene.material_of(place.object), Material::Emissive(_));
            !shines && view.is_seen(&place, number)
        });
        if seen {
            return Paths::Seen;
        }
    }
    if meets_others { Paths::Unseen } else { Paths::PastEverything }
}

/// The start of a path from a light.
struct Start {
    ray: Ray,
    /// The lamp's surface, on the side that shines.
    surface: Option<SurfaceSide>,
}

fn sample_start(light: &Light<Curve>, sampler: &Sampler) -> Option<Start> {
    let [u, v, ..] = sampler.get_random_4d(BranchKey::CAMERA, 1);
    let from_point =
        |origin: [f64; 3], direction| Start { ray: Ray { origin: origin.into(), direction }, surface: None };
    match light {
        Light::Area(area) => sample_lamp_start(area, sampler),
        Light::Point(point) => Some(from_point(point.position, sample_sphere([u, v]))),
        Light::Spot(spot) => Some(from_point(spot.position, unit(spot.cone().sample_uniform([u, v])))),
        Light::Environment(_) | Light::Sun(_) => None,
    }
}

/// Samples a point of a lamp by a ray from outside, and a cosine-distributed direction from there.
fn sample_lamp_start(area: &Area<Curve>, sampler: &Sampler) -> Option<Start> {
    let [x, y, z, _] = sampler.get_random_4d(BranchKey::CAMERA, 1);
    let [a, b, c, d] = sampler.get_random_4d(BranchKey::CAMERA, 2);
    let (point, direction) = hit_from_outside(&area.shape, DVec3::new(x, y, z), [a, b])?;
    let back = area.sides == Sides::Both && point.normal.dot(direction) > 0.0;
    let normal = if back { -point.normal } else { point.normal };
    let ray = point.leave(sample_cosine_about(normal, [c, d]));
    Some(Start { ray, surface: Some(SurfaceSide { point, normal, object: area.object }) })
}

/// Returns the name of a light in messages: that of the object that shines, or the number of the `[[light]]`, counted
/// from 1, and its kind.
pub(super) fn name(scene: &Scene<Curve>, id: LightId) -> String {
    let light = &scene.lights[id];
    if let Light::Area(area) = light {
        return scene.objects[area.object as usize].name.clone();
    }
    let before = scene.lights[..id].iter().filter(|light| !matches!(light, Light::Area(_))).count();
    format!("light {} ({})", before + 1, light.kind_name())
}

/// Returns whether a shape may be inside out, which a sphere cannot be.
fn is_closed_mesh(shape: &Shape) -> bool {
    matches!(shape, Shape::Mesh(_) | Shape::Instance(_)) && shape.is_closed()
}

fn past_everything_text(light: &Light<Curve>) -> &'static str {
    match light {
        Light::Area(area) if area.sides == Sides::Front && is_closed_mesh(&area.shape) => {
            "shines only into its own inside: reverse the corners of its faces, or write sides = \"both\""
        }
        Light::Area(area) if area.sides == Sides::Front => {
            "shines away from every object: turn its front around (swap u and v of a quad, reverse a normal), or write sides = \"both\""
        }
        Light::Spot(_) => "shines past every object: aim it at one, or widen its cone_angle",
        _ => "shines past every object: move it to where its light hits one",
    }
}

fn unseen_text(light: &Light<Curve>) -> &'static str {
    match light {
        Light::Area(area) if area.sides == Sides::Front => {
            "lights nothing that the camera sees: turn its front around, write sides = \"both\", or move it out from \
             behind what hides it"
        }
        Light::Sun(_) => {
            "lights nothing that the camera sees: `toward` points from the scene to the sun, and nothing opaque may \
             block it"
        }
        Light::Environment(_) => {
            "lights nothing that the camera sees: opaque surfaces block it on all sides, except perhaps for a hole \
             that no ray found; open them, or leave it out"
        }
        _ => "lights nothing that the camera sees: turn it, or move it out from behind what hides it",
    }
}
