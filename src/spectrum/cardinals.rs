//! Smooth interpolation between the wavelengths of fixed lanes.

use super::visible;

/// Returns the cardinal function of each node (in nm, ascending) on the visible grid: 1 at its node, 0 at all others
/// and a cubic spline in between. It is level at the first and last node (clamped) and constant beyond them. At every
/// wavelength, the functions sum to 1.
///
/// de Boor 1978, *A Practical Guide to Splines*, chapter IV, equation 4.
pub(super) fn cardinals(nodes: &[f64]) -> Vec<Vec<f64>> {
    (0..nodes.len())
        .map(|node| {
            let values: Vec<f64> = (0..nodes.len()).map(|i| if i == node { 1.0 } else { 0.0 }).collect();
            let slopes = slopes(nodes, &values);
            visible::wavelengths().map(|nm| evaluate(nodes, &values, &slopes, nm)).collect()
        })
        .collect()
}

/// Returns the slopes at the nodes that make the second derivative continuous, and 0 at both ends.
fn slopes(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let n = nodes.len();
    // Forward elimination of the tridiagonal system, then back substitution.
    let (mut ratio, mut right) = (vec![0.0; n], vec![0.0; n]);
    for i in 1..n.saturating_sub(1) {
        let (before, after) = (1.0 / (nodes[i] - nodes[i - 1]), 1.0 / (nodes[i + 1] - nodes[i]));
        let rises = (values[i] - values[i - 1]) * before * before + (values[i + 1] - values[i]) * after * after;
        let pivot = 2.0 * (before + after) - before * ratio[i - 1];
        ratio[i] = after / pivot;
        right[i] = (3.0 * rises - before * right[i - 1]) / pivot;
    }
    let mut slopes = vec![0.0; n];
    for i in (1..n.saturating_sub(1)).rev() {
        slopes[i] = right[i] - ratio[i] * slopes[i + 1];
    }
    slopes
}

/// Evaluates at x the cubic with the given values and slopes at both ends of the interval around x.
fn evaluate(nodes: &[f64], values: &[f64], slopes: &[f64], x: f64) -> f64 {
    let after = nodes.partition_point(|&node| node < x);
    if after == 0 {
        return values[0];
    }
    if after == nodes.len() {
        return values[after - 1];
    }
    let width = nodes[after] - nodes[after - 1];
    let t = (x - nodes[after - 1]) / width;
    let (t2, t3) = (t * t, t * t * t);
    let (rise, start) = (3.0 * t2 - 2.0 * t3, t3 - 2.0 * t2 + t);
    values[after - 1] * (1.0 - rise)
        + values[after] * rise
        + width * (slopes[after - 1] * start + slopes[after] * (t3 - t2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cardinals_sum_to_one_and_follow_a_smooth_curve() {
        let nodes: Vec<f64> = (0..12).map(|i| 412.5 + 25.0 * f64::from(i)).collect();
        let cardinals = cardinals(&nodes);
        let smooth = |nm: f64| 0.5 + 0.3 * ((nm - 412.5) / 275.0 * std::f64::consts::PI).cos();
        for (i, nm) in visible::wavelengths().enumerate() {
            let sum: f64 = cardinals.iter().map(|function| function[i]).sum();
            assert!((sum - 1.0).abs() < 1e-14);
            let interpolated: f64 = cardinals.iter().zip(&nodes).map(|(f, &node)| f[i] * smooth(node)).sum();
            let expected = smooth(nm.clamp(412.5, 687.5));
            assert!((interpolated - expected).abs() < 2e-5, "{interpolated} for {expected} at {nm}");
        }
    }

    #[test]
    fn a_single_node_stands_for_all_wavelengths() {
        assert!(cardinals(&[550.0])[0].iter().all(|&x| x == 1.0));
    }
}
