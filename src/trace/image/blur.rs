//! How far gathered photons blur an image, told by gathering them twice.
//!
//! Light that varies by its Laplacian is blurred by the square of the kernel's radius times that, to leading order
//! (Silverman 1986, *Density Estimation for Statistics and Data Analysis*, section 4.3); bins of wavelengths that count
//! as one blur by the square of their width. By half of that, a kernel of half the area differs from the whole one.
//! Both gather the same photons around the same places, so that much of their noise is the same.
//!
//! Every replicate has such an estimate d_r of all pixels. Their noise has nothing in common, so the mean of d_r . d_s
//! over all pairs is the square of the blur, without noise (Hoeffding 1948, *A Class of Statistics with Asymptotically
//! Normal Distribution*). Its variance is what it changes without one of them (Arvesen 1969, *Jackknifing
//! U-Statistics*).
//!
//! Where light changes within a disc, higher orders count. The kernel of Epanechnikov multiplies the amplitude at the
//! frequency w by k(r w) with k(x) = 8 J_2(x) / x^2. Power w^-a turns the square of the blur into the integral of
//! w^-a (1 - k(w))^2, and what is told of it into that of 4 w^-a (k(w / sqrt 2) - k(w))^2. Their ratio is 1 for smooth
//! light; 1.32 for edges, where a, with the mean over a pixel in it, is 4; and 1.93 for folds of caustics of a point,
//! whose light falls like one over the root of the distance, where a is 3. The bound takes the largest.

use crate::trace::replicates::{Products, REPLICATES};

/// How many times the square that is told the blur of folds is.
const FOLDS: f64 = 1.93;

/// The sum of all squares, as it is expected and at most in 95 of 100 cases, by products of the replicates' estimates.
pub fn squares_of_blur(Products(products): &Products, student: f64) -> [f64; 2] {
    let count = REPLICATES as f64;
    // Of each replicate, its products with the others.
    let with_others: [f64; REPLICATES] = std::array::from_fn(|i| products[i].iter().sum::<f64>() - products[i][i]);
    let all = with_others.iter().sum::<f64>();
    let expected = (all / (count * (count - 1.0))).max(0.0);
    let without = with_others.map(|own| (all - 2.0 * own) / ((count - 1.0) * (count - 2.0)));
    let mean = without.iter().sum::<f64>() / count;
    let spread = without.iter().map(|square| (square - mean) * (square - mean)).sum::<f64>();
    let variance = spread * (count - 1.0) / count;
    [expected, FOLDS * (expected + student * variance.sqrt())]
}
