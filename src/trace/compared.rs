//! What polarization changes, measured on some hundred camera samples and some thousand photons.

use super::World;
use super::method::Polarizing;
use super::polarization::Polarization;
use super::seen_light::{Found, for_each_light, with_fewer_photons};
use super::width::in_lanes_of;

/// The relative RMS error of light that is taken for unpolarized at every surface, over places spread over the image:
/// what it is likely to be at most.
///
/// The same paths are followed with and without: each lane is told what polarization makes of it, and only the
/// difference is noisy. Two samples of each pixel know nothing of each other, so the mean of their product has no part
/// of that noise, as a square would have; one standard error is added for the places that were not looked at.
pub fn polarization_error(world: &World) -> f64 {
    let world = with_fewer_photons(world).with_polarization(Polarizing::Compared);
    in_lanes_of!(&world, N, P => compare::<N, P>(&world))
}

fn compare<const N: usize, P: Polarization<N>>(world: &World) -> f64 {
    let (mut places, mut errors, mut spread, mut squares) = (0.0, 0.0, 0.0, 0.0);
    let (mut all, mut of_photons) = (0.0, 0.0);
    for_each_light::<N, P, 2>(world, &mut |_, found| match found {
        Found::Samples([a, b]) => {
            let error = a.change * b.change;
            places += 1.0;
            errors += error;
            spread += error * error;
            squares += (a.light + a.change) * (b.light + b.change);
            all += 0.5 * (a.light + b.light);
        }
        Found::Photon(photon) => {
            all += photon.light;
            of_photons += photon.change;
        }
    });
    let chance = f64::sqrt((spread - errors * errors / places).max(0.0));
    let errors = f64::max(errors, 0.0) + chance;
    let of_samples = if squares > 0.0 { f64::sqrt(errors / squares) } else { 0.0 };
    if all > 0.0 { of_samples.max(f64::abs(of_photons) / all) } else { of_samples }
}
