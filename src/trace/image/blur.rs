//! How much gathered photons blur an image, measured by gathering them twice.
//!
//! To leading order, a kernel blurs light by the square of its radius times the light's Laplacian (Silverman 1986,
//! *Density Estimation for Statistics and Data Analysis*, section 4.3); bins of wavelengths that count as one blur by
//! the square of their width. A kernel of half the area differs from the whole one by half of that. Both gather the
//! same photons around the same places, so that much of their noise is the same.
//!
//! Every replicate has such an estimate d_r of all pixels. Their noise is independent, so the mean of d_r . d_s over
//! all pairs estimates the square of the blur without a bias from noise (Hoeffding 1948, *A Class of Statistics with
//! Asymptotically Normal Distribution*). Its variance is estimated by leaving out one replicate at a time (Arvesen
//! 1969, *Jackknifing U-Statistics*).
//!
//! Where light changes within a disc, higher orders count. The Epanechnikov kernel multiplies the amplitude at the
//! frequency w by k(r w) with k(x) = 8 J_2(x) / x^2. For a power spectrum of w^-a, the square of the blur is the
//! integral of w^-a (1 - k(w))^2, and its estimate is that of 4 w^-a (k(w / sqrt 2) - k(w))^2. Their ratio is 1 for
//! smooth light; 1.32 for edges, where a, including the mean over a pixel, is 4; and 1.93 for folds of caustics of a
//! point, whose light falls as one over the root of the distance, where a is 3. The bound takes the largest.

use crate::trace::replicates::{Products, REPLICATES};

/// Ratio of the squared blur of folds to its estimate.
const FOLD_RATIO: f64 = 1.93;

/// Returns the sum of all squares, as expected and at most in 95 of 100 cases, by products of replicates' estimates.
pub fn squared_blur(Products(products): &Products, student: f64) -> [f64; 2] {
    let count = REPLICATES as f64;
    // For each replicate, the sum of its products with the others.
    let with_others: [f64; REPLICATES] = std::array::from_fn(|i| products[i].iter().sum::<f64>() - products[i][i]);
    let all = with_others.iter().sum::<f64>();
    let expected = (all / (count * (count - 1.0))).max(0.0);
    let others_mean = with_others.map(|own| (all - 2.0 * own) / ((count - 1.0) * (count - 2.0)));
    let mean = others_mean.iter().sum::<f64>() / count;
    let spread = others_mean.iter().map(|square| (square - mean) * (square - mean)).sum::<f64>();
    let variance = spread * (count - 1.0) / count;
    [expected, FOLD_RATIO * (expected + student * variance.sqrt())]
}
