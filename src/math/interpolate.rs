/// Interpolates linearly between samples (x, values), constant beyond the ends. Returns 0 if there are no samples.
pub fn interpolate<const N: usize>(samples: &[[f64; N]], x: f64) -> [f64; N] {
    let after = samples.partition_point(|sample| sample[0] < x);
    let (low, high) = match (after.checked_sub(1).map(|before| samples[before]), samples.get(after)) {
        (Some(low), Some(high)) => (low, high),
        (Some(end), None) => return end,
        (None, end) => return end.copied().unwrap_or([0.0; N]),
    };
    let t = (x - low[0]) / (high[0] - low[0]);
    std::array::from_fn(|i| low[i] + (high[i] - low[i]) * t)
}
