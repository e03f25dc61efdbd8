//! Whether caustics that are not seen straight need a map of photons.

use super::caustics::{Sources, targets};
use super::efficiency::rounded;
use super::words::{in_number, percent};
use crate::scene::{AutoText, Scene};
use crate::spectrum::Curve;
use crate::trace::{
    GatheredWorth, LightPass, MapPasses, Method, RAYS_OF_A_LOOK, Smoothness, Transport, World, gathered_worth,
    photons_within, reached_places,
};

/// Most photons per camera sample: from 0.25 to 1 the error for the time hardly changes, where glass is behind glass.
const PHOTONS: f64 = 0.5;
/// Fewest: of fewer a pilot does not know enough.
const FEWEST: f64 = 1.0 / 64.0;
/// How much longer camera samples take that gather wherever they can, as a share: measured in a room by a window.
const GATHERING: f64 = 0.5;
/// Least chance that photons are gathered: of what is rarer a pilot does not know enough.
const RAREST: f64 = 1.0 / 16.0;
/// Solid angle in steradians of lights that rays hit too rarely from where nothing is shown.
const SMALL: f64 = 0.1;
/// Radius in pixels of a map of one sample per pixel.
const RADIUS: f64 = 2.0;
/// Photons of a pass, if fewer are not enough: more would take longer to look through than to send.
const OF_A_PASS: f64 = 32_768.0;
/// Photons of a map that tells whether any are gathered, and what they are worth.
const FEW: u64 = 4096;
/// Fewer where they follow many rays, but never too few.
const FEWEST_SENT: u64 = 512;

/// The light pass with a map, if one is needed, and why. It is settled that none is where photons were weighed that the
/// camera would see straight, and do not pay.
pub(super) fn with_map(
    scene: &Scene<Curve>,
    unguided: &World,
    shown: Option<&LightPass>,
    settled: bool,
) -> (Option<LightPass>, Vec<String>) {
    let method = unguided.method();
    let as_shown = || (shown.cloned(), Vec::new());
    let is_off = matches!(method.transport, Transport::Deterministic { .. }) || scene.render.caustics == AutoText::Off;
    // What coats and narrow lobes throw and the camera would not see straight is not worth photons of its own.
    let is_aimed = shown.is_some() || !targets(scene, &[Smoothness::Whole]).is_empty();
    if is_off || settled || !is_aimed {
        return as_shown();
    }
    let places = reached_places(unguided);
    let samples = unguided.samples_of_the_format();
    let most = f64::from(method.samples);
    // Bias falls with the square of the radius, noise with its inverse: both alike fast with this power of the samples.
    let radius = RADIUS * libm::pow(most, -1.0 / 6.0);
    let passes = |photons: f64, of_a_pass: f64| {
        let all = (photons * samples).ceil();
        let count = (all / of_a_pass).round().clamp(1.0, most);
        MapPasses { count: count as u32, photons: (all / count).ceil() as u64, radius, chance: 1.0 }
    };
    let map = passes(PHOTONS, OF_A_PASS);
    let pass = shown.cloned().unwrap_or_else(|| {
        let Sources { small, openings, .. } = Sources::new(unguided, &places, SMALL);
        let (lights, photons) = (small.iter().map(|light| light.0).collect(), (PHOTONS * samples).ceil() as u64);
        LightPass { photons, lights, openings, to: vec![Smoothness::Whole], map: None }
    });
    if pass.lights.is_empty() {
        return as_shown();
    }
    let asked = |map| Some(LightPass { map: Some(map), ..pass.clone() });
    // A few photons tell whether any are gathered, however many the image will take.
    let affordable = photons_within(&unguided.with_light_pass(asked(map)), RAYS_OF_A_LOOK as f64).max(FEWEST_SENT);
    let few = MapPasses { photons: map.photons.min(FEW).min(affordable), ..map };
    let with_few = unguided.with_light_pass(asked(few));
    let Some(worth) = gathered_worth(&with_few, &places) else { return as_shown() };
    let map = MapPasses { chance: chance(&worth), ..passes(photons(&worth), worth.enough.min(OF_A_PASS)) };
    let line = described(&map, samples, method);
    (asked(map), vec![line])
}

/// What a person is told of a map beside so many camera samples, which are all of them or, with a stop rule, not.
fn described(map: &MapPasses, samples: f64, method: &Method) -> String {
    let photons = match (method.stop.is_some(), map.count) {
        (true, _) => format!("{:.2} photons for each camera sample", map.all_photons() as f64 / samples),
        (false, 1) => format!("1 pass of {} photons", in_number(map.photons)),
        (false, count) => format!("{count} passes of {} photons", in_number(map.photons)),
    };
    let less = match method.stop {
        Some(_) => format!(", less after {} samples", method.samples),
        None => ", less with more samples".into(),
    };
    let chance = match map.chance {
        1.0.. => String::new(),
        chance => format!(
            "; it is read at {} of the places that paths reach, chosen by chance, which saves time",
            percent(chance)
        ),
    };
    format!(
        "photon map: {photons}, for caustics that are seen in mirrors or through glass or light other surfaces; it blurs them by \
         {:.2} pixels{less}{chance}",
        map.radius
    )
}

/// How many photons for each camera sample make the time to an error least.
///
/// An image of n_p camera samples and n_l photons has the variance A / n_p + B / n_l in the time C_p n_p + C_l n_l;
/// their product is least for n_l / n_p = sqrt(B C_p / (A C_l)). Rays stand for time: plans are the same everywhere.
fn photons(worth: &GatheredWorth) -> f64 {
    let samples = worth.samples;
    let best = (worth.variance * samples.rays / (samples.variance * worth.rays)).sqrt();
    if best.is_nan() { PHOTONS } else { rounded(best.clamp(FEWEST, PHOTONS)) }
}

/// At how many of the places that paths reach photons are gathered.
///
/// Where a share q gathers, the second moment M of what a sample gathers adds at most M / q to its variance A, and the
/// time is 1 + q t of one that gathers nowhere; the product is least for q = sqrt(M / (A t)).
fn chance(worth: &GatheredWorth) -> f64 {
    let best = (worth.second_moment / (worth.samples.variance * GATHERING)).sqrt();
    if best.is_nan() { 1.0 } else { rounded(best.clamp(RAREST, 1.0)) }
}
