//! The chi-squared test of counts against probabilities.

/// Significance of all tests of one kind taken together.
const SIGNIFICANCE: f64 = 0.01;
/// Expected count below which bins are pooled.
const MIN_EXPECTED: f64 = 5.0;

/// Panics if the counts in bins deviate from their probabilities by more than chance allows, in one of `tests` tests.
///
/// Each test gets the share of the significance that suits independent tests: Sidak 1967.
pub fn check(name: &str, counts: &[u64], probabilities: &[f64], tests: u32) {
    let total = counts.iter().sum::<u64>() as f64;
    let mut pooled = (0.0, 0.0);
    let (mut statistic, mut bins) = (0.0, 0u32);
    for (&count, &probability) in counts.iter().zip(probabilities) {
        let (count, expected) = (count as f64, probability * total);
        if expected < MIN_EXPECTED {
            pooled = (pooled.0 + count, pooled.1 + expected);
        } else {
            statistic += (count - expected) * (count - expected) / expected;
            bins += 1;
        }
    }
    statistic += (pooled.0 - pooled.1) * (pooled.0 - pooled.1) / pooled.1.max(MIN_EXPECTED);
    let chance = upper_tail(statistic, f64::from(bins - 1));
    let min_chance = -libm::expm1(libm::log1p(-SIGNIFICANCE) / f64::from(tests));
    println!("{name}: chi-squared {statistic:.1} in {bins} bins, chance {chance:.4}, least {min_chance:.5}");
    assert!(
        chance >= min_chance,
        "{name}: chi-squared {statistic:.1} in {bins} bins has chance {chance:.2e} < {min_chance:.2e}"
    );
}

/// Returns the probability of a greater chi-squared with many degrees of freedom: Wilson & Hilferty 1931.
///
/// The cube root of chi-squared over its degrees of freedom is nearly normally distributed.
fn upper_tail(statistic: f64, degrees: f64) -> f64 {
    let variance = 2.0 / (9.0 * degrees);
    let normal = (libm::cbrt(statistic / degrees) - (1.0 - variance)) / variance.sqrt();
    0.5 * libm::erfc(normal / std::f64::consts::SQRT_2)
}

#[test]
fn tails_of_chi_squared_agree_with_tables() {
    // Abramowitz & Stegun 1964, table 26.8.
    for (degrees, statistic, chance) in [(30.0, 50.892, 0.01), (60.0, 91.952, 0.005), (100.0, 118.498, 0.1)] {
        assert!((upper_tail(statistic, degrees) / chance - 1.0).abs() < 0.02);
    }
}
