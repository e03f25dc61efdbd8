//! Finds where paths of suns and bright skies start for light vertices: toward lit places that camera paths find.

use std::cell::Cell;
use std::collections::BTreeMap;

use super::brightness::bounces;
use super::clusters::trimmed_bounds;
use crate::light::{LightId, Opening};
use crate::math::{BranchKey, DVec3, Ray, Sampler};
use crate::scene::RayEnds;
use crate::shape::Ball;
use crate::trace::camera::Bounce;
use crate::trace::guide::cell_of;
use crate::trace::photon::{LightPaths, can_trace_light_paths};
use crate::trace::{SkyOpenings, SunlitPlaces, World};

/// Camera samples along each side of the image.
const SAMPLES_PER_SIDE: u32 = 48;
/// Most suns and skies that are considered.
const MAX_SUNS: usize = 4;
/// Fewest places that tell where paths should start.
const MIN_PLACES: usize = 16;
/// Points along each side of an opening.
const OPENING_POINTS: u32 = 16;
/// How far before the end of a bounce the ray to the sun starts, as a share of its length: it only guides.
const END_OFFSET: f64 = 1e-6;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x7375_6e73;

/// Returns the world with light vertices; paths of skies start through some openings. Returns `None` if no light can be
/// traced forward, or if light vertices would spoil the layer of a faint lamp.
pub fn with_light_vertices(world: &World, openings: &SkyOpenings) -> Option<World> {
    let world = can_trace_light_paths(world)
        .then(|| world.with_light_vertices(sunlit_places(world, &openings.openings), openings.clone()))?;
    LightPaths::new(&world, world.method.seed).is_some_and(|paths| !paths.have_starved_layer()).then_some(world)
}

/// Returns the places lit by each sun and each bright part of a sky: those that bounces find or, if too few, the
/// openings through which it shines. Uses the format, whatever part of it is rendered, so that all parts are the same.
fn sunlit_places(world: &World, openings: &[Opening]) -> Vec<SunlitPlaces> {
    let lights = &world.scene.lights;
    let is_sun = |&id: &LightId| lights[id].is_infinite() && lights[id].sends_photons();
    let suns: Vec<LightId> = (0..lights.len()).filter(is_sun).take(MAX_SUNS).collect();
    if suns.is_empty() {
        return Vec::new();
    }
    let bounces = bounces(world, SAMPLES_PER_SIDE);
    // Where the bounces ended, slightly before the surface, and what light they found there.
    let has_light = |bounce: &&Bounce| bounce.distance.is_finite() && bounce.light.is_finite() && bounce.light > 0.0;
    let end = |bounce: &Bounce| (bounce.from + bounce.direction * (bounce.distance * (1.0 - END_OFFSET)), bounce.light);
    let ends: Vec<(DVec3, f64)> = bounces.iter().filter(has_light).map(end).collect();
    let opening_points: Vec<(DVec3, f64)> = openings.iter().flat_map(points_of).collect();
    let lit_places =
        |sun: LightId| places_lit_by(world, sun, &ends).or_else(|| places_lit_by(world, sun, &opening_points));
    suns.into_iter().filter_map(lit_places).collect()
}

/// Returns points all over an opening, including its edges, each with its part of the area.
fn points_of(opening: &Opening) -> impl Iterator<Item = (DVec3, f64)> {
    let at = |i: u32| f64::from(i) / f64::from(OPENING_POINTS - 1);
    let weight = opening.area() / f64::from(OPENING_POINTS * OPENING_POINTS);
    (0..OPENING_POINTS * OPENING_POINTS)
        .map(move |i| (opening.point([at(i % OPENING_POINTS), at(i / OPENING_POINTS)]), weight))
}

/// Returns the places in the light of one sun, if there are enough.
fn places_lit_by(world: &World, id: LightId, ends: &[(DVec3, f64)]) -> Option<SunlitPlaces> {
    let light = &world.scene.lights[id];
    let (last_occluder, blocks) = (Cell::new(None), |object| !world.is_see_through(object));
    let lit_place = |(number, &(origin, found)): (u32, &(DVec3, f64))| {
        let u = Sampler::new(world.method.seed ^ SEED, [0, 0], number).get_random_4d(BranchKey::CAMERA, 0);
        let direction = light.bright_direction([u[0], u[1]])?;
        let ray = Ray { origin, direction };
        let is_hidden = world.scene.is_occluded_by(&ray, f64::INFINITY, RayEnds::default(), &last_occluder, &blocks);
        (!is_hidden).then_some(((origin, found), direction))
    };
    let (lit, directions): (Vec<(DVec3, f64)>, Vec<DVec3>) = (0..).zip(ends).filter_map(lit_place).unzip();
    if lit.len() < MIN_PLACES {
        return None;
    }
    let total: f64 = lit.iter().map(|place| place.1).sum();
    let ball = Ball::of_box(&trimmed_bounds(&lit, total));
    let beam = light.beam(&ball)?;
    let mut cells = BTreeMap::new();
    for ((origin, found), direction) in lit.into_iter().zip(directions) {
        if let Some(place) = beam.place_in_disc(origin, direction) {
            *cells.entry(cell_of(place) as u32).or_insert(0.0) += (found / total) as f32;
        }
    }
    Some(SunlitPlaces { light: id, center: ball.center, radius: ball.radius, cells: cells.into_iter().collect() })
}
