//! How large a deviation can be by chance.

use std::f64::consts::SQRT_2;

/// Returns the deviation, in standard deviations of either sign, that the largest of `tests` independent normal
/// deviates exceeds with the probability `family`. Šidák 1967, *Rectangular Confidence Regions for the Means of
/// Multivariate Normal Distributions*: each may exceed it with the probability 1 - (1 - family)^(1 / tests).
///
/// Inverts the normal distribution by bisection, using the complementary error function.
pub(super) fn sidak_threshold(tests: usize, family: f64) -> f64 {
    let each = -libm::expm1(libm::log1p(-family) / tests.max(1) as f64);
    // Beyond 38 standard deviations the complementary error function is 0 in 64 bits.
    let (mut low, mut high) = (0.0, 38.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if libm::erfc(middle / SQRT_2) > each {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// Returns the normal deviate as improbable as a number of Student's distribution. Wallace 1959, *Bounds on Normal
/// Approximations to Student's and the Chi-Square Distributions*: z = (8 v + 1) / (8 v + 3) sqrt(v ln(1 + t^2 / v)).
///
/// A standard deviation that is estimated from few samples is often too small. This corrects deviations for that.
pub(super) fn normal_equivalent(t: f64, freedom: f64) -> f64 {
    if freedom.is_infinite() {
        return t;
    }
    let size = (freedom * libm::log1p(t * t / freedom)).sqrt();
    (size * (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0)).copysign(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles of the normal distribution: Abramowitz & Stegun 1964, table 26.5, and 4.8916 for half of 1e-6.
    #[test]
    fn one_test_has_the_published_quantiles() {
        for (family, expected) in [(0.05, 1.959964), (0.01, 2.575829), (0.001, 3.290527), (1e-6, 4.891638)] {
            assert!((sidak_threshold(1, family) - expected).abs() < 1e-6, "{family}");
        }
    }

    /// 1 - 0.95^(1/10) = 0.0051162, whose two-sided quantile is 2.7996.
    #[test]
    fn ten_tests_share_their_error_as_sidak_has_it() {
        let threshold = sidak_threshold(10, 0.05);
        assert!((libm::erfc(threshold / SQRT_2) - 0.005_116_196_891_823_743).abs() < 1e-15);
        assert!((threshold - 2.7996).abs() < 5e-4, "{threshold}");
        // More tests need a larger deviation, and millions a finite one.
        let many: Vec<f64> = [1, 100, 10_000, 25_000_000].map(|tests| sidak_threshold(tests, 0.01)).to_vec();
        assert!(many.is_sorted() && many[3] > 6.0 && many[3] < 6.5, "{many:?}");
    }

    /// Two-sided 1 % and 0.1 % points of Student's distribution: Abramowitz & Stegun 1964, table 26.10.
    #[test]
    fn numbers_of_student_become_normal_ones_of_the_same_probability() {
        for (freedom, one, tenth) in [(5.0, 4.032, 6.869), (10.0, 3.169, 4.587), (30.0, 2.750, 3.646)] {
            assert!((normal_equivalent(one, freedom) - 2.5758).abs() < 0.02, "{freedom}");
            assert!((normal_equivalent(-tenth, freedom) + 3.2905).abs() < 0.03, "{freedom}");
        }
        assert_eq!(normal_equivalent(3.0, f64::INFINITY), 3.0);
    }
}
