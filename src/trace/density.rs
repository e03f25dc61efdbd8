//! Adaptive sampling: where an image takes more samples than on average, and where fewer.
//!
//! In a given time, the error is smallest if the number of samples of a pixel is proportional to the square root of its
//! variance over the cost of a sample (Neyman 1934, *On the Two Different Aspects of the Representative Method*). A
//! pilot estimates both. Its samples are not used for the image, so no pixel's count depends on its own samples.
//! Otherwise the pixel would be too dark (Kirk & Arvo 1991, *Unbiased Sampling Techniques for Image Synthesis*). Counts
//! are the requested number of samples times a power of two, because sets of random numbers are well distributed in
//! powers of two.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// The sampling rates of pixels, for each cell of the format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SampleDensity {
    /// Number of cells along both sides, 1 or more. Each cell has as many pixels as any other, or one more.
    pub cells: [u32; 2],
    /// Power of two of the samples in each cell, row by row, from [`LEAST`](Self::LEAST) to [`MOST`](Self::MOST).
    pub powers: Vec<i8>,
}

/// The sampling rate of a pixel: a power of two, relative to the average.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rate(i8);

impl SampleDensity {
    /// Half as many samples as on average.
    pub const LEAST: i8 = -1;
    /// Four times as many samples as on average.
    pub const MOST: i8 = 2;

    /// Returns the factor on the average number of samples, given its power of two.
    pub fn times(power: i8) -> f64 {
        f64::from(power).exp2()
    }

    /// Returns the rate of a pixel. Beyond the edge of the format, it is the rate of the nearest pixel.
    pub(super) fn rate(&self, format: [u32; 2], pixel: [i32; 2]) -> Rate {
        let place = |axis: usize| {
            let at = pixel[axis].clamp(0, format[axis] as i32 - 1) as u64;
            (at * u64::from(self.cells[axis]) / u64::from(format[axis])) as usize
        };
        let power = self.powers.get(place(1) * self.cells[0] as usize + place(0)).copied();
        Rate(power.unwrap_or_default().clamp(Self::LEAST, Self::MOST))
    }
}

impl Rate {
    /// Returns the factor on the average number of samples.
    pub fn times(self) -> f64 {
        SampleDensity::times(self.0)
    }

    /// Returns the samples that the pixel takes, given those that an average pixel takes.
    pub fn sample_numbers(self, all: &Range<u32>) -> Range<u32> {
        let scale =
            |number: u32| if self.0 < 0 { number.div_ceil(1 << -self.0) } else { number.saturating_mul(1 << self.0) };
        scale(all.start)..scale(all.end)
    }

    /// Returns the sample of an average pixel with which a sample of this one is taken.
    pub fn average_number(self, own: u32) -> u32 {
        if self.0 < 0 { own << -self.0 } else { own >> self.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_of_every_rate_are_taken_once_and_with_those_of_all() {
        for rate in (SampleDensity::LEAST..=SampleDensity::MOST).map(Rate) {
            let (mut next, mut taken) = (0, 0);
            for all in [0..1, 1..2, 2..5, 5..16, 16..17, 17..64] {
                let own = rate.sample_numbers(&all);
                assert_eq!(own.start, next, "{rate:?}");
                own.clone()
                    .for_each(|number| assert!(all.contains(&rate.average_number(number)), "{rate:?}, {number}"));
                (next, taken) = (own.end, taken + own.len());
            }
            assert_eq!(taken as f64, 64.0 * rate.times());
        }
    }

    #[test]
    fn every_pixel_has_the_rate_of_its_cell() {
        let density = SampleDensity { cells: [3, 2], powers: vec![-1, 0, 1, 2, 1, 0] };
        let times = |pixel| density.rate([10, 4], pixel).times();
        let row = |y| (-2..12).map(|x| times([x, y])).collect::<Vec<_>>();
        let first = [0.5, 0.5, 0.5, 0.5, 0.5, 0.5, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0, 2.0];
        assert_eq!(row(1), first);
        assert_eq!(row(-7), first);
        assert_eq!(times([0, 2]), 4.0);
        assert_eq!(times([9, 9]), 1.0);
        let damaged = SampleDensity { cells: [3, 2], powers: vec![9] };
        assert_eq!([damaged.rate([10, 4], [0, 0]), damaged.rate([10, 4], [9, 3])].map(Rate::times), [4.0, 1.0]);
    }
}
