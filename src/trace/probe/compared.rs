//! What polarization changes, measured on some hundred camera samples and some thousand photons.

use super::seen_light::{Amount, SIDE, for_each_light, with_fewer_photons};
use crate::film::Window;
use crate::trace::World;
use crate::trace::method::Polarizing;
use crate::trace::width::in_lanes_of;

/// The relative RMS error of light that is taken for unpolarized at every surface, over small cells of the image, over
/// large ones, or of all light together, whichever is most: so few photons may light an image that no cell has two.
///
/// The same paths are followed with and without: each lane is told what polarization makes of it, and only the
/// difference is noisy. Two copies of each cell know nothing of each other, so the mean of their product has no part of
/// that noise, as a square would have; one standard error is added for what they have not hit.
pub fn polarization_error(world: &World) -> f64 {
    let world = with_fewer_photons(world).with_polarization(Polarizing::Compared);
    let mut grids = SIDES.map(|side| Cells::new(world.scene.film.window(), side));
    let mut all = Amount::default();
    let mut take = |pixel, copy, found| {
        grids.iter_mut().for_each(|cells| cells.add(pixel, copy, found));
        all += found;
    };
    in_lanes_of!(&world, N, P => for_each_light::<N, P>(&world, 2, &mut take));
    let lit = all.light + all.change;
    let of_all = if lit > 0.0 { all.change.abs() / lit } else { 0.0 };
    grids.iter().map(Cells::error).fold(of_all, f64::max)
}

/// Cells along each side of the image: of one sample each, and so large that thin beams bring photons to both copies.
const SIDES: [u32; 2] = [SIDE, SIDE / 4];

/// What cells of the image show in both copies.
struct Cells {
    window: Window,
    side: u32,
    cells: Vec<[Amount; 2]>,
}

impl Cells {
    fn new(window: Window, side: u32) -> Self {
        Self { window, side, cells: vec![[Amount::default(); 2]; (side * side) as usize] }
    }

    fn add(&mut self, pixel: [u32; 2], copy: usize, found: Amount) {
        self.cells[self.window.cell_of(self.side, pixel)][copy] += found;
    }

    fn error(&self) -> f64 {
        let (mut errors, mut spread, mut squares) = (0.0, 0.0, 0.0);
        for [a, b] in &self.cells {
            let error = a.change * b.change;
            errors += error;
            spread += error * error;
            squares += (a.light + a.change) * (b.light + b.change);
        }
        // Of an image with fewer pixels, cells are empty.
        let count = f64::from(self.window.width.min(self.side) * self.window.height.min(self.side));
        let chance = f64::sqrt((spread - errors * errors / count).max(0.0));
        if squares > 0.0 { f64::sqrt((f64::max(errors, 0.0) + chance) / squares) } else { 0.0 }
    }
}
