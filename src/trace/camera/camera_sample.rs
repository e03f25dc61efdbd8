//! One camera sample of a pixel: its path, what shadow catchers make of it, and what is aimed at highlights.

use super::aimed_samples::{add_aimed_at_highlights, add_aimed_through_lens};
use super::path_tracer::PathTracer;
use super::{catcher, dimensions};
use crate::film::Sample;
use crate::math::{BranchKey, DVec2, Sampler, sample_disk};
use crate::trace::Transport;
use crate::trace::counted::Counted;
use crate::trace::walk::{Path, Polarization};

/// Takes one camera sample of a pixel.
pub fn take_sample<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    sampler: &Sampler,
    [x, y]: [i32; 2],
) -> Sample {
    let world = tracer.walker.world;
    let (camera, filter) = (&world.scene.camera, world.scene.film.filter);
    let four_numbers = |purpose: u32| match world.method.transport {
        Transport::Deterministic { .. } => [0.5; 4],
        Transport::Random { .. } => sampler.get_4d(BranchKey::CAMERA, purpose),
    };
    let [u, v, wavelength, _] = four_numbers(dimensions::PLACE);
    let place = filter.place([u, v]);
    let film = DVec2::new(f64::from(x), f64::from(y)) + place;
    let is_subtracted = filter.subtracts(place);
    let draw = tracer.draw(wavelength);
    let lens_place = camera.has_lens().then(|| {
        let [u, v, ..] = four_numbers(dimensions::LENS);
        sample_disk([u, v]) * camera.lens_radius()
    });
    let ray = lens_place.map_or_else(|| camera.ray(film), |place| camera.ray_from_lens(film, place));
    if let Some(layers) = &mut tracer.sensor.layers {
        layers.begin();
    }
    let path = Path::from_camera(world, &draw, ray);
    if let Some(audit) = &mut tracer.walker.audit {
        audit.begin(&path, &draw);
    }
    let highlights = world.highlights.of_pixel([x, y]);
    let lens_lights = world.lens_lights.seen_from(film);
    tracer.sensor.set_counted(match lens_place.zip(lens_lights) {
        Some((place, lights)) => Counted::OfLens { place, lights },
        None => Counted::ordinary(filter, film, place - 0.5, highlights),
    });
    let first = tracer.trace(&path, &draw, sampler);
    if let (Some(audit), Some(layers)) = (&tracer.walker.audit, &mut tracer.sensor.layers) {
        layers.add_residual(audit, &draw);
    }
    if catcher::is_seen(tracer) {
        let rgb = catcher::catch(tracer, &path, &draw, sampler);
        return Sample { rgb, depth: None, is_subtracted };
    }
    if !highlights.is_empty() {
        add_aimed_at_highlights(tracer, highlights, &draw, sampler, [x, y]);
    }
    if let Some(lights) = lens_lights {
        add_aimed_through_lens(tracer, &lights, &draw, sampler, film);
    }
    let rgb = tracer.sensor.read_out(world, &mut tracer.walker.stats);
    Sample { rgb, depth: first.map(|point| camera.depth(point.position)), is_subtracted }
}
