//! Finds the small lights that the camera sees out of focus.

use std::cell::Cell;

use super::small_light::{ApparentLight, Place, SmallLight, SmallLights};
use crate::math::{DVec2, DVec3};
use crate::scene::{Projection, RayEnds};
use crate::trace::highlight::rim;
use crate::trace::lens_light::LensLight;
use crate::trace::{Transport, World};

/// Most lights that are looked for.
const MAX_LIGHTS: usize = 1024;
/// Distance in scene units at which a light in a direction is as if it were infinitely far.
const FAR: f64 = 1e40;
/// Largest radius of a light's disc, as a share of that of the lens: samples of the whole lens hit larger ones often.
const MAX_SHARE: f64 = 0.5;
/// Largest sine of the half angle of a light that counts as small.
const MAX_SIN: f64 = 0.2;
/// Least factor by which a disc is larger than the light's image on the lens.
const MARGIN: f64 = 1.01;
/// Radii of the rings of the lens on which points are looked from, relative to its own.
const RINGS: [f64; 3] = [0.3, 0.6, 0.9];

/// Returns the small lights that the lens blurs, whatever part of the format is rendered.
pub fn blurred_lights(world: &World) -> Vec<LensLight> {
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    let camera = &world.scene.camera;
    let has_lens = camera.has_lens() && camera.projection() != Projection::Equirectangular;
    if !is_random || !has_lens || world.has_mattes {
        return Vec::new();
    }
    let lights = SmallLights::new(world, MAX_LIGHTS);
    let in_parts = lights.in_parts(MAX_LIGHTS).take(MAX_LIGHTS);
    in_parts.filter_map(|light| blurred_light(world, &light)).collect()
}

fn blurred_light(world: &World, light: &SmallLight) -> Option<LensLight> {
    let scene = &world.scene;
    let camera = &scene.camera;
    if light.object.is_some_and(|object| !scene.is_seen(object)) {
        return None;
    }
    let point = match light.place {
        Place::Far { direction, .. } => camera.position() + direction * FAR,
        Place::Near(ball) => ball.center,
    };
    let seen = camera.see(point, [0.5; 2])?;
    let shift = camera.lens_shift(camera.depth(point));
    let radius = radius_on_lens(world, light, point, shift)?;
    let per_pixel = camera.pixel_in_window() * shift;
    let found = LensLight { light: light.id, center: seen.film.to_array(), per_pixel: per_pixel.to_array(), radius };
    (is_in_view(world, &found) && is_unoccluded(world, light, point, &found)).then_some(found)
}

/// Returns the radius of the disc of the lens through which a point of the film sees a light at a point; `None` if the
/// disc is not small.
///
/// For one point of the film, rays through the lens are nearly parallel at a small light. They meet its ball in a
/// circle, which fills an ellipse of the plane that the lens is parallel to.
fn radius_on_lens(world: &World, light: &SmallLight, point: DVec3, shift: f64) -> Option<f64> {
    let camera = &world.scene.camera;
    let (depth, is_parallel) = (camera.depth(point), matches!(camera.projection(), Projection::Orthographic { .. }));
    let ApparentLight { direction, sin, distance } = light.seen_from(camera.see(point, [0.5; 2])?.start);
    let cos = direction.dot(camera.forward());
    // Slopes of the ray through the middle of the lens, and of others against it.
    let (slope, spread) = ((1.0 / (cos * cos) - 1.0).max(0.0).sqrt(), camera.lens_radius() / depth);
    let spread = if is_parallel { spread * (1.0 + 1.0 / shift.abs()) } else { spread };
    let margin = MARGIN + sin + spread * (slope + spread);
    let half_width = if is_parallel { sin * distance / cos } else { sin / (cos * cos) };
    let radius = half_width * shift.abs() * margin;
    let is_small = radius > 0.0 && radius <= MAX_SHARE * camera.lens_radius() && sin < MAX_SIN;
    is_small.then_some(radius)
}

/// Returns whether any point of the format sees some of the light.
fn is_in_view(world: &World, light: &LensLight) -> bool {
    let film = world.scene.film;
    let half = light.half_size(world.scene.camera.lens_radius()) + film.filter.reach();
    let [first, end] = film.whole().ends().map(|at| DVec2::from(at.map(|at| at as f64)));
    let center = DVec2::from(light.center);
    (center + half).cmpge(first).all() && (center - half).cmple(end).all()
}

/// Returns whether the center of a light is seen through some point of the lens.
fn is_unoccluded(world: &World, light: &SmallLight, point: DVec3, found: &LensLight) -> bool {
    let camera = &world.scene.camera;
    let counts = |object| !world.is_see_through(object) && world.scene.is_seen(object);
    let ends = RayEnds { light: light.object, ..RayEnds::default() };
    let rings = RINGS.into_iter().flat_map(|ring| rim().map(move |point| point * ring));
    std::iter::once(DVec2::ZERO).chain(rings).any(|at| {
        let place = at * camera.lens_radius();
        let film = DVec2::from(found.center) + place / DVec2::from(found.per_pixel);
        let ray = camera.ray_from_lens(film, place);
        let distance = (point - ray.origin).length();
        !world.scene.is_occluded_by(&ray, distance, ends, &Cell::new(None), &counts)
    })
}
