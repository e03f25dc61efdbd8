//! Decides whether caustics that are not seen directly need a photon map.

use super::caustics::{Sources, targets};
use super::format::{format_count, percent};
use super::photon_gain::rounded;
use crate::scene::{AutoText, Scene};
use crate::spectrum::Curve;
use crate::trace::{
    GatheredWorth, LightPass, MapPasses, Method, RAYS_OF_A_LOOK, Smoothness, Transport, World, gathered_worth,
    photons_within, reached_places,
};

/// Most photons per camera sample: from 0.25 to 1, the error for the time hardly changes where glass is behind glass.
const MAX_PHOTONS_PER_SAMPLE: f64 = 0.5;
/// Fewest photons per camera sample: with fewer, a pilot does not know enough.
const MIN_PHOTONS_PER_SAMPLE: f64 = 1.0 / 64.0;
/// Relative extra time of camera samples that gather wherever they can, measured in a room with a window.
const GATHER_COST: f64 = 0.5;
/// Least probability that photons are gathered: a pilot does not know enough about what is rarer.
const MIN_CHANCE: f64 = 1.0 / 16.0;
/// Solid angle in steradians of lights that rays hit too rarely from where no photons are shown.
const MAX_SOLID_ANGLE: f64 = 0.1;
/// Radius in pixels of a map for one sample per pixel.
const RADIUS: f64 = 2.0;
/// Photons of a pass unless fewer are enough: more would take longer to search than to send.
const PHOTONS_PER_PASS: f64 = 32_768.0;
/// Most photons of a first map, which tells whether any are gathered and what they are worth.
const MAX_TRIAL_PHOTONS: u64 = 4096;
/// Fewest photons of a first map, however many rays they take.
const MIN_TRIAL_PHOTONS: u64 = 512;

/// Returns the light pass with a map, if one is needed, and why. If `no_map`, none is: photons were weighed that the
/// camera would see directly, and they do not pay.
pub(super) fn with_map(
    scene: &Scene<Curve>,
    unguided: &World,
    shown: Option<&LightPass>,
    no_map: bool,
) -> (Option<LightPass>, Vec<String>) {
    let method = unguided.method();
    let without_map = || (shown.cloned(), Vec::new());
    let is_off = matches!(method.transport, Transport::Deterministic { .. }) || scene.render.caustics == AutoText::Off;
    // Caustics of coats and narrow lobes that the camera does not see directly are not worth photons of their own.
    let is_aimed = shown.is_some() || !targets(scene, &[Smoothness::Whole]).is_empty();
    if is_off || no_map || !is_aimed {
        return without_map();
    }
    let places = reached_places(unguided);
    let samples = unguided.samples_of_the_format();
    let samples_per_pixel = f64::from(method.samples);
    // Bias falls with the square of the radius, noise with its inverse: with this power of the samples, equally fast.
    let radius = RADIUS * libm::pow(samples_per_pixel, -1.0 / 6.0);
    let passes = |photons: f64, per_pass: f64| {
        let all = (photons * samples).ceil();
        let count = (all / per_pass).round().clamp(1.0, samples_per_pixel);
        MapPasses { count: count as u32, photons: (all / count).ceil() as u64, radius, chance: 1.0 }
    };
    let map = passes(MAX_PHOTONS_PER_SAMPLE, PHOTONS_PER_PASS);
    let pass = shown.cloned().unwrap_or_else(|| {
        let Sources { small, openings, .. } = Sources::new(unguided, &places, MAX_SOLID_ANGLE);
        let (lights, photons) =
            (small.iter().map(|light| light.0).collect(), (MAX_PHOTONS_PER_SAMPLE * samples).ceil() as u64);
        LightPass { photons, lights, openings, to: vec![Smoothness::Whole], map: None }
    });
    if pass.lights.is_empty() {
        return without_map();
    }
    let pass_with = |map| Some(LightPass { map: Some(map), ..pass.clone() });
    // A few photons tell whether any are gathered, however many the image will take.
    let affordable =
        photons_within(&unguided.with_light_pass(pass_with(map)), RAYS_OF_A_LOOK as f64).max(MIN_TRIAL_PHOTONS);
    let trial_map = MapPasses { photons: map.photons.min(MAX_TRIAL_PHOTONS).min(affordable), ..map };
    let trial_world = unguided.with_light_pass(pass_with(trial_map));
    let Some(worth) = gathered_worth(&trial_world, &places) else { return without_map() };
    let map = MapPasses { chance: chance(&worth), ..passes(photons(&worth), worth.enough.min(PHOTONS_PER_PASS)) };
    let line = describe(&map, samples, method);
    (pass_with(map), vec![line])
}

/// Describes a map to the user, for `samples` camera samples, which are all of them or, with a stop rule, only some.
fn describe(map: &MapPasses, samples: f64, method: &Method) -> String {
    let photons = match (method.stop.is_some(), map.count) {
        (true, _) => format!("{:.2} photons for each camera sample", map.all_photons() as f64 / samples),
        (false, 1) => format!("1 pass of {} photons", format_count(map.photons)),
        (false, count) => format!("{count} passes of {} photons", format_count(map.photons)),
    };
    let less = match method.stop {
        Some(_) => format!(", less after {} samples", method.samples),
        None => ", less with more samples".into(),
    };
    let chance = match map.chance {
        1.0.. => String::new(),
        chance => format!(
            "; it is read at {} of the places that paths reach, chosen at random, which saves time",
            percent(chance)
        ),
    };
    format!(
        "photon map: {photons}, for caustics that are seen in mirrors or through glass or that light other surfaces; \
         it blurs them by {:.2} pixels{less}{chance}",
        map.radius
    )
}

/// Returns the number of photons per camera sample that takes the least time to an error.
///
/// An image of n_p camera samples and n_l photons has the variance A / n_p + B / n_l in the time C_p n_p + C_l n_l.
/// Their product is least for n_l / n_p = sqrt(B C_p / (A C_l)). Rays stand for time: plans are the same everywhere.
fn photons(worth: &GatheredWorth) -> f64 {
    let samples = worth.samples;
    let best = (worth.variance * samples.rays / (samples.variance * worth.rays)).sqrt();
    if best.is_nan() {
        MAX_PHOTONS_PER_SAMPLE
    } else {
        rounded(best.clamp(MIN_PHOTONS_PER_SAMPLE, MAX_PHOTONS_PER_SAMPLE))
    }
}

/// Returns the share of the places that paths reach at which photons are gathered.
///
/// If a share q gathers, the second moment M of what a sample gathers adds at most M / q to its variance A, and the
/// time is 1 + q t times that of a sample that gathers nowhere. The product is least for q = sqrt(M / (A t)).
fn chance(worth: &GatheredWorth) -> f64 {
    let best = (worth.second_moment / (worth.samples.variance * GATHER_COST)).sqrt();
    if best.is_nan() { 1.0 } else { rounded(best.clamp(MIN_CHANCE, 1.0)) }
}
