//! Whether photons are worth their time, and how many.

use crate::light::{Light, LightId};
use crate::scene::Scene;
use crate::spectrum::{Curve, Distinct, Emission, apply};
use crate::trace::{PhotonWorth, World, photons_worth, pilot_noise};

/// Of a lamp's radiance, what the camera sees of it by way of a smooth surface and one that scatters: about half.
const LEFT: f64 = 0.5;
/// A gain below this is none: a pilot does not know better.
const CLEARLY: f64 = 1.1;

/// What photons of some lights are worth beside camera samples.
pub(super) struct Worth {
    /// The photons of those lights whose photons lower the time to an error.
    pub(super) photons: Vec<PhotonWorth>,
    /// How many times as long chance takes to the same error; none where it misses light for good, or there is no
    /// light.
    pub(super) gain: Option<f64>,
}

/// Weighs photons of some lights, which the world sends, against chance.
///
/// A light that is left to chance adds to the noise of camera samples: one that meets the lamp sees f of its radiance,
/// and does so as often as makes the mean right, so that its second moment is f times the mean. How many photons there
/// are is found when all else is decided.
pub(super) fn weigh(scene: &Scene<Curve>, world: &World) -> Worth {
    let mut colors = Distinct::default();
    let mut spike = |photons: &PhotonWorth| {
        let of_light = |light: &LightId| radiance(scene, *light, &mut colors).unwrap_or(f64::INFINITY);
        LEFT * photons.lights.iter().map(of_light).sum::<f64>() / photons.lights.len() as f64
    };
    let mut known: Vec<_> = photons_worth(world).into_iter().map(|photons| (spike(&photons), photons)).collect();
    // Those first whose photons save most.
    let saves = |(spike, photons): &(f64, PhotonWorth)| spike * photons.brings.iter().sum::<f64>().abs();
    let costs = |photons: &PhotonWorth| photons.variance * photons.rays;
    known.sort_by(|a, b| (saves(b) * costs(&a.1)).total_cmp(&(saves(a) * costs(&b.1))));
    let (spikes, mut photons): (Vec<f64>, Vec<PhotonWorth>) = known.into_iter().unzip();
    let noise = pilot_noise(world);
    let totals: Vec<f64> = (0..=photons.len()).map(|sent| noise.least_work(&photons, &spikes, sent)).collect();
    let best = (0..totals.len()).min_by(|&a, &b| totals[a].total_cmp(&totals[b])).unwrap_or(0);
    let best = if totals[0] > CLEARLY * totals[best] { best } else { 0 };
    let gain = totals[0] / totals[if best == 0 { photons.len() } else { best }];
    let gain = (gain.is_finite() && !photons.is_empty()).then_some(gain);
    photons.truncate(best);
    Worth { photons, gain }
}

/// The nearest power of the square root of 2: the least of time x variance is flat, and rounding must not change an
/// image.
pub(super) fn rounded(photons: f64) -> f64 {
    libm::exp2(0.5 * (2.0 * libm::log2(photons)).round())
}

/// X + Y + Z of a light's radiance; none of one that has no extent.
fn radiance(scene: &Scene<Curve>, light: LightId, colors: &mut Distinct<[f64; 3]>) -> Option<f64> {
    let light = &scene.lights[light];
    let factor = match light {
        Light::Area(area) => area.brightness(),
        Light::Environment(environment) => environment.bright()?.radiance(),
        Light::Sun(sun) if sun.angular_diameter > 0.0 => sun.radiance_factor(),
        _ => return None,
    };
    let space = scene.film.color_space;
    let color = colors.of(light.emission(), |curve| Emission::new(curve, space).color());
    Some(apply(&space.to_xyz(), color).iter().sum::<f64>() * factor)
}
