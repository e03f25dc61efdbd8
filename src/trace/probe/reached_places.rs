//! What the plan needs to know about a photon map before it is made.

use super::camera_events::collect_events;
use crate::math::{DVec3, median};
use crate::trace::World;
use crate::trace::camera::SensorEvent;
use crate::trace::photon::PhotonMap;
use crate::trace::width::in_lanes;

/// Camera samples along each side of the image that find where the camera's paths lead.
const SAMPLES_PER_SIDE: u32 = 24;
/// Number of places whose distance to their neighbors is computed.
const SPACING_PLACES: usize = 256;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6c6f_6f6b;

/// Returns places on widely scattering surfaces that camera paths reach via others; the same for any part rendered.
pub fn reached_places(world: &World) -> Vec<DVec3> {
    let place = |event: SensorEvent| match event {
        SensorEvent::Place(place) => Some(place),
        _ => None,
    };
    in_lanes!(&world.method.basis, N => collect_events::<N, _>(world, SAMPLES_PER_SIDE, SEED, None, place))
}

/// Whether any photon lies within a pixel of one of the places, if `SAMPLES_PER_SIDE`^2 pixels filled the image.
pub fn has_photon_near<const N: usize>(world: &World, places: &[DVec3], photons: &PhotonMap<N>) -> bool {
    let coarse = f64::from(world.scene.film.width) / f64::from(SAMPLES_PER_SIDE);
    places.iter().any(|&place| photons.count_near(place, coarse * pixel_width_at(world, place)) > 0)
}

/// Whether any photon lies closer to a place than neighboring places do: paths may lead to more than the camera sees.
pub fn has_photon_among<const N: usize>(places: &[DVec3], photons: &PhotonMap<N>) -> bool {
    let place_spacing = place_spacing(places);
    places.iter().any(|&place| photons.count_near(place, place_spacing) > 0)
}

/// Returns the distance between neighboring places: the median of a few.
fn place_spacing(places: &[DVec3]) -> f64 {
    let nearest_squared = |(number, &place): (usize, &DVec3)| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != number);
        others.map(|(_, other)| other.distance_squared(place)).fold(f64::INFINITY, f64::min)
    };
    let squares = places.iter().enumerate().step_by(places.len() / SPACING_PLACES + 1).map(nearest_squared);
    median(squares.collect()).filter(|square| square.is_finite()).map_or(0.0, f64::sqrt)
}

/// Returns the mean number of photons that are examined around a place.
pub fn mean_photons_examined<const N: usize>(world: &World, places: &[DVec3], photons: &PhotonMap<N>) -> f64 {
    let count = |&place: &DVec3| photons.count_near(place, photons.kernel.radius * pixel_width_at(world, place));
    places.iter().map(count).sum::<u64>() as f64 / places.len() as f64
}

/// Returns the width of a pixel at a place that is seen directly.
fn pixel_width_at(world: &World, place: DVec3) -> f64 {
    let camera = &world.scene.camera;
    camera.pixel_width((place - camera.position()).length())
}
