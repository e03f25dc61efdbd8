//! Cameras and lights that lie exactly in a surface, neither on one side of it nor on the other.

use super::unlit::name;
use crate::light::Light;
use crate::math::{Bounds, DVec3, Ray};
use crate::scene::Scene;
use crate::spectrum::Curve;

/// Maximum number of lights that are checked.
const MAX_LIGHTS: usize = 4096;
/// Fractions of the scene's size: the distance from which a place is probed, and the distance within which a surface
/// counts as being there. The latter is far above rounding errors and far below anything intended.
const PROBE_DISTANCE: f64 = 1e-7;
const SURFACE_TOLERANCE: f64 = 1e-13;

/// Returns warnings about the camera, point lights and spotlights that lie in a surface.
///
/// Rounding decides where such a light shines (row L9 of the stability catalog). Whether such a camera counts as inside
/// a clear body depends on where it looks.
pub(super) fn on_surface(scene: &Scene<Curve>) -> Vec<String> {
    let places = scene.lights.iter().enumerate().filter_map(|(id, light)| match light {
        Light::Point(point) => Some((id, DVec3::from(point.position))),
        Light::Spot(spot) => Some((id, DVec3::from(spot.position))),
        Light::Area(_) | Light::Sun(_) | Light::Environment(_) => None,
    });
    let (places, camera): (Vec<_>, _) = (places.take(MAX_LIGHTS).collect(), scene.camera.position());
    let boxes = scene.objects.iter().filter_map(|object| object.shape.bounds());
    let around = Bounds::around(places.iter().map(|place| place.1).chain([camera]));
    let around = boxes.fold(around, Bounds::union);
    let size = around.min.abs().max(around.max.abs()).max_element();
    let camera = surface_at(scene, camera, size).filter(|&object| scene.is_clear(object)).map(|object| {
        let body = &scene.objects[object as usize].name;
        format!("the camera lies exactly on the surface of {body}, neither inside nor outside: move it a little")
    });
    let lights = places.into_iter().filter_map(|(id, place)| {
        let object = &scene.objects[surface_at(scene, place, size)? as usize].name;
        let name = name(scene, id);
        Some(format!(
            "{name} lies exactly on the surface of {object}, where rounding decides what it lights: move it a little"
        ))
    });
    camera.into_iter().chain(lights).collect()
}

/// Returns the object in whose surface a place lies, if there is one.
fn surface_at(scene: &Scene<Curve>, place: DVec3, size: f64) -> Option<u32> {
    // At least one of the three axes leads through the surface, whatever its normal.
    DVec3::AXES.into_iter().find_map(|direction| {
        let hit = scene.intersect(&Ray { origin: place - direction * (PROBE_DISTANCE * size), direction })?;
        ((hit.intersection.t - PROBE_DISTANCE * size).abs() <= SURFACE_TOLERANCE * size).then_some(hit.object)
    })
}
