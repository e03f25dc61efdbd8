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
const PARTS: f64 = 8.0;
/// Maximum number of parts of a table, 64 fringes: 1.4 MB.
const MOST_PARTS: usize = 512;
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
    /// Makes the table of a layer up to the thickness `thickest` in nm, for light of wavelength `nm`.
    pub(super) fn new(layer: &Layer, nm: f64, thickest: f64) -> Self {
        let width = 0.5 * nm / (PARTS * layer.index.norm_squared().sqrt());
        let parts = ((thickest / width) as usize + 1).min(MOST_PARTS);
        Self { width, parts: (0..parts).map(|_| OnceLock::new()).collect() }
    }

    /// Returns the averages at a thickness in nm, where `make` computes those at any thickness. Returns None beyond the
    /// table and where it would not be precise.
    pub(super) fn read(&self, thickness: f64, make: impl Fn(f64) -> FilmAverages) -> Option<FilmAverages> {
        let place = thickness / self.width;
        let number = place as usize;
        let part = self.parts.get(number)?.get_or_init(|| self.part(number, &make)).as_ref()?;
        Some(at(part, 2.0 * (place - number as f64) - 1.0))
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
        [-1.0, 1.0].into_iter().all(|x| at(&part, x).differs_by(&film(x)) <= TOLERANCE).then_some(part)
    }
}

/// Returns the sum of the polynomials at a place from -1 to 1.
fn at(part: &Polynomials, x: f64) -> FilmAverages {
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
        (layer, FilmAverages::new(stack.is_slow(), [1.0, n2], n2, shares, bare))
    }

    #[test]
    fn films_read_are_those_made() {
        for (of, n2) in
            [([1.38, 0.0], 1.5), ([2.4, 0.0], 1.5), ([2.4, 0.05], 1.5), ([0.3, 2.9], 1.5), ([1.33, 0.0], 1.7)]
        {
            let (layer, _) = film(of, n2, 0.0);
            let table = FilmTable::new(&layer, 550.0, 900.0);
            let made = |thickness: f64| film(of, n2, thickness).1;
            let mut worst = 0.0_f64;
            for step in 0..=900 {
                let thickness = f64::from(step) * 0.999;
                let read = table.read(thickness, made).unwrap_or_else(|| panic!("{of:?} at {thickness} nm"));
                worst = worst.max(read.differs_by(&made(thickness)));
            }
            assert!(worst < 2.0 * TOLERANCE, "{of:?}: {worst}");
        }
    }

    /// The layer between the two halves of a mirror passes narrow lines.
    #[test]
    fn what_eight_terms_do_not_follow_is_left_out() {
        let (layer, _) = film([1.5, 0.0], 1.5, 0.0);
        let table = FilmTable::new(&layer, 550.0, 900.0);
        let line = |thickness: f64| FilmAverages::of_mean([1.0 / (1.0 + (thickness - 300.0).powi(2)), 0.0]);
        assert!(table.read(300.0, line).is_none());
        assert!(table.read(1e6, line).is_none());
    }
}
