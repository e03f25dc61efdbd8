//! Decides whether more samples are taken where the noise is.

use crate::film::TELL_VARIANCE;
use crate::scene::{AutoText, Scene};
use crate::spectrum::Curve;
use crate::trace::{Adaptive, FIRST_LOOK, SampleDensity, Transport, World, adaptive};

/// Least gain: how many times as long an equal error must take without adaptive sampling. A pilot is no more precise
/// than this.
const MIN_GAIN: f64 = 1.15;
/// Fewest camera samples of an image: with fewer, a pilot would take more than a few hundredths of the time.
const MIN_SAMPLES: f64 = 4e6;

/// Returns where samples are taken, if uniform sampling would be clearly worse.
///
/// No pixel gets too few samples to tell its variance.
pub(super) fn decide(scene: &Scene<Curve>, world: &World) -> Option<Adaptive> {
    let (film, method) = (world.scene().film, world.method());
    let samples_per_pixel = if method.stop.is_some() { FIRST_LOOK } else { method.samples };
    let samples = f64::from(film.width) * f64::from(film.height) * f64::from(samples_per_pixel);
    let is_requested = scene.render.adaptive == AutoText::Auto && matches!(method.transport, Transport::Random { .. });
    let min_samples = f64::from(samples_per_pixel) * SampleDensity::times(SampleDensity::LEAST);
    if !is_requested || samples < MIN_SAMPLES || min_samples < f64::from(TELL_VARIANCE) {
        return None;
    }
    adaptive(world).filter(|adaptive| adaptive.gain > MIN_GAIN)
}

/// Returns the explanation for the user.
pub(super) fn reason(adaptive: &Adaptive) -> String {
    let powers = &adaptive.density.powers;
    let times = |power: Option<&i8>| SampleDensity::times(*power.unwrap_or(&0));
    format!(
        "adaptive sampling: pixels take {} to {} times the samples, most where the noise is; with the same number \
         everywhere, the same error would take about {:.1} times as long",
        times(powers.iter().min()),
        times(powers.iter().max()),
        adaptive.gain
    )
}
