//! A few hundred camera samples, traced ahead so that the plan can speak in numbers.

use std::time::{Duration, Instant};

use super::World;
use super::light_vertices::{LightVertices, SHARED};
use super::path_tracer::PathTracer;
use super::photon::Landing;
use super::photon_batch::{batches, send};
use super::walker::Walker;
use super::width::in_lanes;
use crate::math::Sampler;

/// What a probe found, per camera sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Camera samples traced.
    pub samples: u32,
    /// Rays followed, without those to lights.
    pub rays: f64,
    /// Share of the samples whose lanes parted.
    pub parted: f64,
    /// Processor time: of the median ray, times the rays of a mean sample, so that what else the processor did does not
    /// count.
    pub time: Duration,
    /// The same of a photon, if any are sent.
    pub photon: Duration,
    /// Of light paths, if any are followed, for one sample of every pixel.
    pub light_paths: Duration,
}

/// Camera samples along each side of the image.
const SIDE: u32 = 24;
/// Samples that are timed together.
const BATCH: u32 = 16;
/// Photons of an target, and of how many targets.
const FEW: u64 = 512;
const TARGETS: usize = 8;
/// Time after which the probe has seen enough.
const ENOUGH: Duration = Duration::from_millis(300);

/// Traces single samples of pixels spread over the part of the image that is made.
pub fn probe(world: &World) -> Probe {
    in_lanes!(&world.method.basis, N => probe_lanes::<N>(world))
}

fn probe_lanes<const N: usize>(world: &World) -> Probe {
    // Tables that are computed when first needed are no part of a sample's time.
    let rough = |id: u32| world.scene.material_of(id).roughness().is_some_and(|roughness| roughness > 0.0);
    if (0..world.scene.objects.len()).any(|object| rough(object as u32)) {
        let mut tracer = PathTracer::<N>::new(world);
        let window = world.scene.film.window();
        for place in 0..SIDE {
            let at = |place: u32, size: u32| (u64::from(place) * u64::from(size) / u64::from(SIDE)) as u32;
            let (x, y) = (at(place * 7 % SIDE, window.width), at(place, window.height));
            let (x, y) = (window.left + x, window.top + y);
            tracer.sample(&Sampler::new(world.method.seed, [x, y], 0), [x, y]);
        }
    }
    let before_vertices = Instant::now();
    let vertices = LightVertices::<N>::shared(world, 0);
    let shared = before_vertices.elapsed();
    let mut tracer = PathTracer::<N>::new(world);
    tracer.light_vertices = vertices.as_ref();
    let (mut samples, mut parted) = (0_u32, 0);
    let window = world.scene.film.window();
    let start = Instant::now();
    let (mut before_batch, mut per_ray) = ((start, 0), Vec::new());
    // A stride that is coprime to the number of places visits them all, far ones first.
    let places = SIDE * SIDE;
    for place in (0..places).map(|i| (i * 229) % places) {
        let [x, y] = window.middle_of_cell(SIDE, place);
        let before = tracer.walker.stats.partings;
        tracer.sample(&Sampler::new(world.method.seed, [x, y], 0), [x, y]);
        samples += 1;
        parted += u32::from(tracer.walker.stats.partings > before);
        if samples.is_multiple_of(BATCH) || start.elapsed() > ENOUGH {
            let (then, rays) = before_batch;
            before_batch = (Instant::now(), tracer.walker.stats.rays);
            per_ray.push((before_batch.0 - then).as_secs_f64() / (before_batch.1 - rays).max(1) as f64);
        }
        if start.elapsed() > ENOUGH {
            break;
        }
    }
    per_ray.sort_by(f64::total_cmp);
    let per_sample = 1.0 / f64::from(samples);
    let rays = tracer.walker.stats.rays as f64 * per_sample;
    Probe {
        samples,
        rays,
        parted: f64::from(parted) * per_sample,
        time: Duration::from_secs_f64(per_ray[per_ray.len() / 2] * rays),
        photon: photon_time::<N>(world),
        light_paths: vertices.map_or(Duration::ZERO, |_| shared.div_f64(f64::from(SHARED))),
    }
}

/// The time that a photon takes: the median of the targets, most photons of a light being alike.
fn photon_time<const N: usize>(world: &World) -> Duration {
    let Some(targets) = &world.photon_targets else { return Duration::ZERO };
    let time = |batch| {
        let start = Instant::now();
        send(world, targets, batch, true, |_: &Walker<N>, _: &Landing<N>, _: &Sampler, kept| kept.push(()));
        start.elapsed().div_f64(FEW as f64)
    };
    let batches = batches(targets, |_| 0, |_| FEW, world.method.seed);
    let step = batches.len().div_ceil(TARGETS).max(1);
    let mut times: Vec<Duration> = batches.into_iter().step_by(step).map(time).collect();
    times.sort();
    times[times.len() / 2]
}
