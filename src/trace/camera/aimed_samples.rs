//! Samples of a pixel that are aimed at small lights and highlights.
//!
//! These samples tell nothing of what the pixel shows otherwise, and do not count for what paths leave out.

use super::dimensions;
use super::path_tracer::PathTracer;
use crate::math::{BranchKey, DVec2, Ray, Sampler};
use crate::spectrum::Draw;
use crate::trace::counted::Counted;
use crate::trace::highlight::{SeenHighlight, chosen, offset};
use crate::trace::lens_light::SeenLensLights;
use crate::trace::walk::{Path, Polarization};

/// A sample that is aimed at a light.
struct AimedSample<'a> {
    ray: Ray,
    counted: Counted<'a>,
}

/// Adds the light of samples that are aimed at highlights of a pixel to what the sensor has received: one for each, or
/// for some of them if there are many.
pub fn add_aimed_at_highlights<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    highlights: &[SeenHighlight],
    draw: &Draw<N>,
    sampler: &Sampler,
    pixel: [i32; 2],
) {
    let world = tracer.walker.world;
    let scene = &world.scene;
    let [u, v, choice, _] = sampler.get_4d(BranchKey::CAMERA, dimensions::HIGHLIGHT);
    let samples = chosen(highlights.iter(), |highlight| highlight.count, choice).filter_map(|highlight| {
        let film = highlight.sample([u, v]);
        let counted = Counted::aimed(scene.film.filter, film, offset(film, pixel), highlight, highlights)?;
        Some(AimedSample { ray: scene.camera.ray(film), counted })
    });
    add_samples(tracer, draw, sampler, samples);
}

/// Adds the light of samples that look from a point of the film, through the lens, at lights that the lens blurs.
pub fn add_aimed_through_lens<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    lights: &SeenLensLights,
    draw: &Draw<N>,
    sampler: &Sampler,
    film: DVec2,
) {
    let world = tracer.walker.world;
    let camera = &world.scene.camera;
    let [u, v, choice, _] = sampler.get_4d(BranchKey::CAMERA, dimensions::HIGHLIGHT);
    let samples = lights.aimed([u, v, choice]).map(|point| AimedSample {
        ray: camera.ray_from_lens(film, point.place),
        counted: Counted::through_lens(&point, lights),
    });
    add_samples(tracer, draw, sampler, samples);
}

fn add_samples<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    draw: &Draw<N>,
    sampler: &Sampler,
    samples: impl Iterator<Item = AimedSample<'static>>,
) {
    let (before, audit) = (tracer.walker.stats, tracer.walker.audit.take());
    for AimedSample { ray, counted } in samples {
        let path = Path::from_camera(tracer.walker.world, draw, ray);
        tracer.sensor.set_counted(counted);
        tracer.trace(&path, draw, sampler);
    }
    tracer.sensor.set_counted(Counted::ALL);
    tracer.walker.stats.count_once(&before);
    tracer.walker.audit = audit;
}
