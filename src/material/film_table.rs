//! Averages of a film over directions, as functions of the thickness of one of its layers.

use std::array;
use std::f64::consts::PI;
use std::sync::OnceLock;

use super::film_averages::FilmAverages;
use super::stack::Layer;

/// Number of Chebyshev polynomials in a part of the table.
const TERMS: usize = 8;
/// Number of parts per fringe. For layers on glass every part is precise enough, for the oxides of metals more than
/// half.
const PARTS_PER_FRINGE: f64 = 8.0;
/// Maximum number of parts of a table, 64 fringes: 1.4 MB.
const MAX_PARTS: usize = 512;
/// Maximum difference between the table and the film at the two ends of a part, where polynomials are worst. Parts that
/// differ by more are left out.
const TOLERANCE: f64 = 1e-5;

/// A film's averages as polynomials in the thickness of one layer, computed part by part when first needed.
///
/// The polynomials interpolate at Chebyshev's points (Trefethen 2013, *Approximation Theory and Approximation
/// Practice*, chapters 2 to 4). The reflected and transmitted shares of a clear film still add up to 1.
#[derive(Clone, Debug)]
pub(super) struct FilmTable {
    /// Width of a part in nm.
    width: f64,
    parts: Box<[OnceLock<Option<Polynomials>>]>,
}

type Polynomials = Box<[FilmAverages; TERMS]>;

impl FilmTable {
    /// Makes the table of a layer up to the thickness `max_thickness` in nm, for light of wavelength `nm`.
    pub(super) fn new(layer: &Layer, nm: f64, max_thickness: f64) -> Self {
        let width = 0.5 * nm / (PARTS_PER_FRINGE * layer.index.norm_squared().sqrt());
        let parts = ((max_thickness / width) as usize + 1).min(MAX_PARTS);
        Self { width, parts: (0..parts).map(|_| OnceLock::new()).collect() }
    }

    /// Returns the averages at a thickness in nm, where `make` computes those at any thickness. Returns None beyond the
    /// table and where it would not be precise.
    pub(super) fn read(&self, thickness: f64, make: impl Fn(f64) -> FilmAverages) -> Option<FilmAverages> {
        let place = thickness / self.width;
        let number = place as usize;
        let part = self.parts.get(number)?.get_or_init(|| self.part(number, &make)).as_ref()?;
        Some(evaluate(part, 2.0 * (place - number as f64) - 1.0))
    }

    fn part(&self, number: usize, make: impl Fn(f64) -> FilmAverages) -> Option<Polynomials> {
        let film = |x: f64| make((number as f64 + 0.5 * (x + 1.0)) * self.width);
        let angle = |place: usize| (place as f64 + 0.5) * PI / TERMS as f64;
        let films: [_; TERMS] = array::from_fn(|place| film(libm::cos(angle(place))));
        let term = |degree: usize| {
            let scale = if degree == 0 { 1.0 } else { 2.0 } / TERMS as f64;
            FilmAverages::sum(&films, &array::from_fn(|place| scale * libm::cos(degree as f64 * angle(place))))
        };
        let part = Box::new(array::from_fn(term));
        [-1.0, 1.0].into_iter().all(|x| evaluate(&part, x).max_difference(&film(x)) <= TOLERANCE).then_some(part)
    }
}

/// Returns the sum of the polynomials at a place from -1 to 1.
fn evaluate(part: &Polynomials, x: f64) -> FilmAverages {
    let mut terms = [1.0; TERMS];
    terms[1] = x;
    (2..TERMS).for_each(|degree| terms[degree] = 2.0 * x * terms[degree - 1] - terms[degree - 2]);
    FilmAverages::sum(part, &terms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::{Interface, Stack};
    use crate::math::Complex;

    /// Makes a layer of index `n` and extinction `k` on an index `n2`, in air, at 550 nm.
    fn film([n, k]: [f64; 2], n2: f64, thickness_nm: f64) -> (Layer, FilmAverages) {
        let layer = Layer { index: Complex::new(n, -k), thickness_nm };
        let stack = Stack::new([550.0, 0.0], std::iter::once(layer));
        let shares = |cos: f64| stack.shares(1.0, n2.into(), cos).means();
        let bare = |cos: f64| {
            let crosses = Interface::new(1.0, n2, cos).transmittance;
            [1.0 - crosses, crosses]
        };
        (layer, FilmAverages::new(stack.varies_slowly(), [1.0, n2], n2, shares, bare))
    }

    #[test]
    fn films_read_from_the_table_match_computed_ones() {
        for (nk, n2) in
            [([1.38, 0.0], 1.5), ([2.4, 0.0], 1.5), ([2.4, 0.05], 1.5), ([0.3, 2.9], 1.5), ([1.33, 0.0], 1.7)]
        {
            let (layer, _) = film(nk, n2, 0.0);
            let table = FilmTable::new(&layer, 550.0, 900.0);
            let computed = |thickness: f64| film(nk, n2, thickness).1;
            let mut worst = 0.0_f64;
            for step in 0..=900 {
                let thickness = f64::from(step) * 0.999;
                let read = table.read(thickness, computed).unwrap_or_else(|| panic!("{nk:?} at {thickness} nm"));
                worst = worst.max(read.max_difference(&computed(thickness)));
            }
            assert!(worst < 2.0 * TOLERANCE, "{nk:?}: {worst}");
        }
    }

    /// The layer between the two halves of a mirror passes narrow lines.
    #[test]
    fn what_eight_terms_cannot_follow_is_left_out() {
        let (layer, _) = film([1.5, 0.0], 1.5, 0.0);
        let table = FilmTable::new(&layer, 550.0, 900.0);
        let line = |thickness: f64| FilmAverages::from_mean([1.0 / (1.0 + (thickness - 300.0).powi(2)), 0.0]);
        assert!(table.read(300.0, line).is_none());
        assert!(table.read(1e6, line).is_none());
    }
}
