//! How much of the light seen polarization may change, by some hundred camera samples and some thousand photons.

use std::ops::AddAssign;

use super::cost::photons_within;
use crate::math::Sampler;
use crate::trace::camera::PathTracer;
use crate::trace::image::splats;
use crate::trace::pass::Pass;
use crate::trace::photon::photons;
use crate::trace::walk::{Polarization, Polarized};
use crate::trace::width::in_lanes;
use crate::trace::{LightPass, MapPasses, RAYS_OF_A_LOOK, World};

/// Camera samples along each side of the image.
pub const SIDE: u32 = 24;
/// Parts of the view along each side.
const PARTS: u32 = 6;
/// Most photons that are shown, and most that are gathered; and the fewest, however many rays they follow.
const MOST: u64 = 2048;
const FEWEST: u64 = 256;

/// By which share of its light polarization may change a 36th of the view, where that is most: of the part of the image
/// that is made, with fewer photons than the world's method asks for.
pub fn most_changed(world: &World) -> f64 {
    let world = with_fewer_photons(world);
    let window = world.scene.film.window();
    let mut parts = [Amount::default(); (PARTS * PARTS) as usize];
    let mut take = |pixel, _, found| parts[window.cell_of(PARTS, pixel)] += found;
    in_lanes!(&world.method.basis, N => for_each_light::<N, Polarized>(&world, 1, &mut take));
    parts.into_iter().map(Amount::share).fold(0.0, f64::max)
}

/// The world with fewer photons than its method asks for.
pub fn with_fewer_photons(world: &World) -> World {
    let most = photons_within(world, RAYS_OF_A_LOOK as f64).clamp(FEWEST, MOST);
    let of_map = |map: MapPasses| MapPasses { photons: map.photons.min(most), ..map };
    let fewer = |pass: &LightPass| LightPass { photons: pass.photons.min(most), ..pass.with_map(of_map) };
    world.with_light_pass(world.method.light_pass.as_ref().map(fewer))
}

/// Light that is seen, X + Y + Z, and by how much polarization changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Amount {
    pub light: f64,
    pub change: f64,
}

impl Amount {
    /// The share of the light by which polarization changes it.
    fn share(self) -> f64 {
        if self.light > 0.0 { self.change / self.light } else { 0.0 }
    }
}

impl AddAssign for Amount {
    fn add_assign(&mut self, more: Self) {
        (self.light, self.change) = (self.light + more.light, self.change + more.change);
    }
}

/// Hands over the light of one or two copies of the view, which know nothing of each other: the pixel, counted from the
/// window's corner, the copy, and what of it a sample found, one in each of [`SIDE`] x [`SIDE`] cells as far as there
/// are rays for them, or photons bring to as many.
pub fn for_each_light<const N: usize, P: Polarization<N>>(
    world: &World,
    copies: usize,
    take: &mut dyn FnMut([u32; 2], usize, Amount),
) {
    let window = world.scene.film.window();
    let photons = photons::<N, P>(world, &Pass::of_photons_alone(world, 0));
    let mut tracer = PathTracer::<N, P>::new(world).with_photons(photons.as_ref());
    let mut samples = 0;
    // Of an image with fewer pixels than cells, each is looked at several times, by other random numbers.
    let mut looks = [0; (SIDE * SIDE) as usize];
    for [x, y] in window.middles_of_cells(SIDE) {
        let pixel = [(x - window.left) as u32, (y - window.top) as u32];
        let look = &mut looks[window.cell_of(SIDE, pixel)];
        for copy in 0..copies {
            let before = tracer.walker.stats;
            tracer.sample(&Sampler::of_pixel(world.method.seed.wrapping_add(copy as u64), [x, y], *look), [x, y]);
            let after = tracer.walker.stats;
            let found = Amount { light: after.light - before.light, change: after.polarization - before.polarization };
            take(pixel, copy, found);
            samples += 1;
        }
        *look += 1;
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    // Photons light all pixels, of which so many were looked at.
    let looked_at = f64::from(samples) / window.pixels() as f64;
    splats::<N, P>(world, &mut |pixel, splat| {
        let light = looked_at * world.amount(splat.rgb);
        let pixel = [pixel % window.width, pixel / window.width];
        let copy = if splat.early { 0 } else { copies - 1 };
        take(pixel, copy, Amount { light, change: light * f64::from(splat.change) });
    });
}
