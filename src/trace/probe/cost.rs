//! Traces a few hundred camera samples ahead, so that the plan can predict costs in numbers.

use std::cell::Cell;
use std::ops::Range;
use std::time::{Duration, Instant};

use crate::math::{Sampler, median};
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::image::PhotonCost;
use crate::trace::parallel::{in_parallel, on_one_thread};
use crate::trace::pass::Pass;
use crate::trace::photon::{
    Batch, LightPaths, PhotonMap, SAMPLES_PER_SET, photons, splat_photon, store_photon, trace_batch,
};
use crate::trace::photon_targets::PhotonTargets;
use crate::trace::stats::Stats;
use crate::trace::walk::{Polarization, Polarized};
use crate::trace::width::{in_lanes, in_lanes_of};
use crate::trace::{MapPasses, RAYS_OF_A_LOOK, World};

/// What a probe measured, per camera sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Rays traced, without shadow rays.
    pub rays: f64,
    /// Share of the samples whose lanes parted.
    pub parted: f64,
    /// Processor time, including that of gathering photons.
    pub time: Duration,
    /// Processor time of light paths, if any are traced, for one sample of every pixel.
    pub light_paths: Duration,
}

/// Processor time per photon; zero where there are no photons of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PhotonTimes {
    /// For a photon of the light pass.
    pub splatted: Duration,
    /// For a photon of a map.
    pub stored: Duration,
}

impl PhotonTimes {
    /// Returns how many camera samples a photon counts as, if a sample takes the given time.
    pub fn in_samples(&self, sample: Duration) -> PhotonCost {
        let sample = sample.max(Duration::from_nanos(1)).as_secs_f64();
        let cost = |photon: Duration| (photon.as_secs_f64() / sample).round().clamp(1.0, MAX_COST) as u64;
        PhotonCost { splatted: cost(self.splatted), stored: cost(self.stored) }
    }
}

/// A larger ratio means that the sample was not measured well.
const MAX_COST: f64 = 100.0;
/// Camera samples along each side of the image.
const SAMPLES_PER_SIDE: u32 = 48;
/// Samples that are timed together.
const BATCH_SIZE: u32 = 16;
/// A batch is timed again if its rays take this many times the median.
const SLOW_RATIO: f64 = 2.0;
/// Photons that are timed together, and the most batches of them.
const PHOTON_BATCH: u64 = 64;
const MAX_BATCHES: u64 = 64;
/// Most photons of the map from which samples gather.
const MAX_STORED: u64 = 4096;
/// Time after which no more camera samples are traced.
const MAX_SAMPLE_TIME: Duration = Duration::from_millis(300);
/// Time after which no more photons are traced; they vary less.
const MAX_PHOTON_TIME: Duration = Duration::from_millis(100);

/// Traces single samples of pixels spread over the part of the image that is rendered.
pub fn probe(world: &World) -> Probe {
    in_lanes_of!(world, N, P => probe_lanes::<N, P>(world))
}

fn probe_lanes<const N: usize, P: Polarization<N>>(world: &World) -> Probe {
    let pixels: Vec<_> = world.scene.film.window().middles_of_cells(SAMPLES_PER_SIDE).collect();
    // Tables that are computed on first use must not count toward the time of a sample.
    let is_rough = |id: u32| world.scene.material_of(id).roughness().is_some_and(|roughness| roughness.value() > 0.0);
    if (0..world.scene.objects.len()).any(|object| is_rough(object as u32)) {
        let mut tracer = PathTracer::<N, P>::new(world);
        for &[x, y] in &pixels[..SAMPLES_PER_SIDE as usize] {
            take_sample(&mut tracer, &Sampler::of_pixel(world.method.seed, [x, y], 0), [x, y]);
        }
    }
    let light_paths = LightPaths::new(world, world.method.seed);
    let before_vertices = Instant::now();
    let vertices =
        light_paths.map(|light_paths| on_one_thread(|| light_paths.vertices_for::<N, P>(0..SAMPLES_PER_SET)));
    let light_paths =
        vertices.as_ref().map_or(Duration::ZERO, |_| before_vertices.elapsed().div_f64(f64::from(SAMPLES_PER_SET)));
    let (few, photons) = with_few_photons::<N, P>(world);
    let mut tracer = PathTracer::<N, P>::new(&few).with_photons(photons.as_ref());
    tracer.light_vertices = vertices.as_ref();
    let parted = Cell::new(0);
    let mut time_batch = |numbers: Range<u32>| {
        let (start, before) = (Instant::now(), tracer.walker.stats.rays);
        for &[x, y] in &pixels[numbers.start as usize..numbers.end as usize] {
            let before = tracer.walker.stats.partings;
            take_sample(&mut tracer, &Sampler::of_pixel(world.method.seed, [x, y], 0), [x, y]);
            parted.set(parted.get() + u32::from(tracer.walker.stats.partings > before));
        }
        BatchTime { time: start.elapsed(), rays: tracer.walker.stats.rays - before }
    };
    let (start, mut batches) = (Instant::now(), Vec::new());
    while batches.len() < (SAMPLES_PER_SIDE * SAMPLES_PER_SIDE / BATCH_SIZE) as usize
        && start.elapsed() < MAX_SAMPLE_TIME
    {
        let first = batches.len() as u32 * BATCH_SIZE;
        batches.push(time_batch(first..first + BATCH_SIZE));
    }
    let (samples, parted) = (batches.len() as u32 * BATCH_SIZE, parted.get());
    let rays = batches.iter().map(|batch| batch.rays).sum::<u64>() as f64 / f64::from(samples);
    let time =
        undisturbed_time(batches, |number| time_batch(number as u32 * BATCH_SIZE..(number as u32 + 1) * BATCH_SIZE));
    let per_sample = 1.0 / f64::from(samples);
    Probe { rays, parted: f64::from(parted) * per_sample, time: time.mul_f64(per_sample), light_paths }
}

/// What a batch took.
#[derive(Clone, Copy)]
struct BatchTime {
    time: Duration,
    rays: u64,
}

/// Returns the total time of all batches. Batches whose rays took much longer than the median are timed again: they are
/// faster if only another process had kept the processor busy.
fn undisturbed_time(batches: Vec<BatchTime>, mut retime: impl FnMut(usize) -> BatchTime) -> Duration {
    let per_ray = |batch: &BatchTime| batch.time.as_secs_f64() / batch.rays.max(1) as f64;
    let slow = median(batches.iter().map(per_ray).collect()).map_or(f64::INFINITY, |median| SLOW_RATIO * median);
    let time = |(number, batch): (usize, &BatchTime)| match per_ray(batch) > slow {
        true => batch.time.min(retime(number).time),
        false => batch.time,
    };
    batches.iter().enumerate().map(time).sum()
}

/// Returns a world whose map has few photons, and this map. As many are gathered around a place as from the full map.
pub fn with_few_photons<const N: usize, P: Polarization<N>>(world: &World) -> (World, Option<PhotonMap<N, P>>) {
    let max_photons = photons_within(world, RAYS_OF_A_LOOK as f64).clamp(PHOTON_BATCH, MAX_STORED);
    let fewer = |map: MapPasses| {
        let photons = map.photons.min(max_photons);
        MapPasses { photons, radius: map.radius * (map.photons as f64 / photons as f64).sqrt(), ..map }
    };
    let pass = world.method.light_pass.as_ref();
    let world = world.with_light_pass(pass.map(|pass| pass.with_map(fewer)));
    let photons = photons::<N, P>(&world, &Pass::for_photons_only(&world, 0));
    (world, photons)
}

/// Estimates how many photons can be traced with `rays` rays, from a few of them. In a heap of glass balls, each takes
/// hundreds of rays.
pub fn photons_within(world: &World, rays: f64) -> u64 {
    let [splatted, stored] = for_both_kinds(world, &|targets, run_batch| {
        let rays_of_photon = |number: usize| {
            let target = targets.target_of_photon((2 * number as u64 + 1) * targets.photons() / (2 * PHOTON_BATCH));
            run_batch(Batch { target, first: number as u64, count: 1, seed: world.method.seed }).rays
        };
        in_parallel(PHOTON_BATCH as usize, &rays_of_photon).into_iter().sum::<u64>()
    });
    (rays * PHOTON_BATCH as f64 / splatted.max(stored).max(1) as f64) as u64
}

type RunBatch<'a> = &'a (dyn Fn(Batch) -> Stats + Sync);

/// Returns what `find` returns for the photons of the light pass and for those of a map, or defaults without them.
fn for_both_kinds<T: Default>(world: &World, find: &dyn Fn(&PhotonTargets, RunBatch) -> T) -> [T; 2] {
    in_lanes!(&world.method.basis, N => {
        let film = world.scene.film;
        let splat_batch = |batch: Batch, targets: &PhotonTargets| {
            let sent = trace_batch(world, targets, batch, false, &splat_photon::<N, Polarized>);
            sent.records.iter().for_each(|placed| placed.spread(film, &mut |_, _| ()));
            sent.stats
        };
        let splatted = |targets: &PhotonTargets| find(targets, &|batch| splat_batch(batch, targets));
        let stored = |targets: &PhotonTargets| find(targets, &|batch| trace_batch(world, targets, batch, false, &store_photon::<N, Polarized>).stats);
        [world.photon_targets.as_ref().map(splatted), world.map_targets.as_ref().map(stored)].map(Option::unwrap_or_default)
    })
}

/// Times some photons, of targets chosen in proportion to the photons they send.
pub fn photon_times(world: &World) -> PhotonTimes {
    let [splatted, stored] =
        for_both_kinds(world, &|targets, run_batch| photon_time(targets, world.method.seed, run_batch));
    PhotonTimes { splatted, stored }
}

fn photon_time(targets: &PhotonTargets, seed: u64, run_batch: RunBatch) -> Duration {
    let time_batch = |number: u64| {
        // Visit distant numbers first: where photons take long, time runs out after a few batches.
        let number = (number * 29) % MAX_BATCHES;
        let target = targets.target_of_photon((2 * number + 1) * targets.photons() / (2 * MAX_BATCHES));
        let start = Instant::now();
        let stats = run_batch(Batch { target, first: number * PHOTON_BATCH, count: PHOTON_BATCH, seed });
        BatchTime { time: start.elapsed(), rays: stats.rays }
    };
    let (start, mut batches) = (Instant::now(), Vec::new());
    while batches.len() < MAX_BATCHES as usize && start.elapsed() < MAX_PHOTON_TIME {
        batches.push(time_batch(batches.len() as u64));
    }
    let photons = batches.len() as f64 * PHOTON_BATCH as f64;
    undisturbed_time(batches, |number| time_batch(number as u64)).div_f64(photons)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photons_count_as_the_samples_that_take_as_long_and_one_at_least() {
        let times = PhotonTimes { splatted: Duration::from_micros(11), stored: Duration::from_micros(1) };
        assert_eq!(times.in_samples(Duration::from_micros(2)), PhotonCost { splatted: 6, stored: 1 });
        assert_eq!(PhotonTimes::default().in_samples(Duration::ZERO), PhotonCost { splatted: 1, stored: 1 });
        assert_eq!(times.in_samples(Duration::ZERO), PhotonCost { splatted: 100, stored: 100 });
    }
}
