//! What the plan needs to know about a photon map before it is made.

use super::findings::found_all_over;
use crate::math::{DVec3, median};
use crate::trace::World;
use crate::trace::camera::SensorEvent;
use crate::trace::photon::PhotonMap;
use crate::trace::width::in_lanes;

/// Camera samples along each side of the image that find where the camera's paths lead.
const SIDE: u32 = 24;
/// Number of places whose distance to their neighbors is computed.
const FEW: usize = 256;
/// Sets these random numbers apart from those of the image.
const LOOKING: u64 = 0x6c6f_6f6b;

/// Returns places on widely scattering surfaces that camera paths reach via others; the same for any part rendered.
pub fn reached_places(world: &World) -> Vec<DVec3> {
    let place = |finding: SensorEvent| match finding {
        SensorEvent::Place(place) => Some(place),
        _ => None,
    };
    in_lanes!(&world.method.basis, N => found_all_over::<N, _>(world, SIDE, LOOKING, None, place))
}

/// Whether any photon lies within a pixel of one of the places, if `SIDE` times `SIDE` pixels filled the image.
pub fn reaches_photons<const N: usize>(world: &World, places: &[DVec3], photons: &PhotonMap<N>) -> bool {
    let coarse = f64::from(world.scene.film.width) / f64::from(SIDE);
    places.iter().any(|&place| photons.count_near(place, coarse * pixel_at(world, place)) > 0)
}

/// Whether any photon lies closer to a place than neighboring places do: paths may lead to more than the camera sees.
pub fn lie_among<const N: usize>(places: &[DVec3], photons: &PhotonMap<N>) -> bool {
    let apart = apart(places);
    places.iter().any(|&place| photons.count_near(place, apart) > 0)
}

/// Returns the distance between neighboring places: the median of a few.
fn apart(places: &[DVec3]) -> f64 {
    let next = |(number, &place): (usize, &DVec3)| {
        let others = places.iter().enumerate().filter(|(other, _)| *other != number);
        others.map(|(_, other)| other.distance_squared(place)).fold(f64::INFINITY, f64::min)
    };
    let squares = places.iter().enumerate().step_by(places.len() / FEW + 1).map(next);
    median(squares.collect()).filter(|square| square.is_finite()).map_or(0.0, f64::sqrt)
}

/// Returns the mean number of photons that are examined around a place.
pub fn looked_through<const N: usize>(world: &World, places: &[DVec3], photons: &PhotonMap<N>) -> f64 {
    let count = |&place: &DVec3| photons.count_near(place, photons.kernel.radius * pixel_at(world, place));
    places.iter().map(count).sum::<u64>() as f64 / places.len() as f64
}

/// Returns the width of a pixel at a place that is seen directly.
fn pixel_at(world: &World, place: DVec3) -> f64 {
    let camera = &world.scene.camera;
    camera.pixel_width((place - camera.position()).length())
}
