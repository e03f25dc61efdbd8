use super::filter::Filter;

/// The minimum number of samples of a pixel for estimating its variance. With fewer samples, those of a pixel on an
/// edge may all be equal by chance, and differ from those of the next render. Their variance then seems to be 0.
pub const TELL_VARIANCE: u32 = 4;

/// The weights of a pixel's samples in its means.
///
/// Let a be the integral of |f| for a filter f, and let n samples be drawn with a density proportional to |f|. The s
/// samples that fall where f is negative are subtracted. With r = a s / n, a pixel is (1 + r) times the mean of the
/// added samples, minus r times the mean of the subtracted ones. Its expectation is the filtered image: that of r is
/// the integral of the negative part, and the expected means do not depend on r. A uniform image has no noise, since
/// the weights sum to 1 for any s. Weights of a and -a would have the same expectation, but s would be visible: for the
/// plain cubic with 64 samples, as 2 % of noise. Dividing by their sum would hide s, but be biased, and undefined if as
/// many samples are subtracted as added, which happens in one of eight pixels with 2 samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleWeights {
    counts: [u32; 2],
    /// The integral of the filter's absolute value.
    absolute: f64,
    /// The weights of an added and of a subtracted sample, times the number of all samples.
    weights: [f64; 2],
}

impl SampleWeights {
    /// Computes the weights for the given numbers of added and subtracted samples. If none is added, there is nothing
    /// to subtract from, and the image consists of the others.
    pub fn new(filter: Filter, counts: [u32; 2]) -> Self {
        Self::with_integral(filter.absolute_integral(), counts)
    }

    fn with_integral(absolute: f64, counts: [u32; 2]) -> Self {
        let [added, subtracted] = counts.map(f64::from);
        let weights = match counts {
            [_, 0] => [1.0, 0.0],
            [0, _] => [0.0, -1.0],
            _ => [(added + subtracted + absolute * subtracted) / added, absolute],
        };
        Self { counts, absolute, weights }
    }

    /// Returns the weights of a part of these samples on its own.
    #[must_use]
    pub fn of_part(&self, counts: [u32; 2]) -> Self {
        Self::with_integral(self.absolute, counts)
    }

    /// Returns the weights of the samples outside a part.
    #[must_use]
    pub fn of_others(&self, counts: [u32; 2]) -> Self {
        self.of_part([0, 1].map(|i| self.counts[i].saturating_sub(counts[i])))
    }

    /// Returns whether any sample is subtracted.
    pub fn subtracts(&self) -> bool {
        self.counts[1] > 0
    }

    /// Returns the number of samples.
    pub fn kept(&self) -> u32 {
        self.counts[0] + self.counts[1]
    }

    /// Returns the number of samples, at least 1.
    pub fn taken(&self) -> f64 {
        f64::from(self.kept().max(1))
    }

    /// Returns the number of added samples, at least 1. Layers that describe what samples hit are means over these.
    pub fn added(&self) -> f64 {
        f64::from(self.counts[0].max(1))
    }

    /// Returns the weighted sum over all samples, given the sums over the added and the subtracted ones. Divided by the
    /// number of all samples, it is a mean.
    pub fn sum(&self, [added, subtracted]: [f64; 2]) -> f64 {
        self.weights[0] * added - self.weights[1] * subtracted
    }

    /// Estimates the variance of a mean from both sums and the sum of all squares. For a single sample nothing is
    /// known, and it returns 0.
    ///
    /// Up to terms that vanish faster, it is the variance of the mean of a s (c - m). Here s is the sign of a sample, c
    /// its value, and m the mean of the added samples.
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
