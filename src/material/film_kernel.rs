//! The energy that single scattering by facets loses, for each of the hat functions that represent a film.

use std::array;

use super::albedo_table::{AlbedoTable, step_at};
use super::film_averages::{HATS, HatWeights, nearby_hats};

/// For each hat, two shares of the light that arrives from a cosine and meets facets at the cosine of the hat,
/// tabulated over the former.
#[derive(Clone, Debug)]
pub(super) struct FilmKernel {
    /// Locates a cosine among the rows.
    grid: AlbedoTable,
    rows: Vec<HatWeights>,
    /// Cosine-weighted means of the rows over the hemisphere.
    pub(super) mean: HatWeights,
}

impl FilmKernel {
    /// Makes the kernel of facets of width `alpha` to a relative index, in a number of steps. For a cosine, `facets`
    /// adds each facet that is seen from there: the cosine at which it is met, its weight, and the two shares.
    pub(super) fn new(
        alpha: f64,
        ratio: f64,
        steps: usize,
        facets: impl Fn(f64, &mut dyn FnMut(f64, f64, [f64; 2])),
    ) -> Self {
        let grid = AlbedoTable::new(alpha, steps, |_| 0.0);
        let row = |step: usize| {
            let mut row = [[0.0; 2]; HATS];
            facets(grid.cosine(step as f64 / steps as f64), &mut |cos, weight, shares| {
                for (number, part) in nearby_hats(cos, ratio) {
                    (0..2).for_each(|way| row[number][way] += weight * part * shares[way]);
                }
            });
            row
        };
        let rows: Vec<_> = (0..=steps).map(row).collect();
        let mean = |number: usize, way: usize| {
            let mut values = rows.iter().map(|row| row[number][way]);
            AlbedoTable::new(alpha, steps, |_| values.next().unwrap_or_default()).mean
        };
        let mean = array::from_fn(|number| array::from_fn(|way| mean(number, way)));
        Self { grid, rows, mean }
    }

    /// Returns the missing energy from a cosine, linear between the rows.
    pub(super) fn at(&self, cos: f64) -> HatWeights {
        let (below, part) = step_at(self.grid.place(cos), self.rows.len() - 1);
        let [low, high] = [&self.rows[below], &self.rows[below + 1]];
        array::from_fn(|hat| array::from_fn(|way| low[hat][way] + part * (high[hat][way] - low[hat][way])))
    }
}
