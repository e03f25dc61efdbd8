//! Collects what paths from the camera find, all over the image.

use std::cell::RefCell;

use crate::math::Sampler;
use crate::trace::camera::{PathTracer, SensorEvent, take_sample};
use crate::trace::photon::LightVertices;
use crate::trace::{RAYS_OF_A_LOOK, World};

/// Traces `side` x `side` camera samples over the image, or fewer if the ray budget runs out, and collects what
/// `select` keeps of their events. `seed` keeps their random numbers apart from others.
pub fn collect_events<const N: usize, T>(
    world: &World,
    side: u32,
    seed: u64,
    vertices: Option<&LightVertices<N>>,
    select: impl Fn(SensorEvent) -> Option<T>,
) -> Vec<T> {
    let found = RefCell::new(Vec::new());
    let observer = |event: SensorEvent| found.borrow_mut().extend(select(event));
    let mut tracer = PathTracer::<N>::new(world).with_observer(&observer);
    tracer.light_vertices = vertices;
    for (place, pixel) in (0..).zip(world.scene.film.whole().middles_of_cells(side)) {
        take_sample(&mut tracer, &Sampler::of_pixel(world.method.seed ^ seed, pixel, place), pixel);
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    found.into_inner()
}
