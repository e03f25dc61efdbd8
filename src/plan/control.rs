//! Whether one hero adds what dispersion changes, in place of several that bring all the light.

use super::lit::Lit;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{World, control_gain};

/// How much shorter an equal error must take: a pilot knows no better.
const CLEARLY: f64 = 1.25;
/// Fewest camera samples of an image: of a smaller one a pilot would take more than a few hundredths of the time.
const LARGE: f64 = 4e5;

/// The world that takes less work to an equal error, with its photons, and what a person is told where that is not the
/// one given. Photons of one wavelength each tell less of a caustic, so both are weighed. Where spectra are asked for,
/// each band would have the noise of the one wavelength.
pub(super) fn decide(scene: &Scene<Curve>, unlit: &World, plain: Lit) -> (Lit, Option<String>) {
    let (film, samples) = (unlit.scene().film, f64::from(unlit.method().samples));
    let is_large = f64::from(film.width) * f64::from(film.height) * samples >= LARGE;
    let can_be = is_large && scene.format.spectral.is_none();
    let gain = if can_be { control_gain(&plain.world).filter(|&gain| gain > CLEARLY) } else { None };
    let Some(of_samples) = gain else { return (plain, None) };
    let lit = Lit::new(scene, &unlit.with_control());
    let of_both = plain.work.zip(lit.work).map_or(of_samples, |(plain, work)| plain / work);
    let gain = of_samples.min(of_both);
    if gain > CLEARLY { (lit, Some(reason(gain))) } else { (plain, None) }
}

fn reason(gain: f64) -> String {
    format!(
        "dispersion as a difference: all lanes also go through glass together, and one hero wavelength adds what \
         dispersion changes; with more heroes instead, the same error would take about {gain:.1} times as long"
    )
}
