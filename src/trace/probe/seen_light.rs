//! Estimates how much of the visible light polarization may change, from a few hundred camera samples and a few
//! thousand photons.

use std::ops::AddAssign;

use super::cost::photons_within;
use crate::math::Sampler;
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::image::for_each_splat;
use crate::trace::pass::Pass;
use crate::trace::photon::photons;
use crate::trace::walk::{Polarization, Polarized};
use crate::trace::width::in_lanes;
use crate::trace::{LightPass, MapPasses, RAYS_OF_A_LOOK, World};

/// Camera samples along each side of the image.
pub const SAMPLES_PER_SIDE: u32 = 24;
/// Parts of the view along each side.
const PARTS_PER_SIDE: u32 = 6;
/// Most photons of the light pass and of the map, and the fewest of either, however many rays they take.
const MAX_PHOTONS: u64 = 2048;
const MIN_PHOTONS: u64 = 256;

/// Returns the largest share by which polarization may change the light of a 36th of the view. Measures the part of the
/// image that is rendered, with fewer photons than the world's method has.
pub fn most_changed(world: &World) -> f64 {
    let world = with_fewer_photons(world);
    let window = world.scene.film.window();
    let mut parts = [SeenLight::default(); (PARTS_PER_SIDE * PARTS_PER_SIDE) as usize];
    let mut record = |pixel, _, found| parts[window.cell_of(PARTS_PER_SIDE, pixel)] += found;
    in_lanes!(&world.method.basis, N => for_each_light::<N, Polarized>(&world, 1, &mut record));
    parts.into_iter().map(SeenLight::share).fold(0.0, f64::max)
}

/// Returns the world with fewer photons than its method has.
pub fn with_fewer_photons(world: &World) -> World {
    let max_photons = photons_within(world, RAYS_OF_A_LOOK as f64).clamp(MIN_PHOTONS, MAX_PHOTONS);
    let limit_map = |map: MapPasses| MapPasses { photons: map.photons.min(max_photons), ..map };
    let limit_pass =
        |pass: &LightPass| LightPass { photons: pass.photons.min(max_photons), ..pass.with_map(limit_map) };
    world.with_light_pass(world.method.light_pass.as_ref().map(limit_pass))
}

/// The light that is seen, as X + Y + Z, and by how much polarization changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SeenLight {
    pub light: f64,
    pub change: f64,
}

impl SeenLight {
    /// Returns the share of the light by which polarization changes it.
    fn share(self) -> f64 {
        if self.light > 0.0 { self.change / self.light } else { 0.0 }
    }
}

impl AddAssign for SeenLight {
    fn add_assign(&mut self, more: Self) {
        (self.light, self.change) = (self.light + more.light, self.change + more.change);
    }
}

/// Renders one or two statistically independent copies of the view, and calls `record` with each result: the pixel
/// (relative to the window's corner), the index of the copy, and the light found. Takes one camera sample in each of
/// [`SAMPLES_PER_SIDE`] x [`SAMPLES_PER_SIDE`] cells until the rays run out; photons are scaled to the same number of
/// pixels.
pub fn for_each_light<const N: usize, P: Polarization<N>>(
    world: &World,
    copies: usize,
    record: &mut dyn FnMut([u32; 2], usize, SeenLight),
) {
    let window = world.scene.film.window();
    let photons = photons::<N, P>(world, &Pass::for_photons_only(world, 0));
    let mut tracer = PathTracer::<N, P>::new(world).with_photons(photons.as_ref());
    let mut samples = 0;
    // In an image of fewer pixels than cells, each pixel is visited several times, with other random numbers each time.
    let mut looks = [0; (SAMPLES_PER_SIDE * SAMPLES_PER_SIDE) as usize];
    for [x, y] in window.middles_of_cells(SAMPLES_PER_SIDE) {
        let pixel = [(x - window.left) as u32, (y - window.top) as u32];
        let look = &mut looks[window.cell_of(SAMPLES_PER_SIDE, pixel)];
        for copy in 0..copies {
            let before = tracer.walker.stats;
            take_sample(
                &mut tracer,
                &Sampler::of_pixel(world.method.seed.wrapping_add(copy as u64), [x, y], *look),
                [x, y],
            );
            let after = tracer.walker.stats;
            let found =
                SeenLight { light: after.light - before.light, change: after.polarization - before.polarization };
            record(pixel, copy, found);
            samples += 1;
        }
        *look += 1;
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    // Photons light all pixels, of which camera samples looked at this share.
    let visited_share = f64::from(samples) / window.pixels() as f64;
    for_each_splat::<N, P>(world, &mut |pixel, splat| {
        let light = visited_share * world.amount(splat.rgb);
        let pixel = [pixel % window.width, pixel / window.width];
        let copy = if splat.first_half { 0 } else { copies - 1 };
        record(pixel, copy, SeenLight { light, change: light * f64::from(splat.change) });
    });
}
