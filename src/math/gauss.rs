use std::f64::consts::PI;

/// Returns the nodes and weights of the Gauss-Legendre rule with `count` nodes in 0..1. The weights sum to 1.
///
/// Finds the roots of the Legendre polynomial by Newton's method, starting from Tricomi's estimate, as in Press et al.
/// 2007, *Numerical Recipes*, section 4.6.
pub fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let order = count as f64;
    let node = |i: usize| {
        let mut x = libm::cos(PI * (i as f64 + 0.75) / (order + 0.5));
        let mut slope = 1.0;
        // Each step of Newton's method doubles the number of correct digits: the initial three soon become all.
        for _ in 0..6 {
            let (mut value, mut before) = (1.0, 0.0);
            for degree in 0..count {
                let j = degree as f64;
                (value, before) = (((2.0 * j + 1.0) * x * value - j * before) / (j + 1.0), value);
            }
            slope = order * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        [0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_integrated_exactly() {
        for count in [1, 5, 32] {
            let rule = gauss_legendre(count);
            for power in 0..2 * count as i32 {
                let sum: f64 = rule.iter().map(|[x, weight]| weight * x.powi(power)).sum();
                assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-12, "{count} places, power {power}: {sum}");
            }
        }
    }
}
