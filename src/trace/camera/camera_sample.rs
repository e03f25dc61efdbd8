//! One camera sample of a pixel: its path, what shadow catchers make of it, and what is aimed at highlights.

use super::highlight_samples::add_aimed;
use super::path_tracer::PathTracer;
use super::{catcher, dimensions};
use crate::film::Sample;
use crate::math::{BranchKey, DVec2, Sampler};
use crate::trace::Transport;
use crate::trace::highlight::Counted;
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
    let ray = if camera.has_lens() {
        let [u, v, ..] = four_numbers(dimensions::LENS);
        camera.lens_ray(film, [u, v])
    } else {
        camera.ray(film)
    };
    if let Some(layers) = &mut tracer.sensor.layers {
        layers.begin();
    }
    let path = Path::from_camera(world, &draw, ray);
    if let Some(audit) = &mut tracer.walker.audit {
        audit.begin(&path, &draw);
    }
    let highlights = world.highlights.of_pixel([x, y]);
    tracer.sensor.set_counted(Counted::ordinary(filter, film, place - 0.5, highlights));
    let first = tracer.trace(&path, &draw, sampler);
    if let (Some(audit), Some(layers)) = (&tracer.walker.audit, &mut tracer.sensor.layers) {
        layers.add_residual(audit, &draw);
    }
    if catcher::is_seen(tracer) {
        let rgb = catcher::catch(tracer, &path, &draw, sampler);
        return Sample { rgb, depth: None, is_subtracted };
    }
    if !highlights.is_empty() {
        add_aimed(tracer, highlights, &draw, sampler, [x, y]);
    }
    let rgb = tracer.sensor.read_out(world, &mut tracer.walker.stats);
    Sample { rgb, depth: first.map(|point| camera.depth(point.position)), is_subtracted }
}
