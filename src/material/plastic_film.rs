use super::coat::{Coat, Crossing};
use super::coating::MetCoating;
use super::film_averages::{FilmAverages, mean};
use super::{Interface, Stack, StackShares};

/// The film on the coat of an opaque body, for one lane.
pub(super) struct PlasticFilm {
    stack: Stack,
    /// On the viewer's side, and of the coat.
    indices: [f64; 2],
    pub(super) averages: FilmAverages,
}

impl PlasticFilm {
    pub(super) fn new<const N: usize>(met: &MetCoating<N>, lane: usize, indices: [f64; 2]) -> Self {
        let stack = met.stack(lane);
        let averages = met.averages(lane, false, [indices[0], indices[1], 0.0, 0.0], || averages(&stack, indices));
        Self { stack, indices, averages }
    }

    /// What it reflects and lets through of the light from a cosine.
    pub(super) fn shares(&self, cos: f64) -> StackShares {
        let [n1, n2] = self.indices;
        self.stack.shares(n1, n2.into(), n1 * cos.clamp(0.0, 1.0))
    }

    /// What crosses it and the coat.
    pub(super) fn crossing(&self, coat: &Coat, cosines: [f64; 2]) -> Crossing {
        coat.crossing_under(&self.averages, self.indices, cosines, |cos| self.shares(cos).refracted.mean())
    }
}

fn averages(stack: &Stack, [n1, n2]: [f64; 2]) -> FilmAverages {
    let film = |cos: f64| stack.shares(n1, n2.into(), n1 * cos).means();
    let bare = |cos: f64| {
        let crosses = Interface::new(n1, n2, cos).transmittance;
        [1.0 - crosses, crosses]
    };
    // In a denser medium layers may reflect totally, from other angles on than the coat.
    let averages = FilmAverages::new(stack.is_slow() && n1 <= n2, [n1, n2], n1.max(n2), film, bare);
    if stack.layers().iter().all(|layer| layer.index.im == 0.0) {
        return averages;
    }
    let inside = stack.turned_around();
    let lost = |cos: f64| {
        let [reflected, crossing] = inside.shares(n2, n1.into(), n2 * cos).means();
        [1.0 - reflected - crossing, 0.0]
    };
    FilmAverages { lost_inside: mean(stack.is_slow(), n1 / n2, lost)[0].max(0.0), ..averages }
}
