//! What a film makes of light from many directions.

use std::sync::OnceLock;

use crate::math::gauss_legendre;

/// Cosines at which a film is compared with the bare surface, between which the difference is taken as linear: those in
/// the rarer medium, from which light crosses at every angle, and of which shares are a smooth function.
pub(super) const HATS: usize = 20;
/// For each hat, what is told of the light that is reflected and of that which crosses.
pub(super) type HatWeights = [[f64; 2]; HATS];
/// Places that give the mean over the hemisphere of films that change slowly with the angle, and of others.
const PLACES: [usize; 2] = [5, 32];

/// How a film differs from the bare surface, and its means over the hemisphere, by cosine: each (reflected, crossing).
#[derive(Clone, Debug)]
pub(super) struct FilmAverages {
    pub(super) differences: HatWeights,
    pub(super) mean: [f64; 2],
    /// Of diffuse light from inside, the share that is absorbed.
    pub(super) lost_inside: f64,
}

impl FilmAverages {
    /// Of a film, slow or not, met in a medium of index `n1` with `n2` beyond, that reflects and lets through as `film`
    /// says of a cosine, where without it the surface would do so as `bare` says. Differences are told up to the
    /// critical angle of `to`, which is `n2` or more.
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

    /// Of a film of which only the means are asked for.
    pub(super) fn of_mean(mean: [f64; 2]) -> Self {
        Self { differences: [[0.0; 2]; HATS], mean, lost_inside: 0.0 }
    }

    /// The sum of films, each times its weight.
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

    /// The largest difference between the numbers of two films.
    pub(super) fn differs_by(&self, other: &Self) -> f64 {
        let numbers = |film: &Self| film.differences.into_iter().chain([film.mean, [film.lost_inside, 0.0]]).flatten();
        numbers(self).zip(numbers(other)).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }

    /// What the film adds to the two shares that single scattering loses of the light that meets each hat.
    pub(super) fn added(&self, missing: &HatWeights) -> f64 {
        let of_hat = |hat: usize| (0..2).map(|way| self.differences[hat][way] * missing[hat][way]).sum::<f64>();
        (0..HATS).map(of_hat).sum()
    }
}

/// The squared cosine of the critical angle to a relative index; 0 where there is none.
fn critical(ratio: f64) -> f64 {
    (1.0 - ratio * ratio).max(0.0)
}

/// The cosine of a hat: denser toward the horizon.
fn cosine_of(hat: usize) -> f64 {
    let place = hat as f64 / (HATS - 1) as f64;
    place * place
}

/// The hats on both sides of a cosine in a medium to which that beyond has a relative index, and the weight of each.
///
/// Under total reflection a film differs by what it absorbs: linearly less from the critical angle to the horizon.
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

/// Twice the integral of two shares of a film times cosine over the cosine, in a medium to which that beyond has a
/// relative index: at the critical angle, if there is one, shares have a kink, up to which both sides are integrated.
pub(super) fn mean(is_slow: bool, ratio: f64, of: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let (critical, mut sum) = (critical(ratio), [0.0; 2]);
    for &[t, weight] in rule(is_slow) {
        // cos^2 = critical (1 - t^2) and critical + (1 - critical) t^2.
        let [flat, steep] = [critical * (1.0 - t * t), critical + (1.0 - critical) * t * t].map(|x| of(x.sqrt()));
        (0..2).for_each(|way| sum[way] += 2.0 * weight * t * (critical * flat[way] + (1.0 - critical) * steep[way]));
    }
    sum
}
