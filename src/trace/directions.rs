//! All directions in cells of equal solid angle, drawn by what comes from each.

use std::f64::consts::{PI, TAU};

use crate::math::{DVec3, unit};

/// Cells of all directions: rows of equal height along +y, which are of equal solid angle.
const ROWS: usize = 32;
/// Cells around each row.
const COLUMNS: usize = 64;
pub(super) const DIRECTIONS: usize = ROWS * COLUMNS;
/// How much of what is seen in a direction, or from a cell, is expected beside it.
pub(super) const BESIDE: f64 = 0.25;

/// A density of directions, constant in each cell of them.
#[derive(Clone, Debug)]
pub(super) struct Directions {
    /// Probabilities of the cells, summed up.
    sums: Vec<f32>,
}

impl Directions {
    /// By the light that comes from each cell; none if there is none.
    pub(super) fn new(light: &[f64]) -> Option<Self> {
        let (total, mut sum) = (light.iter().sum::<f64>(), 0.0);
        let last = light.iter().rposition(|&light| light > 0.0)?;
        let mut sums: Vec<f32> = light
            .iter()
            .map(|light| {
                sum += light;
                (sum / total) as f32
            })
            .collect();
        sums[last..].fill(1.0);
        Some(Self { sums })
    }

    fn probability(&self, cell: usize) -> f64 {
        f64::from(self.sums[cell]) - if cell == 0 { 0.0 } else { f64::from(self.sums[cell - 1]) }
    }

    /// A direction for two random numbers.
    pub(super) fn draw(&self, u: [f64; 2]) -> DVec3 {
        let cell = self.sums.partition_point(|&sum| f64::from(sum) <= u[0]).min(DIRECTIONS - 1);
        let before = if cell == 0 { 0.0 } else { f64::from(self.sums[cell - 1]) };
        direction(cell, [((u[0] - before) / self.probability(cell)).clamp(0.0, 1.0), u[1]])
    }

    /// The density of a unit vector, per steradian.
    pub(super) fn density(&self, direction: DVec3) -> f64 {
        self.probability(cell_of(direction)) * DIRECTIONS as f64 / (4.0 * PI)
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

/// What is expected in each cell of directions, of what was found there and beside it.
pub(super) fn spread(light: &[f64]) -> Vec<f64> {
    let most = |cell: usize| around(cell).map(|near| light[near]).fold(0.0, f64::max);
    (0..DIRECTIONS).map(|cell| light[cell] + BESIDE * most(cell)).collect()
}

/// Those beside each cell, and the cell itself.
fn around(cell: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (cell / COLUMNS, cell % COLUMNS);
    let rows = row.saturating_sub(1)..=(row + 1).min(ROWS - 1);
    rows.flat_map(move |row| [COLUMNS - 1, 0, 1].map(|turn| row * COLUMNS + (column + turn) % COLUMNS))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_drawn_as_often_as_their_density_says() {
        let light: Vec<f64> = (0..DIRECTIONS).map(|cell| if cell % 5 == 0 { (cell % 7) as f64 } else { 0.0 }).collect();
        let view = Directions::new(&light).expect("some light");
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
}
