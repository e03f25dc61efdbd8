//! Where the sky is seen from inside: through windows, doors and gaps, as directions that are learned for each place.

use std::f64::consts::{PI, TAU};

use super::World;
use crate::light::{Environment, Light, LightId};
use crate::math::{Bounds, DVec3, Ray, unit};
use crate::shape::Sighting;
use crate::spectrum::Table;

/// Cells of all directions: rows of equal height along +y, which are of equal solid angle.
pub(super) const ROWS: usize = 32;
/// Cells around each row.
pub(super) const COLUMNS: usize = 64;
pub(super) const DIRECTIONS: usize = ROWS * COLUMNS;
/// How often the sky is aimed at by what was learned; else as without, so that what was not found is at most four times as
/// bright.
const LEARNED: f64 = 0.75;

/// What is known of the sky, place by place: a grid of cells.
///
/// Vorba et al. 2014, *On-line Learning of Parametric Mixture Models for Light Transport Simulation*, and Müller et al. 2017,
/// *Practical Path Guiding for Efficient Light-Transport Simulation*, learn directions place by place for all light.
#[derive(Clone, Debug)]
pub(super) struct Openings {
    pub(super) grid: Grid,
    /// Number among `views` plus one of each cell; 0 where nothing is known.
    pub(super) cells: Vec<u32>,
    pub(super) views: Vec<SkyView>,
}

/// Cubes that fill a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: DVec3,
    /// Length of a cube's edge.
    edge: f64,
    pub(super) counts: [usize; 3],
}

/// The sky as it is seen from around one place.
#[derive(Clone, Debug)]
pub(super) struct SkyView {
    /// Probabilities of the cells of directions, summed up; empty where aiming by them would not pay.
    sums: Vec<f32>,
    /// How often each sky is chosen, of those that are, in the order of the world's choice.
    pub(super) skies: Vec<f64>,
}

impl Openings {
    /// What is known around a point.
    pub(super) fn at(&self, point: DVec3) -> Option<&SkyView> {
        let number = self.cells[self.grid.cell(point)?];
        self.views.get((number as usize).wrapping_sub(1))
    }
}

impl Grid {
    /// A box with so many cubes along its longest side.
    pub(super) fn new(bounds: &Bounds, along: usize) -> Self {
        let size = bounds.max - bounds.min;
        let edge = size.max_element() / along as f64;
        let counts = [0, 1, 2].map(|axis| ((size[axis] / edge).floor() as usize + 1).min(along));
        Self { low: bounds.min, edge, counts }
    }

    /// The cell of a point; none outside of the box.
    pub(super) fn cell(&self, point: DVec3) -> Option<usize> {
        let mut cell = 0;
        for axis in (0..3).rev() {
            let at = (point[axis] - self.low[axis]) / self.edge;
            // Points on the far side belong to the last cube.
            let last = self.counts[axis] as f64;
            if !(0.0..=last).contains(&at) {
                return None;
            }
            cell = cell * self.counts[axis] + (at as usize).min(self.counts[axis] - 1);
        }
        Some(cell)
    }

    /// The cells that share a side with one.
    pub(super) fn neighbors(&self, cell: usize) -> impl Iterator<Item = usize> {
        let [x, y, _] = self.counts;
        let (at, strides) = ([cell % x, cell / x % y, cell / (x * y)], [1, x, x * y]);
        let counts = self.counts;
        (0..3).flat_map(move |axis| {
            let before = (at[axis] > 0).then(|| cell - strides[axis]);
            let after = (at[axis] + 1 < counts[axis]).then(|| cell + strides[axis]);
            before.into_iter().chain(after)
        })
    }
}

impl SkyView {
    /// Of the light that comes from each cell of directions, up to a factor; `aimed` says whether it is worth aiming by.
    pub(super) fn new(light: &[f64], aimed: bool, skies: Vec<f64>) -> Self {
        let total: f64 = light.iter().sum();
        let mut sums = Vec::new();
        if aimed && total > 0.0 {
            let mut sum = 0.0;
            sums.extend(light.iter().map(|light| {
                sum += light;
                (sum / total) as f32
            }));
            let last = light.iter().rposition(|&light| light > 0.0).unwrap_or(0);
            sums[last..].fill(1.0);
        }
        Self { sums, skies }
    }

    /// Whether the sky is aimed at by what was learned.
    pub(super) fn is_aimed(&self) -> bool {
        !self.sums.is_empty()
    }

    fn probability(&self, cell: usize) -> f64 {
        f64::from(self.sums[cell]) - if cell == 0 { 0.0 } else { f64::from(self.sums[cell - 1]) }
    }

    /// A direction for two random numbers.
    fn draw(&self, u: [f64; 2]) -> DVec3 {
        let cell = self.sums.partition_point(|&sum| f64::from(sum) <= u[0]).min(DIRECTIONS - 1);
        let before = if cell == 0 { 0.0 } else { f64::from(self.sums[cell - 1]) };
        direction(cell, [((u[0] - before) / self.probability(cell)).clamp(0.0, 1.0), u[1]])
    }

    /// A direction to the sky from a surface of a normal: as it is aimed at by itself, or by what was learned.
    pub(super) fn aim(&self, sky: &Environment<Table>, normal: DVec3, u: [f64; 2]) -> Sighting {
        if u[0] >= LEARNED {
            return sky.aim(normal, [(u[0] - LEARNED) / (1.0 - LEARNED), u[1]]);
        }
        Sighting { direction: self.draw([u[0] / LEARNED, u[1]]), part: None, density: None }
    }

    /// The density of a ray's direction, which `aim` draws.
    pub(super) fn pdf(&self, sky: &Environment<Table>, ray: &Ray, normal: DVec3) -> f64 {
        let learned = self.probability(cell_of(ray.direction)) * DIRECTIONS as f64 / (4.0 * PI);
        LEARNED * learned + (1.0 - LEARNED) * sky.pdf(ray, normal)
    }
}

/// A unit vector in a cell of directions, at a place of the unit square.
pub(super) fn direction(cell: usize, [u, v]: [f64; 2]) -> DVec3 {
    let y = 1.0 - 2.0 * ((cell / COLUMNS) as f64 + v) / ROWS as f64;
    let radius = (1.0 - y * y).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(TAU * ((cell % COLUMNS) as f64 + u) / COLUMNS as f64);
    unit(DVec3::new(radius * cos, y, radius * sin))
}

/// The cell of a unit vector.
fn cell_of(direction: DVec3) -> usize {
    let row = (0.5 * (1.0 - direction.y) * ROWS as f64).clamp(0.0, (ROWS - 1) as f64) as usize;
    let turn = libm::atan2(direction.z, direction.x) / TAU;
    let turn = if turn < 0.0 { turn + 1.0 } else { turn };
    row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

impl World {
    /// What is known of the sky around a point.
    #[inline]
    pub(super) fn sky_view(&self, point: DVec3) -> Option<&SkyView> {
        self.openings.as_ref()?.at(point)
    }

    /// What a sky is aimed at by from a point, if it was learned there.
    pub(super) fn aimed_view(&self, light: LightId, point: DVec3) -> Option<(&SkyView, &Environment<Table>)> {
        let Light::Environment(sky) = &self.scene.lights[light] else { return None };
        self.sky_view(point).filter(|view| view.is_aimed()).map(|view| (view, sky))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_drawn_as_often_as_their_density_says() {
        let light: Vec<f64> = (0..DIRECTIONS).map(|cell| if cell % 5 == 0 { (cell % 7) as f64 } else { 0.0 }).collect();
        let view = SkyView::new(&light, true, Vec::new());
        let total: f64 = (0..DIRECTIONS).map(|cell| view.probability(cell)).sum();
        assert!((total - 1.0).abs() < 1e-6, "{total}");
        let mut counts = vec![0_u32; DIRECTIONS];
        let draws = 1_000_000;
        for i in 0..draws {
            let u = [(f64::from(i) + 0.5) / f64::from(draws), (f64::from(i) * 0.618_034).fract()];
            counts[cell_of(view.draw(u))] += 1;
        }
        for (cell, &count) in counts.iter().enumerate() {
            let expected = light[cell] / light.iter().sum::<f64>() * f64::from(draws);
            assert!((f64::from(count) - expected).abs() < 3.0 + 0.01 * expected, "{cell}: {count} for {expected}");
        }
    }

    #[test]
    fn every_cell_of_directions_holds_those_made_in_it() {
        for cell in 0..DIRECTIONS {
            for u in [[0.001, 0.001], [0.5, 0.5], [0.999, 0.999], [0.001, 0.999]] {
                assert_eq!(cell_of(direction(cell, u)), cell, "{u:?}");
            }
        }
    }

    #[test]
    fn points_of_a_box_lie_in_its_grid_and_others_do_not() {
        let bounds = Bounds { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 1.0, 4.0) };
        let grid = Grid::new(&bounds, 8);
        assert!(grid.cell(bounds.min).is_some() && grid.cell(bounds.max).is_some());
        assert_eq!(grid.cell(bounds.max + DVec3::new(1.0, 0.0, 0.0)), None);
        assert_eq!(grid.cell(bounds.min - DVec3::new(0.0, 0.1, 0.0)), None);
        assert_eq!(grid.cell(DVec3::splat(f64::NAN)), None);
        let cells: usize = grid.counts.iter().product();
        for cell in 0..cells {
            for neighbor in grid.neighbors(cell) {
                assert!(neighbor < cells && grid.neighbors(neighbor).any(|back| back == cell));
            }
        }
    }
}
