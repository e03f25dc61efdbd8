//! Learns where lights that may be mostly hidden are really seen.

use std::cell::RefCell;

use crate::light::{Light, LightId};
use crate::math::{DVec3, Sampler};
use crate::trace::World;
use crate::trace::camera::{PathTracer, SensorEvent, take_sample};
use crate::trace::contribution::FoundBy;
use crate::trace::width::in_lanes;

/// Camera samples along each side of the image.
const SAMPLES_PER_SIDE: u32 = 64;
/// Number of light hits that is enough.
const MAX_HITS: usize = 2048;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6c61_6d70;

/// Learns where lamps that may be mostly hidden are visible. Uses the format, even when a crop or overscan is rendered,
/// so that all parts are rendered the same way.
pub fn learn_visible_caps(world: &mut World) {
    if !world.scene.lights.iter().any(|light| matches!(light, Light::Area(area) if area.can_learn_visible_cap())) {
        return;
    }
    // Let paths hit lamps behind a diffuse surface, even where the image has no such paths.
    let max_diffuse_bounces = std::mem::replace(&mut world.method.diffuse_bounces, u32::MAX);
    let hit = in_lanes!(&world.method.basis, N => look::<N>(world));
    world.method.diffuse_bounces = max_diffuse_bounces;
    for (id, light) in world.scene.lights.iter_mut().enumerate() {
        if let Light::Area(area) = light
            && area.can_learn_visible_cap()
        {
            let normals: Vec<DVec3> = hit.iter().filter(|(light, _)| *light == id).map(|(_, n)| *n).collect();
            area.learn_visible_cap(&normals);
        }
    }
}

/// Returns the lights that paths hit by chance in directions drawn where lights were also sampled, with unit normals.
fn look<const N: usize>(world: &World) -> Vec<(LightId, DVec3)> {
    let film = world.scene.film;
    let hits = RefCell::new(Vec::new());
    let observer = |event: SensorEvent| {
        if let SensorEvent::Light(contribution) = event
            && let (Some(light), FoundBy::Hit { normal: Some(normal), scattered: true }) =
                (contribution.light, contribution.found)
        {
            hits.borrow_mut().push((light, normal));
        }
    };
    let mut tracer = PathTracer::<N>::new(world).with_observer(&observer);
    // A stride that is coprime to the number of places visits them all, far ones first.
    let places = SAMPLES_PER_SIDE * SAMPLES_PER_SIDE;
    for place in (0..places).map(|i| (i * 1597) % places) {
        let [x, y] = film.whole().middle_of_cell(SAMPLES_PER_SIDE, place);
        take_sample(&mut tracer, &Sampler::of_pixel(world.method.seed ^ SEED, [x, y], place), [x, y]);
        if hits.borrow().len() >= MAX_HITS {
            break;
        }
    }
    hits.into_inner()
}
