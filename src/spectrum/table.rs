use std::sync::Arc;

use super::Texture;

/// Maximum number of lanes that travel together.
pub const MAX_LANES: usize = 32;

/// A spectrum in the bins of one render's basis, in the unit of its quantity: one number per fixed lane and, if the
/// basis has heroes, a fine grid for wavelengths that are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    bins: usize,
    /// The numbers of the fixed lanes. The last bin's number is repeated, so that no empty lane divides by 0.
    fixed: Arc<[f64; MAX_LANES]>,
    weights: Arc<[f32; MAX_LANES]>,
    fine: Arc<[f64]>,
    flat: bool,
    /// The smallest and the largest number of the fixed lanes.
    pub(super) fixed_range: [f64; 2],
    /// For an index, the one that refracts all lanes.
    direction: Option<f64>,
    /// A factor that varies over the surface.
    pattern: Option<Box<Pattern>>,
}

/// How a table varies over a surface: a factor on its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pattern {
    pub(super) kind: PatternKind,
    /// Upper limit of the product, against rounding: 1 for a reflectance or a transmittance.
    pub(super) limit: f32,
    /// Mean brightness of the factor over the image, where brightness is the mean of red, green and blue.
    pub(super) mean: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum PatternKind {
    /// An image with the palette of its colors, unless red, green and blue are the lanes.
    Image(Texture, Option<Vec<Table>>),
    Checker {
        cells: [Table; 2],
        repeat: [f64; 2],
    },
}

impl Table {
    /// Creates a table of the given bins, one for each fixed lane.
    ///
    /// # Panics
    /// If there are no bins, or more than [`MAX_LANES`].
    pub fn new(bins: impl AsRef<[f64]>) -> Self {
        Self::with_fine(bins.as_ref(), Vec::new())
    }

    /// Creates a table with a fine grid for drawn wavelengths.
    pub(super) fn with_fine(bins: &[f64], fine: Vec<f64>) -> Self {
        assert!((1..=MAX_LANES).contains(&bins.len()), "{} bins do not fit", bins.len());
        let fixed: [f64; MAX_LANES] = std::array::from_fn(|i| bins[i.min(bins.len() - 1)]);
        let flat = fixed.iter().chain(&fine).all(|&x| x == fixed[0]);
        let weights = fixed.map(|x| x as f32);
        Self {
            bins: bins.len(),
            fixed: Arc::new(fixed),
            weights: Arc::new(weights),
            fine: fine.into(),
            flat,
            fixed_range: [f64::min, f64::max].map(|of| bins.iter().copied().fold(bins[0], of)),
            direction: None,
            pattern: None,
        }
    }

    /// Returns the table with a pattern that varies over the surface.
    pub(super) fn with_pattern(self, pattern: Pattern) -> Self {
        Self { pattern: Some(Box::new(pattern)), ..self }
    }

    /// Returns the table of an index in which all lanes are refracted by one.
    pub(super) fn refracting_as(self, direction: f64) -> Self {
        Self { direction: Some(direction), ..self }
    }

    /// Returns the index that refracts all lanes, if their own indices differ but they stay together.
    pub fn direction(&self) -> Option<f64> {
        self.direction
    }

    pub(super) fn pattern(&self) -> Option<&Pattern> {
        self.pattern.as_deref()
    }

    /// Returns whether it varies over a surface, so that `Draw::read_at` needs the place.
    pub fn varies(&self) -> bool {
        self.pattern.is_some()
    }

    /// Returns the number in each bin of the fixed lanes.
    pub fn bins(&self) -> &[f64] {
        &self.fixed[..self.bins]
    }

    /// Returns the smallest and the largest number.
    pub fn range(&self) -> (f64, f64) {
        let all = self.bins().iter().chain(&*self.fine);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
    }

    /// Returns the largest number, times the mean of its pattern if the table varies.
    pub fn brightness(&self) -> f64 {
        let brightest = self.range().1.max(0.0);
        self.pattern().map_or(brightest, |pattern| brightest * pattern.mean)
    }

    /// Returns whether all bins hold the same number.
    pub fn is_flat(&self) -> bool {
        self.flat
    }

    /// Returns whether it is 1 in every bin and everywhere.
    pub fn is_one(&self) -> bool {
        self.flat && self.pattern.is_none() && self.fixed[0] == 1.0
    }

    /// Returns the numbers of the first N fixed lanes.
    pub(super) fn fixed<const N: usize>(&self) -> &[f64; N] {
        self.fixed.first_chunk().expect("no more lanes are compiled than fit")
    }

    /// Returns the numbers of the first N fixed lanes, as weights.
    pub(super) fn weights<const N: usize>(&self) -> &[f32; N] {
        self.weights.first_chunk().expect("no more lanes are compiled than fit")
    }

    /// Interpolates between two entries of the fine grid.
    pub(super) fn interpolate(&self, below: usize, fraction: f64) -> f64 {
        let (a, b) = (self.fine[below], self.fine[below + 1]);
        a + fraction * (b - a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{Draw, Lanes};

    #[test]
    fn lanes_beyond_the_last_bin_repeat_it() {
        let table = Table::new([1.5, 1.6]);
        assert_eq!(table.bins(), [1.5, 1.6]);
        assert_eq!(Draw::<4>::fixed(2).read(&table), Lanes([1.5, 1.6, 1.6, 1.6]));
        assert!(!table.is_flat() && Table::new([2.0, 2.0]).is_flat());
    }
}
