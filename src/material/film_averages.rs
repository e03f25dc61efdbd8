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
const PLACES: [usize; 2] = [5, 32];

/// Differences of a film from the bare surface, and its cosine-weighted means over the hemisphere, each as (reflected,
/// crossing).
#[derive(Clone, Debug)]
pub(super) struct FilmAverages {
    pub(super) differences: HatWeights,
    pub(super) mean: [f64; 2],
    /// Share of diffuse light from inside that is absorbed.
    pub(super) lost_inside: f64,
}

impl FilmAverages {
    /// Averages a film, slow or not, that is met in a medium of index `n1` with `n2` beyond. `film` returns what it
    /// reflects and transmits at a cosine, `bare` what the surface would without it. Differences reach to the critical
    /// angle of `to`, which is `n2` or more.
    pub(super) fn new(
        is_slow: bool,
        [n1, n2]: [f64; 2],
        to: f64,
        film: impl Fn(f64) -> [f64; 2],
        bare: impl Fn(f64) -> [f64; 2],
    ) -> Self {
        let critical = critical(to / n1);
        let difference = |hat: usize| {
            let rare = cosine_of(hat);
            let cos = (critical + (1.0 - critical) * rare * rare).sqrt();
            let ([r, t], [bare_r, bare_t]) = (film(cos), bare(cos));
            [r - bare_r, t - bare_t]
        };
        let differences = std::array::from_fn(difference);
        Self { differences, mean: mean(is_slow, n2 / n1, film), lost_inside: 0.0 }
    }

    /// Makes the averages of a film for which only the means are needed.
    pub(super) fn of_mean(mean: [f64; 2]) -> Self {
        Self { differences: [[0.0; 2]; HATS], mean, lost_inside: 0.0 }
    }

    /// Returns the weighted sum of films.
    pub(super) fn sum<const M: usize>(films: &[Self; M], weights: &[f64; M]) -> Self {
        let mut sum = Self::of_mean([0.0; 2]);
        for (film, weight) in films.iter().zip(weights) {
            for (sum, film) in sum.differences.iter_mut().zip(&film.differences) {
                (0..2).for_each(|way| sum[way] += weight * film[way]);
            }
            (0..2).for_each(|way| sum.mean[way] += weight * film.mean[way]);
            sum.lost_inside += weight * film.lost_inside;
        }
        sum
    }

    /// Returns the largest difference between the numbers of two films.
    pub(super) fn differs_by(&self, other: &Self) -> f64 {
        let numbers = |film: &Self| film.differences.into_iter().chain([film.mean, [film.lost_inside, 0.0]]).flatten();
        numbers(self).zip(numbers(other)).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }

    /// Returns what the film adds to the energy that single scattering loses; `missing` has the two lost shares of each
    /// hat.
    pub(super) fn added(&self, missing: &HatWeights) -> f64 {
        let of_hat = |hat: usize| (0..2).map(|way| self.differences[hat][way] * missing[hat][way]).sum::<f64>();
        (0..HATS).map(of_hat).sum()
    }
}

/// Returns the squared cosine of the critical angle to a relative index, or 0 if there is none.
fn critical(ratio: f64) -> f64 {
    (1.0 - ratio * ratio).max(0.0)
}

/// Returns the cosine of a hat. The hats are denser toward the horizon.
fn cosine_of(hat: usize) -> f64 {
    let place = hat as f64 / (HATS - 1) as f64;
    place * place
}

/// Returns the hats on both sides of a cosine, and the weight of each, in a medium to which the one beyond has a
/// relative index.
///
/// Under total reflection a film differs by what it absorbs, which is taken to fall linearly from the critical angle to
/// the horizon.
pub(super) fn hats(cos: f64, ratio: f64) -> [(usize, f64); 2] {
    let critical = critical(ratio);
    let rare_squared = (cos * cos - critical) / (1.0 - critical);
    if rare_squared <= 0.0 && critical > 0.0 {
        return [(0, cos.max(0.0) / critical.sqrt()), (1, 0.0)];
    }
    let rare = rare_squared.clamp(0.0, 1.0).sqrt();
    let below = ((rare.sqrt() * (HATS - 1) as f64) as usize).min(HATS - 2);
    let [from, to] = [below, below + 1].map(cosine_of);
    let part = ((rare - from) / (to - from)).clamp(0.0, 1.0);
    [(below, 1.0 - part), (below + 1, part)]
}

fn rule(is_slow: bool) -> &'static [[f64; 2]] {
    static RULES: [OnceLock<Vec<[f64; 2]>>; 2] = [const { OnceLock::new() }; 2];
    let which = usize::from(!is_slow);
    RULES[which].get_or_init(|| gauss_legendre(PLACES[which]))
}

/// Returns twice the integral of two shares of a film times cosine over the cosine, in a medium to which the one beyond
/// has a relative index. At the critical angle, if there is one, the shares have a kink, so the two sides are
/// integrated separately.
pub(super) fn mean(is_slow: bool, ratio: f64, of: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let (critical, mut sum) = (critical(ratio), [0.0; 2]);
    for &[t, weight] in rule(is_slow) {
        // cos^2 = critical (1 - t^2) and critical + (1 - critical) t^2.
        let [flat, steep] = [critical * (1.0 - t * t), critical + (1.0 - critical) * t * t].map(|x| of(x.sqrt()));
        (0..2).for_each(|way| sum[way] += 2.0 * weight * t * (critical * flat[way] + (1.0 - critical) * steep[way]));
    }
    sum
}
