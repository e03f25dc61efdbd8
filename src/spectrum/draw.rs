use super::{Lanes, Table};

/// Which bin of every table each lane of a camera sample reads.
///
/// The tracer passes it on and never looks inside.
#[derive(Clone, Debug)]
pub struct Draw<const N: usize> {
    bins: [u16; N],
    shares: Lanes<N>,
}

impl<const N: usize> Draw<N> {
    /// The draw in which lane i reads bin i; lanes beyond the last bin stay empty.
    ///
    /// # Panics
    /// If there are more bins than lanes.
    pub fn fixed(bins: usize) -> Self {
        assert!(bins <= N, "{bins} bins do not fit into {N} lanes");
        Self {
            bins: std::array::from_fn(|i| i.min(bins - 1) as u16),
            shares: Lanes::from_fn(|i| if i < bins { 1.0 / bins as f32 } else { 0.0 }),
        }
    }

    /// A weight: one number per lane.
    pub fn read(&self, table: &Table) -> Lanes<N> {
        Lanes::from_fn(|i| table.bins()[self.bins[i] as usize] as f32)
    }

    /// A refractive index: one number per lane with all its digits.
    pub fn read_exact(&self, table: &Table) -> [f64; N] {
        std::array::from_fn(|i| table.bins()[self.bins[i] as usize])
    }

    /// How much each lane counts when a single number must stand for a throughput; the shares sum to 1.
    pub fn shares(&self) -> &Lanes<N> {
        &self.shares
    }

    /// The lanes a camera ray starts with: 1 where there is a bin.
    pub fn start(&self) -> Lanes<N> {
        Lanes::from_fn(|i| if self.shares[i] == 0.0 { 0.0 } else { 1.0 })
    }

    /// The bin that a lane reads.
    pub fn bin(&self, lane: usize) -> usize {
        self.bins[lane] as usize
    }
}
