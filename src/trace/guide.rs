//! Which photons are worth sending.

use std::collections::HashMap;

use crate::math::Distribution2d;

/// Number of cells along each side of the square.
const CELLS_PER_SIDE: usize = 64;
/// Share of the photons that is sent everywhere, whatever was learned. It bounds the brightness of what was missed.
const UNIFORM_SHARE: f64 = 0.2;

/// A density on the unit square, constant in each of its cells.
///
/// Jensen 1995, *Importance Driven Path Tracing Using the Photon Map*, learns where to send light in the same way.
#[derive(Clone, Debug)]
pub(super) struct Guide {
    cells: Distribution2d,
}

impl Guide {
    /// Returns a density of 1 everywhere.
    pub(super) fn uniform() -> Self {
        Self::from_probabilities(|_| 1.0)
    }

    /// Learns a density from some photons: their places, and whether they were seen.
    pub(super) fn from_photons(photons: &[([f64; 2], bool)]) -> Self {
        let (mut sent, mut seen) =
            (vec![0.0; CELLS_PER_SIDE * CELLS_PER_SIDE], vec![0.0; CELLS_PER_SIDE * CELLS_PER_SIDE]);
        for &(place, was_seen) in photons {
            let cell = cell_of(place);
            sent[cell] += 1.0;
            seen[cell] += f64::from(u8::from(was_seen));
        }
        let share: Vec<f64> = sent.iter().zip(&seen).map(|(sent, seen)| seen / f64::max(*sent, 1.0)).collect();
        // A region that begins in one cell may reach into the next.
        let max_nearby = |cell: usize| {
            let (row, column) = (cell / CELLS_PER_SIDE, cell % CELLS_PER_SIDE);
            let near = |x: usize| x.saturating_sub(1)..=(x + 1).min(CELLS_PER_SIDE - 1);
            near(row)
                .flat_map(|i| near(column).map(move |j| i * CELLS_PER_SIDE + j))
                .map(|i| share[i])
                .fold(0.0, f64::max)
        };
        Self::from_cells(
            &(0..CELLS_PER_SIDE * CELLS_PER_SIDE).map(|cell| share[cell] + 0.25 * max_nearby(cell)).collect::<Vec<_>>(),
        )
    }

    /// Returns a density that follows weights of cells, given by number. Weights of single cells count as much as those
    /// of blocks of 2 x 2, 4 x 4 and 8 x 8 cells, because few of many places are known.
    pub(super) fn from_weights(weights: &[(u32, f32)]) -> Self {
        let mut cell_weights = vec![0.0; CELLS_PER_SIDE * CELLS_PER_SIDE];
        for level in 0..=3 {
            let block = |cell: usize| [cell / CELLS_PER_SIDE, cell % CELLS_PER_SIDE].map(|at| at >> level);
            let mut blocks = HashMap::new();
            for &(cell, weight) in weights {
                *blocks.entry(block(cell as usize)).or_insert(0.0) += f64::from(weight.max(0.0));
            }
            let weight_of_cell =
                |cell: usize| blocks.get(&block(cell)).map_or(0.0, |weight| weight * 0.25_f64.powi(level));
            cell_weights.iter_mut().enumerate().for_each(|(cell, cell_weights)| *cell_weights += weight_of_cell(cell));
        }
        Self::from_cells(&cell_weights)
    }

    /// Returns a density that is mostly proportional to what is wanted of each cell.
    fn from_cells(cell_weights: &[f64]) -> Self {
        let total: f64 = cell_weights.iter().sum();
        if total == 0.0 {
            return Self::disk();
        }
        let everywhere =
            (0..CELLS_PER_SIDE * CELLS_PER_SIDE).filter(|&cell| touches_disk(cell)).count() as f64 / UNIFORM_SHARE;
        Self::from_probabilities(|cell| {
            f64::from(u8::from(touches_disk(cell))) / everywhere + (1.0 - UNIFORM_SHARE) * cell_weights[cell] / total
        })
    }

    /// Returns a constant density in all cells that the largest disk in the square reaches into, and 0 in the others.
    pub(super) fn disk() -> Self {
        Self::from_probabilities(|cell| f64::from(u8::from(touches_disk(cell))))
    }

    /// Returns a density from the probabilities of cells, up to a factor.
    fn from_probabilities(probability: impl Fn(usize) -> f64) -> Self {
        Self {
            cells: Distribution2d::new(
                [CELLS_PER_SIDE; 2],
                |[column, row]| probability(row * CELLS_PER_SIDE + column),
                |_| 1.0,
            ),
        }
    }

    /// Samples a place in the square from two random numbers.
    pub(super) fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        self.cells.sample_point(u)
    }

    /// Returns roughly the part of the square in which most places are sampled: for n equally likely cells, n cells.
    pub(super) fn extent(&self) -> f64 {
        let probability = |cell: usize| self.cells.probability([cell % CELLS_PER_SIDE, cell / CELLS_PER_SIDE]);
        1.0 / ((CELLS_PER_SIDE * CELLS_PER_SIDE) as f64
            * (0..CELLS_PER_SIDE * CELLS_PER_SIDE).map(|cell| probability(cell) * probability(cell)).sum::<f64>())
    }

    pub(super) fn density(&self, place: [f64; 2]) -> f64 {
        self.cells.density(place)
    }
}

/// Returns whether the largest disk in the square reaches into a cell.
fn touches_disk(cell: usize) -> bool {
    let nearest = |at: usize| {
        let (low, high) =
            (2.0 * at as f64 / CELLS_PER_SIDE as f64 - 1.0, 2.0 * (at + 1) as f64 / CELLS_PER_SIDE as f64 - 1.0);
        f64::clamp(0.0, low, high)
    };
    let [x, y] = [cell % CELLS_PER_SIDE, cell / CELLS_PER_SIDE].map(nearest);
    x * x + y * y < 1.0
}

pub(super) fn cell_of(place: [f64; 2]) -> usize {
    let [column, row] = place.map(|x| ((x * CELLS_PER_SIDE as f64) as usize).min(CELLS_PER_SIDE - 1));
    row * CELLS_PER_SIDE + column
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
        let at = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n).flat_map(move |i| (0..n).map(move |j| [at(i), at(j)]))
    }

    #[test]
    fn photons_go_where_they_are_seen_as_often_as_the_density_says() {
        let seen = |[x, y]: [f64; 2]| (x - 0.3).abs() < 0.02 && y > 0.4;
        let learned = Guide::from_photons(&grid(256).map(|place| (place, seen(place))).collect::<Vec<_>>());
        let weighted = Guide::from_weights(&[(2000, 1.0), (2001, 3.0), (700, 0.5)]);
        for guide in [Guide::uniform(), Guide::disk(), learned.clone(), weighted] {
            let total: f64 = grid(CELLS_PER_SIDE as u32).map(|place| guide.density(place)).sum::<f64>()
                / (CELLS_PER_SIDE * CELLS_PER_SIDE) as f64;
            assert!((total - 1.0).abs() < 1e-12, "the density sums to {total}");
            // Integrates over the disk by sampling places: pi / 4 for its area, a sixteenth of it for (x - 1 / 2)^2.
            let inside = |p: [f64; 2]| (p[0] - 0.5) * (p[0] - 0.5) + (p[1] - 0.5) * (p[1] - 0.5) < 0.25;
            let square = |p: [f64; 2]| if inside(p) { (p[0] - 0.5) * (p[0] - 0.5) } else { 0.0 };
            let draws = grid(1000).map(|u| guide.sample(u)).map(|p| square(p) / guide.density(p));
            let mean = draws.sum::<f64>() / 1e6;
            let exact = std::f64::consts::PI / 64.0;
            assert!((mean / exact - 1.0).abs() < 2e-3, "{mean} for {exact}");
        }
        assert!((Guide::uniform().extent() - 1.0).abs() < 1e-12 && learned.extent() < 0.2);
        let hits = grid(200).filter(|&u| seen(learned.sample(u))).count() as f64 / 40_000.0;
        assert!(hits > 0.5, "{hits} of the photons are seen where 0.024 of all would be");
    }
}
