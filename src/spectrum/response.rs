use std::sync::Arc;

use super::draw::Hero;
use super::table::MAX_LANES;
use super::{Draw, Lanes};

/// What each lane of one light is worth to the sensor: a matrix, 3 film channels x lanes.
///
/// It belongs to the light a path ends in, so that a spiky illuminant can be integrated exactly whatever the lanes are.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Each film channel of every fixed lane, 0 beyond the last.
    pub(super) rows: Arc<[[f64; MAX_LANES]; 3]>,
    /// The film color of the light per nm on the fine grid, and of its ideal lines.
    pub(super) fine: Arc<[[f64; 3]]>,
}

impl Response {
    /// The response in which lane i is film channel i.
    pub fn identity() -> Self {
        Self::new(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], Vec::new())
    }

    /// A response with the film color of each fixed lane, and of each entry of the fine grid.
    pub fn new(columns: &[[f64; 3]], fine: Vec<[f64; 3]>) -> Self {
        let entry = |channel: usize, lane: usize| columns.get(lane).map_or(0.0, |column| column[channel]);
        let rows = std::array::from_fn(|channel| std::array::from_fn(|lane| entry(channel, lane)));
        Self { rows: Arc::new(rows), fine: fine.into() }
    }

    /// The film's red, green and blue of light that arrives in lanes; `parted` says whether they parted on the way.
    pub fn sensor<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>, parted: bool) -> [f64; 3] {
        if let Some(factor) = draw.hero_factor(parted) {
            return self.heroes(draw, lanes, factor);
        }
        // Four sums side by side, so that the processor need not wait for each addition.
        std::array::from_fn(|channel| {
            let row: &[f64; N] = self.rows[channel].first_chunk().expect("no more lanes are compiled than fit");
            let mut sums = [0.0; 4];
            for (four, weights) in lanes.0.chunks_exact(4).zip(row.chunks_exact(4)) {
                (0..4).for_each(|i| sums[i] += weights[i] * f64::from(four[i]));
            }
            (sums[0] + sums[1]) + (sums[2] + sums[3])
        })
    }

    fn heroes<const N: usize>(&self, draw: &Draw<N>, lanes: Lanes<N>, factor: f64) -> [f64; 3] {
        let mut sensor = [0.0; 3];
        for (hero, lane) in draw.heroes().zip(draw.fixed_lanes()..) {
            let weight = factor * hero.factor * f64::from(lanes[lane]);
            if weight != 0.0 {
                let color = self.hero(hero);
                (0..3).for_each(|c| sensor[c] += weight * color[c]);
            }
        }
        sensor
    }

    /// The film's red, green and blue of the light per nm at a hero's wavelength, or of its line.
    pub(super) fn hero(&self, hero: &Hero) -> [f64; 3] {
        let (a, b) = (self.fine[hero.below], self.fine[hero.below + 1]);
        std::array::from_fn(|c| a[c] + hero.fraction * (b[c] - a[c]))
    }
}
