use super::Lanes;

/// What share of the light at the end of a path reaches the sensor, lane by lane: the classic tracer's k.
///
/// A lane whose throughput is 0 is not on the ray: padding, absorption, total reflection and parting are this one rule.
/// Of polarized light it is what unpolarized light at the end of the path would count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Throughput<const N: usize>(Lanes<N>);

impl<const N: usize> Throughput<N> {
    /// The throughput of a camera ray that carries the given lanes with weight 1.
    pub fn starting(lanes: Lanes<N>) -> Self {
        Self(lanes)
    }

    /// The light that reaches the sensor of what shines into the end of the path.
    pub fn of(self, light: Lanes<N>) -> Lanes<N> {
        self.0 * light
    }

    /// The throughput after an event that passes on a share of each lane.
    pub fn through(self, share: Lanes<N>) -> Self {
        Self(self.0 * share)
    }

    /// The throughput when the path was followed with probability `1 / factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self(self.0 * factor as f32)
    }

    /// The lanes that are on the ray, each 1, the others 0.
    pub fn present(self) -> Lanes<N> {
        Lanes::from_fn(|i| if self.0[i] == 0.0 { 0.0 } else { 1.0 })
    }

    /// The mean throughput over lanes of the given shares, which sum to 1.
    pub fn weight(self, shares: &Lanes<N>) -> f64 {
        f64::from((self.0 * *shares).sum())
    }
}
