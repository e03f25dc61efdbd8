//! What polarization changes, measured on some hundred camera samples and some thousand photons.

use super::World;
use super::light_pass::splats;
use super::method::Polarizing;
use super::pass::Pass;
use super::path_tracer::PathTracer;
use super::photon_map;
use super::polarization::Polarization;
use super::seen_light::{SIDE, with_fewer_photons};
use super::width::in_lanes_of;
use crate::math::Sampler;

/// The relative RMS error of light that is taken for unpolarized at every surface, over samples spread over the image.
///
/// The same paths are followed with and without: each lane is told what polarization makes of it, and only the
/// difference is noisy.
pub fn polarization_error(world: &World) -> f64 {
    let world = with_fewer_photons(world).with_polarization(Polarizing::Compared);
    in_lanes_of!(&world, N, P => compare::<N, P>(&world))
}

fn compare<const N: usize, P: Polarization<N>>(world: &World) -> f64 {
    let window = world.scene.film.window();
    let photons = photon_map::photons::<N, P>(world, &Pass::of_photons_alone(world, 0));
    let mut tracer = PathTracer::<N, P>::new(world).with_photons(photons.as_ref());
    let (mut errors, mut squares, mut light) = (0.0, 0.0, 0.0);
    for place in 0..SIDE * SIDE {
        let [x, y] = window.middle_of_cell(SIDE, place);
        let before = tracer.walker.stats;
        tracer.sample(&Sampler::of_pixel(world.method.seed, [x, y], 0), [x, y]);
        let (found, moved) =
            (tracer.walker.stats.light - before.light, tracer.walker.stats.polarization - before.polarization);
        errors += moved * moved;
        squares += (found + moved) * (found + moved);
        light += found;
    }
    let of_samples = if squares > 0.0 { (errors / squares).sqrt() } else { 0.0 };
    // Photons light all pixels, of which so many were looked at.
    let looked_at = f64::from(SIDE * SIDE) / window.pixels() as f64;
    let mut moved = 0.0;
    splats::<N, P>(world, &mut |splat| {
        let shown = looked_at * world.amount(splat.rgb);
        light += shown;
        moved += shown * f64::from(splat.change);
    });
    if light > 0.0 { of_samples.max(moved.abs() / light) } else { of_samples }
}
