//! Finds which light made a pixel stand out in one of the replicates.

use std::cell::Cell;
use std::ops::Range;

use super::noise::Outlier;
use super::passes::max_pass_samples;
use super::stopping::next_stage_size;
use crate::math::Sampler;
use crate::trace::World;
use crate::trace::camera::{PathTracer, SensorEvent, take_sample};
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::pass::Pass;
use crate::trace::photon::PassLight;
use crate::trace::walk::Polarization;
use crate::trace::width::in_lanes_of;

/// Light that only one of the replicates found.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RareLight {
    /// The name of the light; `None` where photons of several were gathered.
    pub name: Option<String>,
    /// How often surfaces scattered, mirrored or refracted it on its way.
    pub bounces: u32,
    /// How it was found.
    pub found: &'static str,
}

/// Share of the pixel's light in the replicate that one path must have contributed to be what stands out.
const MIN_SHARE: f64 = 0.2;

/// Repeats the samples of the pixel that stands out, up to `each` of each replicate, and finds the brightest light
/// among them. Returns `None` if it was a photon that the camera saw, which belongs to no sample.
pub fn rare_light(world: &World, outlier: &Outlier, each: u32) -> Option<RareLight> {
    in_lanes_of!(world, N, P => brightest::<N, P>(world, outlier, each))
}

fn brightest<const N: usize, P: Polarization<N>>(world: &World, outlier: &Outlier, each: u32) -> Option<RareLight> {
    // The brightest light that a sample received, and its amount.
    let best_of_sample: Cell<Option<(f64, Contribution)>> = Cell::new(None);
    let observer = |found: SensorEvent| {
        let SensorEvent::Light(contribution) = found else { return };
        let amount = world.amount(contribution.rgb);
        if amount > best_of_sample.get().map_or(0.0, |most| most.0) && amount.is_finite() {
            best_of_sample.set(Some((amount, *contribution)));
        }
    };
    let pixel = outlier.pixel.map(|place| place as i32);
    let (mut all, mut brightest) = (0.0, None::<(f64, Contribution)>);
    for numbers in numbers_of_passes(world, each) {
        let pass = Pass::of_replicate(world, 0, numbers, outlier.replicate);
        let light = PassLight::<N, P>::new(world, &pass);
        // Layers tell which samples a shadow catcher takes.
        let tracer = PathTracer::<N, P>::new(world).with_photons(light.photons.as_ref()).with_observer(&observer);
        let mut tracer = tracer.with_layers();
        let rate = world.rate(pixel);
        for number in rate.sample_numbers(&pass.numbers) {
            tracer.light_vertices = light.vertices(rate.average_number(number) - pass.numbers.start);
            let sample = take_sample(&mut tracer, &Sampler::of_pixel(pass.seed, pixel, number), pixel);
            let splatted = world.amount(sample.rgb);
            all += splatted;
            let brighter =
                |found: &(f64, Contribution)| splatted > 0.0 && brightest.is_none_or(|most| found.0 > most.0);
            brightest = best_of_sample.take().filter(brighter).or(brightest);
        }
    }
    let (_, found) = brightest.filter(|(amount, _)| *amount > MIN_SHARE * all)?;
    let name = found.light.map(|light| world.scene.light_groups[light].clone());
    Some(RareLight { name, bounces: found.bounces, found: technique_name(found.found) })
}

/// Returns the samples of a replicate's passes, up to `each`, in the stages of the render: the light of a pass depends
/// on its length. Samples after a stage that ran out of time may differ.
fn numbers_of_passes(world: &World, each: u32) -> Vec<Range<u32>> {
    let (mut passes, mut before, most) = (Vec::new(), 0, max_pass_samples(world));
    while before < each {
        let size = world.method.stop.as_ref().map_or(each, |stop| next_stage_size(stop, before));
        let end = before + size.min(each - before);
        passes.extend((before..end).step_by(most as usize).map(|start| start..end.min(start + most)));
        before = end;
    }
    passes
}

fn technique_name(found: FoundBy) -> &'static str {
    match found {
        FoundBy::Hit { .. } => "met by chance",
        FoundBy::Sampled => "sampled",
        FoundBy::Connected => "met on its way",
        FoundBy::Gathered => "gathered from photons",
        FoundBy::Splatted => "shown by photons",
    }
}
