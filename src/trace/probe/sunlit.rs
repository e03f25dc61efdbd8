//! Where paths start from suns for light vertices: toward places in their light that the camera's paths find.

use std::cell::Cell;
use std::collections::BTreeMap;

use super::brightness::bounces;
use super::clusters::span;
use crate::light::{Light, LightId};
use crate::math::{DVec3, Ray};
use crate::scene::Ends;
use crate::shape::Ball;
use crate::trace::camera::Bounce;
use crate::trace::guide::cell_of;
use crate::trace::path_start::place_in_disc;
use crate::trace::photon::{LightPaths, can_be_followed};
use crate::trace::width::in_lanes;
use crate::trace::{Sunlit, World};

/// Camera samples along each side of the image.
const SIDE: u32 = 48;
/// Most suns that are looked at.
const SUNS: usize = 4;
/// Fewest places that tell where paths should start.
const FEWEST: usize = 16;
/// Share of the light that may lie beyond each side of a box around the places.
const BEYOND: f64 = 0.01;
/// Of the way to a place, how far off it the ray to the sun starts: it only guides.
const OFF: f64 = 1e-6;

/// The world with light vertices; none where there is no light that can be followed forward.
pub fn with_light_vertices(world: &World) -> Option<World> {
    let world = can_be_followed(world).then(|| world.with_light_vertices(sunlit_places(world)))?;
    LightPaths::new(&world, world.method.seed).is_some().then_some(world)
}

/// The places in the light of each sun that bounces find, if they are some. The format counts, also where a part of it
/// or more is made, so that all parts are made alike.
fn sunlit_places(world: &World) -> Vec<Sunlit> {
    let lights = &world.scene.lights;
    let suns: Vec<LightId> = (0..lights.len()).filter(|&id| matches!(lights[id], Light::Sun(_))).take(SUNS).collect();
    if suns.is_empty() {
        return Vec::new();
    }
    let bounces = in_lanes!(&world.method.basis, N => bounces::<N>(world, SIDE));
    // Where they ended, a little before the surface, and what light they found there.
    let has_found = |bounce: &&Bounce| bounce.distance.is_finite() && bounce.light.is_finite() && bounce.light > 0.0;
    let end = |bounce: &Bounce| (bounce.from + bounce.direction * (bounce.distance * (1.0 - OFF)), bounce.light);
    let ends: Vec<(DVec3, f64)> = bounces.iter().filter(has_found).map(end).collect();
    suns.into_iter().filter_map(|sun| of_sun(world, sun, &ends)).collect()
}

/// Those in the light of one sun.
fn of_sun(world: &World, id: LightId, ends: &[(DVec3, f64)]) -> Option<Sunlit> {
    let light = &world.scene.lights[id];
    let Light::Sun(sun) = light else { return None };
    let direction = sun.middle();
    let (last_occluder, counts) = (Cell::new(None), |object| !world.is_see_through(object));
    let is_lit = |(origin, _): &&(DVec3, f64)| {
        let ray = Ray { origin: *origin, direction };
        !world.scene.is_occluded_by(&ray, f64::INFINITY, Ends::default(), &last_occluder, &counts)
    };
    let lit: Vec<(DVec3, f64)> = ends.iter().filter(is_lit).copied().collect();
    if lit.len() < FEWEST {
        return None;
    }
    let all: f64 = lit.iter().map(|place| place.1).sum();
    let [x, y, z] = DVec3::AXES.map(|axis| span(&lit, all, axis, BEYOND));
    let [low, high] = [0, 1].map(|i| DVec3::new(x[i], y[i], z[i]));
    let (center, radius) = (0.5 * (low + high), 0.5 * (high - low).length());
    let beam = light.beam(&Ball { center, radius })?;
    let mut cells = BTreeMap::new();
    for (origin, light_there) in lit {
        if let Some(place) = place_in_disc(light, &beam, &Ray { origin, direction }) {
            *cells.entry(cell_of(place) as u32).or_insert(0.0) += (light_there / all) as f32;
        }
    }
    Some(Sunlit { light: id, center, radius, cells: cells.into_iter().collect() })
}
