//! What facets block of the light that each hat of a film's differences stands for.

use super::albedo_table::AlbedoTable;
use super::film_averages::{FilmAverages, HATS, hats};

/// For each hat, two shares of the light from a cosine that meets facets at that hat's cosine, as tables.
#[derive(Clone, Debug)]
pub(super) struct FilmKernel {
    tables: Vec<[AlbedoTable; 2]>,
}

impl FilmKernel {
    /// The kernel of facets as wide as `alpha` to a relative index, in a number of steps; `facets` adds each facet that
    /// is seen from a cosine: the cosine at which it is met, its weight, and the two shares.
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
                for (number, part) in hats(cos, ratio) {
                    (0..2).for_each(|way| row[number][way] += weight * part * shares[way]);
                }
            });
            row
        };
        let rows: Vec<_> = (0..=steps).map(row).collect();
        let table = |number: usize, way: usize| {
            let mut values = rows.iter().map(|row| row[number][way]);
            AlbedoTable::new(alpha, steps, |_| values.next().unwrap_or_default())
        };
        Self { tables: (0..HATS).map(|number| [table(number, 0), table(number, 1)]).collect() }
    }

    /// What a film adds to the first share of what is reflected and the second of what crosses, from a cosine.
    pub(super) fn added(&self, averages: &FilmAverages, cos: f64) -> f64 {
        let place = self.tables[0][0].place(cos);
        averages.weighted(|hat, way| self.tables[hat][way].at(place))
    }

    /// The mean of that over the hemisphere, by cosine.
    pub(super) fn mean_added(&self, averages: &FilmAverages) -> f64 {
        averages.weighted(|hat, way| self.tables[hat][way].mean())
    }
}
