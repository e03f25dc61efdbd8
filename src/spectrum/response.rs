use std::sync::Arc;

use super::color::weighted_sum;
use super::draw::Hero;
use super::table::MAX_LANES;
use super::{Draw, Lanes};

/// What each lane of one light is worth to the sensor: a matrix, 3 film channels x lanes.
///
/// It belongs to the light in which a path ends, so that a spiky illuminant is integrated exactly in any lanes.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// The film channels of every fixed lane, 0 beyond the last. A fourth number makes two pairs, each as wide as what
    /// a processor adds at once.
    pub(super) columns: Arc<[[f64; 4]; MAX_LANES]>,
    /// The film color of the light per nm on the fine grid, and of its ideal lines.
    pub(super) fine: Arc<[[f64; 3]]>,
}

impl Response {
    /// Creates a response from the film color of each fixed lane, and of each entry of the fine grid.
    pub fn new(columns: &[[f64; 3]], fine: Vec<[f64; 3]>) -> Self {
        let column = |lane: usize| columns.get(lane).map_or([0.0; 4], |&[r, g, b]| [r, g, b, 0.0]);
        Self { columns: Arc::new(std::array::from_fn(column)), fine: fine.into() }
    }

    /// Returns the film's red, green and blue for light that arrives in `lanes`, which may have `parted` on the way.
    pub fn film_rgb<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>, parted: bool) -> [f64; 3] {
        if let Some(heroes) = draw.carrying_heroes(&lanes, parted) {
            let weighted = heroes.filter(|(.., weight)| *weight != 0.0);
            return weighted_sum(weighted.map(|(_, hero, weight)| (weight, self.hero(hero))));
        }
        // Four separate sums, so that the processor does not wait for each addition.
        let columns: &[[f64; 4]; N] = self.columns.first_chunk().expect("no more lanes are compiled than fit");
        let mut sums = [[0.0; 4]; 4];
        for (four, columns) in lanes.0.as_chunks::<4>().0.iter().zip(columns.as_chunks::<4>().0) {
            for i in 0..4 {
                (0..4).for_each(|channel| sums[i][channel] += columns[i][channel] * f64::from(four[i]));
            }
        }
        std::array::from_fn(|channel| (sums[0][channel] + sums[1][channel]) + (sums[2][channel] + sums[3][channel]))
    }

    /// Returns the film's red, green and blue for the light per nm at a hero's wavelength, or for its line.
    pub(super) fn hero(&self, hero: &Hero) -> [f64; 3] {
        let (a, b) = (self.fine[hero.below], self.fine[hero.below + 1]);
        std::array::from_fn(|c| a[c] + hero.fraction * (b[c] - a[c]))
    }
}
