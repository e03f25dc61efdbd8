//! What the plan asks of a map of photons before it is made.

use std::cell::RefCell;

use crate::math::{DVec3, Sampler};
use crate::trace::camera::{Observer, PathTracer};
use crate::trace::photon::PhotonMap;
use crate::trace::width::in_lanes;
use crate::trace::{RAYS_OF_A_LOOK, World};

/// Camera samples along each side of the image that look where the camera's paths lead.
const SIDE: u32 = 24;
/// Sets their random numbers apart.
const LOOKING: u64 = 0x6c6f_6f6b;

/// Places on surfaces that scatter widely to which paths from the camera come by way of others; the same whatever part
/// of the image is made.
pub fn reached_places(world: &World) -> Vec<DVec3> {
    in_lanes!(&world.method.basis, N => look::<N>(world))
}

fn look<const N: usize>(world: &World) -> Vec<DVec3> {
    let film = world.scene.film;
    let reached = Reached::default();
    let mut tracer = PathTracer::<N>::new(world).with_observer(&reached);
    for (place, [x, y]) in (0..).zip(film.whole().middles_of_cells(SIDE)) {
        tracer.sample(&Sampler::of_pixel(world.method.seed ^ LOOKING, [x, y], place), [x, y]);
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    reached.0.into_inner()
}

/// All places that were told of.
#[derive(Default)]
struct Reached(RefCell<Vec<DVec3>>);

impl Observer for Reached {
    fn reach(&self, place: DVec3) {
        self.0.borrow_mut().push(place);
    }
}

/// Whether any photon lies within a pixel of such places, where all of `SIDE` times `SIDE` fill the image.
pub fn reaches_photons<const N: usize>(world: &World, places: &[DVec3], photons: &PhotonMap<N>) -> bool {
    let camera = &world.scene.camera;
    let coarse = f64::from(world.scene.film.width) / f64::from(SIDE);
    places.iter().any(|&place| {
        let radius = coarse * camera.pixel_width((place - camera.position()).length());
        photons.any_near(place, radius)
    })
}
