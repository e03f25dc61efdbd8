//! How far apart two colors show the scene behind dispersive surfaces.

use super::color_walk::{CameraRays, ColorWalk};
use super::targets::SEEN_PIXELS;
use crate::light::Light;
use crate::math::{DVec2, DVec3};
use crate::spectrum::Table;
use crate::trace::World;

/// Lengths of the steps to a ray's neighbors, in pixels. With the longer one, the neighbors on both sides of an edge
/// are as far apart as two colors that are just not seen apart.
const NEIGHBOR_STEPS: [f64; 2] = [0.5 * SEEN_PIXELS, 0.1 * SEEN_PIXELS];
/// Number of places along each side of a pixel whose light is examined.
const PLACES_PER_SIDE: u32 = 6;

/// Returns how many pixels apart two colors show what lies behind; `None` if an edge is too close to tell.
pub fn color_separation(rays: &CameraRays, point: DVec2, first: &ColorWalk) -> Option<f64> {
    let second = rays.walk(point, 1);
    let far = pixel_separation(rays, NEIGHBOR_STEPS[0], point, [first, &second]);
    (far >= SEEN_PIXELS || pixel_separation(rays, NEIGHBOR_STEPS[1], point, [first, &second]) < SEEN_PIXELS)
        .then_some(far)
}

/// Returns the share of a pixel's light that dispersion pulls apart. Facets far smaller than a pixel count by area.
pub fn separated_share(rays: &CameraRays, middle: DVec2) -> f64 {
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(PLACES_PER_SIDE) - 0.5;
    let share = |i: u32| {
        let point = middle + DVec2::new(place(i % PLACES_PER_SIDE), place(i / PLACES_PER_SIDE));
        let walks = [0, 1].map(|lane| rays.walk(point, lane));
        let [first, second] = &walks;
        let is_separated = || {
            // After other surfaces, light comes from elsewhere: among such facets, neighbors carry no information.
            may_differ(rays, [first, second]) && first.legs.len() != second.legs.len()
                || pixel_separation(rays, NEIGHBOR_STEPS[1], point, [first, second]) >= SEEN_PIXELS
        };
        if first.dispersive && is_separated() { first.weight } else { 0.0 }
    };
    (0..PLACES_PER_SIDE * PLACES_PER_SIDE).map(share).sum::<f64>() / f64::from(PLACES_PER_SIDE * PLACES_PER_SIDE)
}

/// Returns whether no walk is lost, and what they show may differ.
fn may_differ(rays: &CameraRays, walks: [&ColorWalk; 2]) -> bool {
    let lost = walks.iter().any(|walk| walk.weight == 0.0);
    let all_leave = walks.iter().all(|walk| walk.leaves_scene());
    // If skies are uniform, all walks that leave the scene see the same.
    !(lost || all_leave && skies_seen(rays.colors.world).all(Light::is_even_sky))
}

/// Returns how many pixels apart two colors show what lies behind.
///
/// The walks of a ray's neighbors, one step aside, show how far a pixel reaches. Both colors are compared at one
/// distance, so that an edge behind the glass that only one of them misses does not count.
fn pixel_separation(rays: &CameraRays, step: f64, point: DVec2, walks: [&ColorWalk; 2]) -> f64 {
    let [first, second] = walks;
    if !may_differ(rays, walks) {
        return 0.0;
    }
    let distance = walks.map(ColorWalk::length).into_iter().find(|length| length.is_finite());
    let separation = distance_between(first, second, distance);
    let neighbor = |x: f64, y: f64| rays.walk(point + DVec2::new(x, y) * step, 0);
    let offsets = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
    let stretch =
        offsets.map(|(x, y)| distance_between(first, &neighbor(x, y), distance)).into_iter().fold(0.0, f64::max);
    // Parallel rays stay parallel behind flat glass. There a pixel has the angle that the camera gives it.
    let min_stretch = if distance.is_none() { rays.colors.world.scene.camera.pixel_angle() * step } else { 0.0 };
    let stretch = if stretch > 0.0 { stretch } else { min_stretch };
    if stretch > 0.0 { separation / (stretch / step) } else { 0.0 }
}

/// Returns how far apart two walks are at a distance along their last segments, or the angle between these.
fn distance_between(a: &ColorWalk, b: &ColorWalk, distance: Option<f64>) -> f64 {
    let (Some(a), Some(b)) = (a.last(), b.last()) else { return 0.0 };
    match distance {
        Some(distance) => (a.at(distance) - b.at(distance)).length(),
        None => angle(a.direction, b.direction),
    }
}

/// Returns whether rays that leave the scene see nothing.
pub fn is_dark(world: &World) -> bool {
    skies_seen(world).next().is_none()
}

fn skies_seen(world: &World) -> impl Iterator<Item = &Light<Table>> {
    world.scene.infinite_lights.iter().map(|&sky| &world.scene.lights[sky]).filter(|sky| sky.is_extended())
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}
