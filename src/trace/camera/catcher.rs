//! The light of shadow catchers: what the other objects of a scene change of it.

use super::path_tracer::PathTracer;
use crate::math::Sampler;
use crate::scene::Visibility;
use crate::spectrum::Draw;
use crate::trace::media::Media;
use crate::trace::walk::{ObjectSet, Path, Polarization};

/// Returns whether the camera ray of the current sample has hit a shadow catcher.
pub fn is_seen<const N: usize, P: Polarization<N>>(tracer: &PathTracer<N, P>) -> bool {
    let object = tracer.sensor.layers.as_ref().and_then(|layers| layers.sample_row().object);
    object.is_some_and(|object| tracer.walker.world.visibility(object) == Visibility::ShadowCatcher)
}

/// Compares the light of a path that hit a shadow catcher with that of the same path among only the objects of the
/// plate. The image receives neither: it gets 0, or NaN if one is not finite.
#[cold]
pub fn catch<const N: usize, P: Polarization<N>>(
    tracer: &mut PathTracer<N, P>,
    path: &Path<N, P>,
    draw: &Draw<N>,
    sampler: &Sampler,
) -> [f64; 3] {
    let with = std::mem::take(&mut tracer.sensor.rgb);
    let (media, before) = (Media::default(), tracer.walker.stats);
    tracer.trace(&Path { object_set: ObjectSet::Plate, media, ..*path }, draw, sampler);
    tracer.walker.stats.count_once(&before);
    let without = std::mem::take(&mut tracer.sensor.rgb);
    tracer.sensor.reset();
    if let Some(layers) = &mut tracer.sensor.layers {
        layers.catch([with, without]);
    }
    std::array::from_fn(|i| if (with[i] + without[i]).is_finite() { 0.0 } else { f64::NAN })
}
