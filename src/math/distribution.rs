//! Sampling from tables: one of many entries, or one cell of a grid.

use serde::{Deserialize, Serialize};

/// An entry drawn from a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DiscreteSample {
    /// Index of the entry.
    pub index: usize,
    /// Probability of drawing the entry, above 0 and at most 1.
    pub probability: f64,
    /// The rest of the random number, rescaled so that it is again uniform in [0, 1).
    pub u: f64,
}

/// The largest number below 1.
pub const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A discrete distribution over the entries 0, 1, 2, ..
///
/// It is sampled by inverting the cumulative probabilities.
/// Pharr, Jakob & Humphreys 2023, *Physically Based Rendering*, 4th ed., appendix A.4.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    /// Sum of the probabilities of each entry and of all entries before it. The last sum is 1.
    cumulative: Vec<f64>,
    total: f64,
}

impl Distribution {
    /// Creates a distribution over one or more entries. Their probabilities are proportional to weights of 0 or more,
    /// and equal if every weight is 0.
    ///
    /// # Panics
    /// If there is no entry.
    pub fn new(weights: impl IntoIterator<Item = f64>) -> Self {
        let mut total = 0.0;
        let add_to_total = |weight: f64| {
            total += weight;
            total
        };
        let mut cumulative: Vec<f64> = weights.into_iter().map(add_to_total).collect();
        let count = cumulative.len();
        if total > 0.0 {
            cumulative.iter_mut().for_each(|sum| *sum /= total);
        } else {
            cumulative = (1..=count).map(|entries| entries as f64 / count as f64).collect();
        }
        cumulative[count - 1] = 1.0;
        Self { cumulative, total }
    }

    /// Returns the sum of the weights.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Returns the number of entries.
    pub fn count(&self) -> usize {
        self.cumulative.len()
    }

    /// Draws an entry with a random number in [0, 1).
    pub fn sample(&self, u: f64) -> DiscreteSample {
        let index = self.cumulative.partition_point(|&sum| sum <= u).min(self.count() - 1);
        let (before, probability) = (self.cumulative_before(index), self.probability(index));
        DiscreteSample { index, probability, u: ((u - before) / probability).clamp(0.0, BELOW_ONE) }
    }

    /// Returns the probability with which `sample` draws an entry.
    pub fn probability(&self, index: usize) -> f64 {
        self.cumulative[index] - self.cumulative_before(index)
    }

    /// Returns the probability of all entries before one.
    fn cumulative_before(&self, index: usize) -> f64 {
        if index == 0 { 0.0 } else { self.cumulative[index - 1] }
    }
}

/// A discrete distribution over the cells of a grid. A row is drawn first, then one of its columns.
///
/// Pharr, Jakob & Humphreys 2023, *Physically Based Rendering*, 4th ed., appendix A.5.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution2d {
    rows: Distribution,
    columns: Vec<Distribution>,
}

impl Distribution2d {
    /// Creates a distribution over a grid of `width` columns and `height` rows, at least one of each. The probability
    /// of a cell is proportional to its weight, given by its column and row, times the weight of its row.
    pub fn new([width, height]: [usize; 2], cell: impl Fn([usize; 2]) -> f64, row: impl Fn(usize) -> f64) -> Self {
        let cell = &cell;
        let columns: Vec<Distribution> =
            (0..height).map(|y| Distribution::new((0..width).map(move |x| cell([x, y])))).collect();
        let rows = Distribution::new(columns.iter().enumerate().map(|(y, of_row)| of_row.total() * row(y)));
        Self { rows, columns }
    }

    /// Returns the numbers of columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.columns[0].count(), self.columns.len()]
    }

    /// Draws a column and a row with two random numbers in [0, 1).
    pub fn sample(&self, [u, v]: [f64; 2]) -> [DiscreteSample; 2] {
        let row = self.rows.sample(v);
        [self.columns[row.index].sample(u), row]
    }

    /// Returns the sum of the weights of all cells, each times that of its row.
    pub fn total(&self) -> f64 {
        self.rows.total()
    }

    /// Returns the probability with which `sample` draws the cell at a column and a row.
    pub fn probability(&self, [column, row]: [usize; 2]) -> f64 {
        self.rows.probability(row) * self.columns[row].probability(column)
    }

    /// Samples a point of the unit square with two random numbers. The cells divide the square into equal parts, and
    /// the density is constant within each cell.
    pub fn sample_point(&self, u: [f64; 2]) -> [f64; 2] {
        let (size, drawn) = (self.size(), self.sample(u));
        [0, 1].map(|i| ((drawn[i].index as f64 + drawn[i].u) / size[i] as f64).min(BELOW_ONE))
    }

    /// Returns the density per unit area with which `sample_point` draws a point.
    pub fn density(&self, place: [f64; 2]) -> f64 {
        let size = self.size();
        let cell = [0, 1].map(|i| ((place[i] * size[i] as f64) as usize).min(size[i] - 1));
        self.probability(cell) * (size[0] * size[1]) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_are_drawn_as_often_as_their_weights_say_and_those_of_weight_0_never() {
        let weights = [0.0, 3.0, 0.0, 1.0, 4.0, 0.0];
        let distribution = Distribution::new(weights);
        let mut counts = [0; 6];
        for i in 0..8000 {
            let u = f64::from(i) / 8000.0;
            let drawn = distribution.sample(u);
            counts[drawn.index] += 1;
            assert_eq!(drawn.probability, weights[drawn.index] / 8.0);
            let before: f64 = weights[..drawn.index].iter().sum::<f64>() / 8.0;
            assert!((before + drawn.u * drawn.probability - u).abs() < 1e-15 && drawn.u < 1.0, "{u}: {drawn:?}");
        }
        assert_eq!((counts, distribution.total()), ([0, 3000, 0, 1000, 4000, 0], 8.0));
        assert_eq!(distribution.sample(BELOW_ONE).index, 4);
    }

    #[test]
    fn entries_without_weights_are_all_alike() {
        let distribution = Distribution::new([0.0; 4]);
        assert_eq!([0.0, 0.3, 0.6, BELOW_ONE].map(|u| distribution.sample(u).index), [0, 1, 2, 3]);
        assert_eq!([0, 1, 2, 3].map(|index| distribution.probability(index)), [0.25; 4]);
    }

    #[test]
    fn cells_are_drawn_by_their_own_weight_times_that_of_their_row() {
        let (cell, row) = (|[x, y]: [usize; 2]| [[1.0, 0.0, 3.0], [2.0, 2.0, 0.0]][y][x], |y: usize| [2.0, 4.0][y]);
        let distribution = Distribution2d::new([3, 2], cell, row);
        assert_eq!(distribution.rows.total(), 24.0);
        let mut counts = [[0; 3]; 2];
        for u in (0..240).flat_map(|i| (0..240).map(move |j| [i, j].map(|k| f64::from(k) / 240.0))) {
            let [column, row] = distribution.sample(u).map(|drawn| drawn.index);
            counts[row][column] += 1;
        }
        for (y, x) in (0..2).flat_map(|y| (0..3).map(move |x| (y, x))) {
            let expected = cell([x, y]) * row(y) / 24.0;
            assert!((distribution.probability([x, y]) - expected).abs() < 1e-15);
            assert!(
                (f64::from(counts[y][x]) / 57_600.0 - expected).abs() < 0.01,
                "{x}, {y}: {} for {expected}",
                counts[y][x]
            );
        }
    }
}
