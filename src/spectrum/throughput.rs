use super::Lanes;

/// The share of the light at the end of a path that reaches the sensor, lane by lane: the classic tracer's k.
///
/// A lane whose throughput is 0 is not on the ray. This one rule covers padding, absorption, total reflection and
/// parting. For polarized light, it is what unpolarized light at the end of the path would count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throughput<const N: usize>(Lanes<N>);

impl<const N: usize> Throughput<N> {
    /// Creates the throughput of a camera ray that carries the given lanes with weight 1.
    pub fn starting(lanes: Lanes<N>) -> Self {
        Self(lanes)
    }

    /// Returns the light that reaches the sensor, if `light` shines into the end of the path.
    pub fn of(self, light: Lanes<N>) -> Lanes<N> {
        self.0 * light
    }

    /// Returns the throughput after an event that passes on a share of each lane.
    #[must_use]
    pub fn through(self, share: Lanes<N>) -> Self {
        Self(self.0 * share)
    }

    /// Returns the throughput of a path that was followed with probability `1 / factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self(self.0 * factor as f32)
    }

    /// Returns 1 for each lane that is on the ray, and 0 for the others.
    pub fn present(self) -> Lanes<N> {
        Lanes::from_fn(|i| if self.0[i] == 0.0 { 0.0 } else { 1.0 })
    }

    /// Returns the mean throughput over lanes of the given shares, which sum to 1.
    pub fn weight(self, shares: &Lanes<N>) -> f64 {
        f64::from((self.0 * *shares).sum())
    }
}
