//! Whether light that surfaces send each other is also looked for at vertices of light paths.

use crate::trace::{World, resampling_gain};

/// How much shorter an equal error must take: a pilot knows no better.
const CLEARLY: f64 = 1.25;
/// Fewest camera samples of an image: of a smaller one there would be so few light paths that their noise, which all
/// pixels share, shows in means over the image.
const LARGE: f64 = 1e6;

/// How many times as long an equal error takes without light vertices, where they pay. Their paths know no dyes.
pub(super) fn gain(world: &World) -> Option<f64> {
    let (film, method) = (world.scene().film, world.method());
    let samples = f64::from(film.width) * f64::from(film.height) * f64::from(method.samples);
    if samples < LARGE || method.diffuse_bounces == 0 || world.fluoresces() {
        return None;
    }
    resampling_gain(world).filter(|&gain| gain > CLEARLY)
}

/// What a person is told of them.
pub(super) fn reason(gain: f64) -> String {
    format!(
        "light between surfaces is looked for at light vertices; without them, the same error would take about {gain:.1} times as long"
    )
}
