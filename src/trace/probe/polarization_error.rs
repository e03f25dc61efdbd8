//! Measures what polarization changes, with a few hundred camera samples and a few thousand photons.

use super::seen_light::{SAMPLES_PER_SIDE, SeenLight, for_each_light, with_fewer_photons};
use crate::film::Window;
use crate::trace::World;
use crate::trace::method::Polarizing;
use crate::trace::width::in_lanes_of;

/// Returns the relative RMS error of treating light as unpolarized at every surface: the largest of those over small
/// cells of the image, over large cells, and of all light, since photons may be so few that no cell gets two.
///
/// Each path is traced once for both cases: each lane carries what polarization makes of it, so only the difference is
/// noisy. The two copies of each cell are independent, so the mean of their product is free of that noise, unlike a
/// square. One standard error is added for what the copies missed.
pub fn polarization_error(world: &World) -> f64 {
    let world = with_fewer_photons(world).with_polarization(Polarizing::Compared);
    let mut grids = CELLS_PER_SIDE.map(|side| Cells::new(world.scene.film.window(), side));
    let mut all = SeenLight::default();
    let mut record = |pixel, copy, found| {
        grids.iter_mut().for_each(|cells| cells.add(pixel, copy, found));
        all += found;
    };
    in_lanes_of!(&world, N, P => for_each_light::<N, P>(&world, 2, &mut record));
    let total = all.light + all.change;
    let overall_error = if total > 0.0 { all.change.abs() / total } else { 0.0 };
    grids.iter().map(Cells::error).fold(overall_error, f64::max)
}

/// Cells along each side of the image: of one sample each, and so large that thin beams send photons to both copies.
const CELLS_PER_SIDE: [u32; 2] = [SAMPLES_PER_SIDE, SAMPLES_PER_SIDE / 4];

/// The light in each cell of the image, in both copies.
struct Cells {
    window: Window,
    side: u32,
    cells: Vec<[SeenLight; 2]>,
}

impl Cells {
    fn new(window: Window, side: u32) -> Self {
        Self { window, side, cells: vec![[SeenLight::default(); 2]; (side * side) as usize] }
    }

    fn add(&mut self, pixel: [u32; 2], copy: usize, found: SeenLight) {
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
        // An image with fewer pixels than cells leaves some cells empty.
        let count = f64::from(self.window.width.min(self.side) * self.window.height.min(self.side));
        let standard_error = f64::sqrt((spread - errors * errors / count).max(0.0));
        if squares > 0.0 { f64::sqrt((f64::max(errors, 0.0) + standard_error) / squares) } else { 0.0 }
    }
}
