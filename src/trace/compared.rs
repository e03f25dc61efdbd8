//! What polarization changes, measured on some hundred camera samples and some thousand photons.

use super::World;
use super::method::Polarizing;
use super::polarization::Polarization;
use super::seen_light::{By, for_each_light, with_fewer_photons};
use super::width::in_lanes_of;

/// The relative RMS error of light that is taken for unpolarized at every surface, over samples spread over the image.
///
/// The same paths are followed with and without: each lane is told what polarization makes of it, and only the
/// difference is noisy.
pub fn polarization_error(world: &World) -> f64 {
    let world = with_fewer_photons(world).with_polarization(Polarizing::Compared);
    in_lanes_of!(&world, N, P => compare::<N, P>(&world))
}

fn compare<const N: usize, P: Polarization<N>>(world: &World) -> f64 {
    let (mut errors, mut squares, mut all) = (0.0, 0.0, 0.0);
    let mut of_photons = 0.0;
    for_each_light::<N, P>(world, &mut |_, light, change, by| {
        all += light;
        match by {
            By::Sample => {
                errors += change * change;
                squares += (light + change) * (light + change);
            }
            By::Photon => of_photons += change,
        }
    });
    let of_samples = if squares > 0.0 { f64::sqrt(errors / squares) } else { 0.0 };
    if all > 0.0 { of_samples.max(f64::abs(of_photons) / all) } else { of_samples }
}
