//! What a film does to light from many directions.

use std::sync::OnceLock;

use crate::math::gauss_legendre;

/// Number of cosines at which a film is compared with the bare surface. Between them the difference is linear: a sum of
/// hat functions. The cosines are those in the rarer medium, from which light crosses at every angle, and in which
/// shares are smooth.
pub(super) const HATS: usize = 20;
/// For each hat, a value for the reflected light and one for the light that crosses.
pub(super) type HatWeights = [[f64; 2]; HATS];
/// Number of quadrature points for means over the hemisphere, of films that change slowly with the angle, and of
/// others.
const QUADRATURE_POINTS: [usize; 2] = [5, 32];

/// Differences of a film from the bare surface, and its cosine-weighted means over the hemisphere, each as (reflected,
/// crossing).
#[derive(Clone, Debug)]
pub(super) struct FilmAverages {
    pub(super) differences: HatWeights,
    pub(super) mean: [f64; 2],
    /// Share of diffuse light from inside that is absorbed.
    pub(super) absorbed_inside: f64,
}

impl FilmAverages {
    /// Averages a film, slow or not, that is met in a medium of index `n1` with `n2` beyond. `film` returns what it
    /// reflects and transmits at a cosine, `bare` what the surface would without it. Differences reach to the critical
    /// angle of `to`, which is `n2` or more.
    pub(super) fn new(
        varies_slowly: bool,
        [n1, n2]: [f64; 2],
        to: f64,
        film: impl Fn(f64) -> [f64; 2],
        bare: impl Fn(f64) -> [f64; 2],
    ) -> Self {
        let critical_cos2 = critical_cos2(to / n1);
        let difference = |hat: usize| {
            let rare_cos = hat_cosine(hat);
            let cos = (critical_cos2 + (1.0 - critical_cos2) * rare_cos * rare_cos).sqrt();
            let ([r, t], [bare_r, bare_t]) = (film(cos), bare(cos));
            [r - bare_r, t - bare_t]
        };
        let differences = std::array::from_fn(difference);
        Self { differences, mean: mean(varies_slowly, n2 / n1, film), absorbed_inside: 0.0 }
    }

    /// Makes the averages of a film for which only the means are needed.
    pub(super) fn from_mean(mean: [f64; 2]) -> Self {
        Self { differences: [[0.0; 2]; HATS], mean, absorbed_inside: 0.0 }
    }

    /// Returns the weighted sum of films.
    pub(super) fn sum<const M: usize>(films: &[Self; M], weights: &[f64; M]) -> Self {
        let mut sum = Self::from_mean([0.0; 2]);
        for (film, weight) in films.iter().zip(weights) {
            for (sum, film) in sum.differences.iter_mut().zip(&film.differences) {
                (0..2).for_each(|way| sum[way] += weight * film[way]);
            }
            (0..2).for_each(|way| sum.mean[way] += weight * film.mean[way]);
            sum.absorbed_inside += weight * film.absorbed_inside;
        }
        sum
    }

    /// Returns the largest difference between the numbers of two films.
    pub(super) fn max_difference(&self, other: &Self) -> f64 {
        let numbers =
            |film: &Self| film.differences.into_iter().chain([film.mean, [film.absorbed_inside, 0.0]]).flatten();
        numbers(self).zip(numbers(other)).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }

    /// Returns what the film adds to the energy that single scattering loses; `missing` has the two lost shares of each
    /// hat.
    pub(super) fn added_missing_energy(&self, missing: &HatWeights) -> f64 {
        let hat_sum = |hat: usize| (0..2).map(|way| self.differences[hat][way] * missing[hat][way]).sum::<f64>();
        (0..HATS).map(hat_sum).sum()
    }
}

/// Returns the squared cosine of the critical angle to a relative index, or 0 if there is none.
fn critical_cos2(ratio: f64) -> f64 {
    (1.0 - ratio * ratio).max(0.0)
}

/// Returns the cosine of a hat. The hats are denser toward the horizon.
fn hat_cosine(hat: usize) -> f64 {
    let place = hat as f64 / (HATS - 1) as f64;
    place * place
}

/// Returns the hats on both sides of a cosine, and the weight of each, in a medium to which the one beyond has a
/// relative index.
///
/// Under total reflection a film differs by what it absorbs, which is taken to fall linearly from the critical angle to
/// the horizon.
pub(super) fn nearby_hats(cos: f64, ratio: f64) -> [(usize, f64); 2] {
    let critical_cos2 = critical_cos2(ratio);
    let rare_cos2 = (cos * cos - critical_cos2) / (1.0 - critical_cos2);
    if rare_cos2 <= 0.0 && critical_cos2 > 0.0 {
        return [(0, cos.max(0.0) / critical_cos2.sqrt()), (1, 0.0)];
    }
    let rare_cos = rare_cos2.clamp(0.0, 1.0).sqrt();
    let below = ((rare_cos.sqrt() * (HATS - 1) as f64) as usize).min(HATS - 2);
    let [from, to] = [below, below + 1].map(hat_cosine);
    let fraction = ((rare_cos - from) / (to - from)).clamp(0.0, 1.0);
    [(below, 1.0 - fraction), (below + 1, fraction)]
}

fn quadrature_rule(varies_slowly: bool) -> &'static [[f64; 2]] {
    static RULES: [OnceLock<Vec<[f64; 2]>>; 2] = [const { OnceLock::new() }; 2];
    let which = usize::from(!varies_slowly);
    RULES[which].get_or_init(|| gauss_legendre(QUADRATURE_POINTS[which]))
}

/// Returns twice the integral of two shares of a film times cosine over the cosine, in a medium to which the one beyond
/// has a relative index. At the critical angle, if there is one, the shares have a kink, so the two sides are
/// integrated separately.
pub(super) fn mean(varies_slowly: bool, ratio: f64, shares: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let (critical_cos2, mut sum) = (critical_cos2(ratio), [0.0; 2]);
    for &[t, weight] in quadrature_rule(varies_slowly) {
        // cos^2 = critical (1 - t^2) and critical + (1 - critical) t^2.
        let [flat, steep] =
            [critical_cos2 * (1.0 - t * t), critical_cos2 + (1.0 - critical_cos2) * t * t].map(|x| shares(x.sqrt()));
        (0..2).for_each(|way| {
            sum[way] += 2.0 * weight * t * (critical_cos2 * flat[way] + (1.0 - critical_cos2) * steep[way])
        });
    }
    sum
}
