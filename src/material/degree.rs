//! To what degree light leaves a surface polarized.

/// Lanes that are asked where indices vary smoothly from lane to lane.
pub(super) const LANES: usize = 8;

/// |s - p| / (s + p) of what is left of both polarizations.
pub(super) fn degree([s, p]: [f64; 2]) -> f64 {
    if s + p > 0.0 { (s - p).abs() / (s + p) } else { 0.0 }
}

/// |s - p| / (s + p) of all lanes' light together: under a film a lane may be nearly dark and all of one polarization,
/// which says nothing of the light of the others.
pub(super) fn of_all_lanes(lanes: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [difference, sum] = lanes.fold([0.0; 2], |[d, sum], [s, p]| [d + (s - p).abs(), sum + (s + p)]);
    if sum > 0.0 { difference / sum } else { 0.0 }
}

pub(super) fn largest(degrees: impl Iterator<Item = f64>) -> f32 {
    degrees.fold(0.0, f64::max) as f32
}
