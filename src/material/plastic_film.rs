use super::coat::{CoatMissingEnergy, CoatTransmittance};
use super::coating::{Averages, LocalCoating};
use super::film_averages::{FilmAverages, mean};
use super::{Interface, Stack, StackShares};

/// The film on the coat of an opaque body, for one lane.
pub(super) struct PlasticFilm<'a, const N: usize> {
    local: &'a LocalCoating<'a, N>,
    lane: usize,
    /// Indices on the viewer's side and of the coat.
    indices: [f64; 2],
    pub(super) averages: Averages<'a>,
}

impl<'a, const N: usize> PlasticFilm<'a, N> {
    pub(super) fn new(local: &'a LocalCoating<'a, N>, lane: usize, indices: [f64; 2], is_rough: bool) -> Self {
        let [n1, n2] = indices;
        let averages = local.averages(lane, false, [n1, n2, 0.0, 0.0], |stack| averages(stack, indices, is_rough));
        Self { local, lane, indices, averages }
    }

    /// Returns what it reflects and transmits of light from a cosine.
    pub(super) fn shares(&self, cos: f64) -> StackShares {
        let [n1, n2] = self.indices;
        self.local.shares_at_cosine(self.lane, n1, n2, cos)
    }

    /// Returns the transmittance of film and coat together from two directions. `bare` is that of the coat alone,
    /// `missing` what single scattering by a rough coat loses.
    pub(super) fn transmittance(
        &self,
        bare: &CoatTransmittance,
        missing: Option<&CoatMissingEnergy>,
        cosines: [f64; 2],
    ) -> CoatTransmittance {
        match missing {
            Some(missing) => missing.transmittance_with_film(&self.averages, bare),
            None => bare.with_film(&self.averages, cosines.map(|cos| self.shares(cos).refracted.mean())),
        }
    }
}

/// Averages a film over directions; for a smooth coat only the means are needed.
fn averages(stack: &Stack, [n1, n2]: [f64; 2], is_rough: bool) -> FilmAverages {
    let film = |cos: f64| stack.shares(n1, n2.into(), n1 * cos).means();
    let bare = |cos: f64| {
        let crosses = Interface::new(n1, n2, cos).transmittance;
        [1.0 - crosses, crosses]
    };
    // In a denser medium, layers may reflect totally beyond another angle than the coat does.
    let varies_slowly = stack.varies_slowly() && n1 <= n2;
    let averages = match is_rough {
        true => FilmAverages::new(varies_slowly, [n1, n2], n1.max(n2), film, bare),
        false => FilmAverages::from_mean(mean(varies_slowly, n2 / n1, film)),
    };
    if stack.layers().iter().all(|layer| layer.index.im == 0.0) {
        return averages;
    }
    let inside = stack.turned_around();
    let absorbed = |cos: f64| {
        let [reflected, transmittance] = inside.shares(n2, n1.into(), n2 * cos).means();
        [1.0 - reflected - transmittance, 0.0]
    };
    FilmAverages { absorbed_inside: mean(stack.varies_slowly(), n1 / n2, absorbed)[0].max(0.0), ..averages }
}
