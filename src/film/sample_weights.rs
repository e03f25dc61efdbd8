use super::filter::Filter;

/// Samples of a pixel that tell its variance, at least. Fewer are the same by chance in one pixel of an edge and others
/// in the next render, and then seem to have none.
pub const TELL_VARIANCE: u32 = 4;

/// What each of a pixel's samples counts in its means.
///
/// Of n samples drawn by the absolute value of a filter f, with the integral a, s are subtracted: they fall where f is
/// negative. With r = a s / n, a pixel is (1 + r) times the mean of those that are added, minus r times the mean of
/// those that are subtracted. The expectation is the filtered image: that of r is the integral of what is negative, and
/// the mean of the others does not depend on r. An even image comes out without noise, as the weights sum to 1 whatever
/// s is. Weights of a and -a would have the same expectation, and let s be seen there: of the plain cubic, 2 % of noise
/// with 64 samples. A division by their sum would show no s, but would be biased, and undefined where as many are
/// subtracted as are added, which is one of eight pixels with 2 samples.
#[derive(Clone, Copy, Debug)]
pub struct SampleWeights {
    counts: [u32; 2],
    /// The integral of the filter's absolute value.
    absolute: f64,
    /// What each sample counts that is added or subtracted, times the number of all.
    each: [f64; 2],
}

impl SampleWeights {
    /// Weights for a number of samples that are added, and one of samples that are subtracted. Where none is added
    /// there is nothing to subtract from, and the others are the image.
    pub fn new(filter: Filter, counts: [u32; 2]) -> Self {
        Self::by(filter.absolute_integral(), counts)
    }

    fn by(absolute: f64, counts: [u32; 2]) -> Self {
        let [added, subtracted] = counts.map(f64::from);
        let each = match counts {
            [_, 0] => [1.0, 0.0],
            [0, _] => [0.0, -1.0],
            _ => [(added + subtracted + absolute * subtracted) / added, absolute],
        };
        Self { counts, absolute, each }
    }

    /// The weights of a part of these samples by itself.
    pub fn of_part(&self, counts: [u32; 2]) -> Self {
        Self::by(self.absolute, counts)
    }

    /// The weights of those that are not in a part.
    pub fn of_others(&self, counts: [u32; 2]) -> Self {
        self.of_part([0, 1].map(|i| self.counts[i].saturating_sub(counts[i])))
    }

    /// Whether any sample is subtracted.
    pub fn subtracts(&self) -> bool {
        self.counts[1] > 0
    }

    /// How many samples there are.
    pub fn kept(&self) -> u32 {
        self.counts[0] + self.counts[1]
    }

    /// The same, at least 1.
    pub fn taken(&self) -> f64 {
        f64::from(self.kept().max(1))
    }

    /// How many are added, at least 1: layers of what samples meet are the means of these.
    pub fn added(&self) -> f64 {
        f64::from(self.counts[0].max(1))
    }

    /// A sum over all samples, by the sums over those that are added and subtracted; over all of them, a mean.
    pub fn sum(&self, [added, subtracted]: [f64; 2]) -> f64 {
        self.each[0] * added - self.each[1] * subtracted
    }

    /// The variance of a mean by both sums and the sum of all squares; of one sample nothing is known.
    ///
    /// The mean is, but for terms that vanish faster, that of a s (c - m), where s is the sign and m the mean of the
    /// samples c that are added.
    pub fn variance(&self, sums: [f64; 2], squares: f64) -> f64 {
        let (taken, [added, subtracted]) = (self.taken(), self.counts.map(f64::from));
        let spread = if self.counts.contains(&0) {
            let mean = (sums[0] + sums[1]) / taken;
            squares / taken - mean * mean
        } else {
            let middle = sums[0] / added;
            let signed = (sums[1] - subtracted * middle) / taken;
            (squares - 2.0 * middle * (sums[0] + sums[1])) / taken + middle * middle - signed * signed
        };
        (self.absolute * self.absolute * spread).max(0.0) / (taken - 1.0).max(1.0)
    }
}
