//! Samples of a pixel that are aimed at its highlights.

use super::dimensions;
use super::path_tracer::PathTracer;
use crate::math::{BranchKey, Sampler};
use crate::spectrum::Draw;
use crate::trace::highlight::{Counted, SeenHighlight, chosen, offset};
use crate::trace::walk::{Path, Polarization};

/// Adds the light of samples that are aimed at highlights of a pixel to what the sensor has received: one for each, or
/// for some of them if there are many.
///
/// These samples tell nothing of what the pixel shows otherwise, and do not count for what paths leave out.
pub fn add_aimed<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    highlights: &[SeenHighlight],
    draw: &Draw<N>,
    sampler: &Sampler,
    pixel: [i32; 2],
) {
    let world = tracer.walker.world;
    let (before, audit) = (tracer.walker.stats, tracer.walker.audit.take());
    let [u, v, choice, _] = sampler.get_4d(BranchKey::CAMERA, dimensions::HIGHLIGHT);
    for highlight in chosen(highlights, choice) {
        let film = highlight.sample([u, v]);
        let offset = offset(film, pixel);
        let counted = Counted::aimed(world.scene.film.filter, film, offset, highlight, highlights);
        if let Some(counted) = counted {
            let path = Path::from_camera(world, draw, world.scene.camera.ray(film));
            tracer.sensor.set_counted(counted);
            tracer.trace(&path, draw, sampler);
        }
    }
    tracer.sensor.set_counted(Counted::ALL);
    tracer.walker.stats.count_once(&before);
    tracer.walker.audit = audit;
}
