//! The degree to which light leaves a surface polarized.

/// Maximum number of lanes to evaluate where indices vary smoothly from lane to lane.
pub(super) const MAX_EVALUATED_LANES: usize = 8;

/// Returns the degree |s - p| / (s + p) of light whose polarizations are reduced to s and p.
pub(super) fn degree([s, p]: [f64; 2]) -> f64 {
    if s + p > 0.0 { (s - p).abs() / (s + p) } else { 0.0 }
}

/// Returns |s - p| / (s + p) with both sums taken over all lanes. Under a film a single lane may be nearly dark and
/// fully polarized, which does not represent the light of the others.
pub(super) fn combined_degree(lanes: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [difference, sum] = lanes.fold([0.0; 2], |[d, sum], [s, p]| [d + (s - p).abs(), sum + (s + p)]);
    if sum > 0.0 { difference / sum } else { 0.0 }
}

pub(super) fn max_degree(degrees: impl Iterator<Item = f64>) -> f32 {
    degrees.fold(0.0, f64::max) as f32
}
