//! Random numbers as a pure function of seed, pixel, sample, branch and use.

use std::sync::LazyLock;

use sobol_burley::parts::{hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_rev};

/// The position of a path vertex in the tree of branches of its camera sample.
///
/// Two vertices of one tree never share a key. Vertices reached by the same choices in different samples of a pixel do
/// share it, so that their random numbers are well distributed over the samples of the pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BranchKey(u64);

impl BranchKey {
    /// The key of the camera itself: film position and lens.
    pub const CAMERA: Self = Self(0);

    /// Returns the key of the `index`-th branch from here.
    #[must_use]
    pub fn child(self, index: usize) -> Self {
        Self(mix_bits(self.0 ^ (index as u64 + 1)))
    }
}

/// The random numbers of one camera sample.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    pixel: u64,
    index: u32,
}

impl Sampler {
    /// Creates the sampler of one sample of one pixel under a seed. Columns and rows may be negative, as in the
    /// overscan.
    pub fn of_pixel(seed: u64, pixel: [i32; 2], sample: u32) -> Self {
        // The bits of a negative number are those of a positive one beyond any image.
        Self::new(seed, pixel.map(|place| place as u32), sample)
    }

    /// Creates the sampler of one sample, under a seed, of anything that is identified by two numbers.
    pub fn new(seed: u64, key: [u32; 2], sample: u32) -> Self {
        let place = (u64::from(key[1]) << 32) | u64::from(key[0]);
        Self { pixel: mix_bits(mix_bits(seed) ^ place), index: sample }
    }

    /// Returns four numbers in [0, 1) for one use (`purpose`) at one vertex.
    ///
    /// They are Owen-scrambled Sobol points in four dimensions, padded by an independent scramble and shuffle for each
    /// use.
    /// Burley 2020, *Practical Hash-based Owen Scrambling*.
    pub fn get_4d(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = self.seed(branch, purpose);
        sobol(self.index, 0, [seed; 2])
    }

    /// Returns four more numbers for the same use at the same vertex. Together with those of [`get_4d`](Self::get_4d)
    /// they are points in eight dimensions.
    pub fn get_more_4d(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = self.seed(branch, purpose);
        sobol(self.index, 1, [seed; 2])
    }

    /// Returns two pairs of numbers in [0, 1) for one use at one vertex. Among the samples whose first two numbers for
    /// the camera's use `first` fall into the same part of the square, each pair is evenly distributed. This holds
    /// within each block of 65,536 samples. Different blocks are independent.
    pub fn conditional_pairs(&self, first: u32, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let scramble = self.seed(branch, purpose).wrapping_add((self.index >> 16).wrapping_mul(0x9e37_79b9));
        sobol(self.index, PAIRED_SET, [self.seed(BranchKey::CAMERA, first), scramble])
    }

    fn seed(&self, branch: BranchKey, purpose: u32) -> u32 {
        (mix_bits(self.pixel ^ branch.0.wrapping_add(u64::from(purpose))) >> 32) as u32
    }

    /// Returns four numbers in [0, 1) for one use at one vertex, independent from sample to sample.
    pub fn get_random_4d(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let sample = mix_bits(self.pixel ^ u64::from(self.index).wrapping_mul(0xd134_2543_de82_ef95));
        let a = mix_bits(sample ^ branch.0.wrapping_add(u64::from(purpose)));
        let b = mix_bits(a);
        let unit = |x: u64| f64::from(x as u32) * (1.0 / 4_294_967_296.0);
        [unit(a), unit(a >> 32), unit(b), unit(b >> 32)]
    }
}

/// Returns the seed of one of several statistically independent renders of the same image.
pub fn derive_seed(seed: u64, number: u64) -> u64 {
    mix_bits(mix_bits(seed) ^ number.wrapping_add(1))
}

/// Returns four dimensions of a Sobol point, shuffled by one seed and scrambled by another. In the first two sets, with
/// both seeds equal, these are the numbers of `sobol_burley::sample_4d` up to an index of 65,535. Beyond, the same
/// sequence goes on.
fn sobol(index: u32, set: usize, [shuffle, scramble]: [u32; 2]) -> [f64; 4] {
    let shuffle = hash(shuffle ^ 0x79c6_8e4a);
    let shuffled = owen_scramble_rev(index.reverse_bits(), shuffle);
    let point_of = |table: &[[[u32; 4]; 16]; 4], bits: u32| -> [u32; 4] {
        let digit = |i: usize| table[i][(bits >> (28 - 4 * i)) as usize & 15];
        let [a, b, c, d] = [digit(0), digit(1), digit(2), digit(3)];
        std::array::from_fn(|i| (a[i] ^ b[i]) ^ (c[i] ^ d[i]))
    };
    let mut point = point_of(&SOBOL[set], shuffled);
    if index >> 16 != 0 && set != PAIRED_SET {
        let upper = point_of(&SOBOL_UPPER[set], (shuffled ^ owen_scramble_rev(0, shuffle)) << 16);
        point = std::array::from_fn(|i| point[i] ^ upper[i]);
    }
    let seed = scramble.wrapping_mul(0x9c8f_2d3b) ^ set as u32;
    let scramble = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].map(|x: u32| x ^ seed);
    owen_scramble_int4_rev(point.into(), hash_int4(scramble.into())).reverse_bits().to_f32_norm().map(f64::from)
}

/// Index of the set of four dimensions that holds the two pairs beside the first pair.
const PAIRED_SET: usize = 2;
/// Each pair beside the first is the first pair at another index, whose digits come from these dimensions. So each is
/// as even as the first, a (0, 2)-sequence. Of all dimensions, these leave the fewest uneven boxes in sets of 4 to 256
/// samples: the boxes that the first pair makes with the second, then those that these two make with the third.
const PAIR_DIMENSIONS: [u32; 2] = [156, 234];

/// For three sets of four dimensions, the point of each of the four hexadecimal digits of an index, with bits reversed.
/// The sequence is linear: the point of an index is the bitwise sum of its digits' points.
static SOBOL: LazyLock<[[[[u32; 4]; 16]; 4]; 3]> = LazyLock::new(|| {
    let point = |set: usize, i: usize, digit: usize| {
        let index = (digit as u32) << (28 - 4 * i);
        if set != PAIRED_SET {
            return std::array::from_fn(|dimension| sobol_rev(index, (4 * set + dimension) as u32));
        }
        std::array::from_fn(|dimension| {
            let index = sobol_rev(index, PAIR_DIMENSIONS[dimension / 2]).reverse_bits();
            sobol_rev(index, (dimension % 2) as u32)
        })
    };
    std::array::from_fn(|set| std::array::from_fn(|i| std::array::from_fn(|digit| point(set, i, digit))))
});

/// For the first two sets of four dimensions, the points of the hexadecimal digits in the upper half of an index, with
/// bits reversed. [`SOBOL`] has those of the lower half.
static SOBOL_UPPER: LazyLock<[[[[u32; 4]; 16]; 4]; 2]> = LazyLock::new(|| {
    let direction_numbers: Vec<[u32; 32]> = (0..8).map(direction_numbers).collect();
    let point = |set: usize, i: usize, digit: usize| {
        std::array::from_fn(|dimension| {
            let direction_number = |bit: usize| direction_numbers[4 * set + dimension][16 + 4 * i + bit].reverse_bits();
            (0..4).filter(|bit| digit >> (3 - bit) & 1 == 1).fold(0, |point, bit| point ^ direction_number(bit))
        })
    };
    std::array::from_fn(|set| std::array::from_fn(|i| std::array::from_fn(|digit| point(set, i, digit))))
});

/// The primitive polynomials of the dimensions after the first, up to the eighth, as degrees and inner coefficients.
///
/// Joe & Kuo 2008, *Constructing Sobol Sequences with Better Two-Dimensional Projections*.
const POLYNOMIALS: [(usize, u32); 7] = [(1, 0), (2, 1), (3, 1), (3, 2), (4, 1), (4, 4), (5, 2)];

/// Returns the direction numbers of one of the first eight dimensions, 32 bits each. `sobol_burley` has the first 16.
/// The recurrence of the dimension's polynomial gives the others.
fn direction_numbers(dimension: usize) -> [u32; 32] {
    let mut direction_numbers = [0; 32];
    for i in 0..32 {
        direction_numbers[i] = match dimension.checked_sub(1).map(|dimension| POLYNOMIALS[dimension]) {
            None => 1 << (31 - i),
            Some(_) if i < 16 => sobol_rev(1 << (31 - i), dimension as u32).reverse_bits(),
            Some((degree, inner)) => next_direction_number(&direction_numbers[..i], degree, inner),
        };
    }
    direction_numbers
}

/// Returns the direction number that follows the given ones of a dimension.
fn next_direction_number(direction_numbers: &[u32], degree: usize, inner: u32) -> u32 {
    let before = |j: usize| direction_numbers[direction_numbers.len() - j];
    let is_in = |j: &usize| inner >> (degree - 1 - j) & 1 == 1;
    (1..degree).filter(is_in).fold(before(degree) ^ (before(degree) >> degree), |sum, j| sum ^ before(j))
}

/// Maps 64 bits to 64 bits by a bijection that spreads every input bit over all output bits.
///
/// Steele, Lea & Flood 2014, *Fast Splittable Pseudorandom Number Generators* (mix64, variant 13 of Stafford).
pub fn mix_bits(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_plain_sequence() {
        for i in 0..20_000_u32 {
            let (index, seed) = (i.wrapping_mul(0x9e37_79b1) >> 16, mix_bits(u64::from(i)) as u32);
            for dimensions in 0..2 {
                let plain = sobol_burley::sample_4d(index, dimensions, seed).map(f64::from);
                assert_eq!(sobol(index, dimensions as usize, [seed; 2]), plain, "{index} {seed}");
            }
        }
    }

    #[test]
    fn polynomials_are_those_of_the_dimensions() {
        for dimension in 1..8 {
            let ((degree, inner), known) = (POLYNOMIALS[dimension - 1], direction_numbers(dimension));
            for i in degree..16 {
                assert_eq!(next_direction_number(&known[..i], degree, inner), known[i], "{dimension} {i}");
            }
        }
    }

    #[test]
    fn long_sequences_stay_even() {
        let m = 18;
        // The second block of this length, from 262,144 to 524,287.
        let points: Vec<[[f64; 4]; 2]> = (1 << m..2 << m)
            .map(|i| Sampler::new(3, [5, 7], i))
            .map(|sampler| [sampler.get_4d(BranchKey::CAMERA, 2), sampler.get_more_4d(BranchKey::CAMERA, 2)])
            .collect();
        let pairs: Vec<[f64; 2]> = points.iter().map(|[first, _]| [first[0], first[1]]).collect();
        assert_eq!(share_of_even_shapes(&pairs, m), 1.0);
        for dimension in 0..8 {
            let numbers: Vec<[f64; 1]> = points.iter().map(|sets| [sets[dimension / 4][dimension % 4]]).collect();
            assert_eq!(share_of_even_shapes(&numbers, m), 1.0, "{dimension}");
        }
        // Boxes of 64 points each in three dimensions. Independent points would have a standard deviation of 8.
        let mut counts = vec![0_u32; 1 << 12];
        for [first, _] in &points {
            let [x, y, z] = [first[0], first[1], first[2]].map(|u| (16.0 * u) as usize);
            counts[(16 * x + y) * 16 + z] += 1;
        }
        let variance = counts.iter().map(|&count| (f64::from(count) - 64.0).powi(2)).sum::<f64>() / counts.len() as f64;
        assert!(variance < 1.0, "{variance}");
    }

    /// Returns all shapes of 2^m boxes of the same volume, as the number of times that each axis is halved.
    fn shapes<const D: usize>(m: u32) -> Vec<[u32; D]> {
        let sums_to_m = |halved: &[u32; D]| halved.iter().sum::<u32>() == m;
        let digits = |number: u32| std::array::from_fn(|axis| number / (m + 1).pow(axis as u32) % (m + 1));
        (0..(m + 1).pow(D as u32)).map(digits).filter(sums_to_m).collect()
    }

    /// Returns the mean number of points per box that is not empty, for 2^m points of 32 bits.
    fn points_per_box<const D: usize>(points: &[[u32; D]], halved: &[u32; D]) -> f64 {
        let mut is_filled = vec![false; points.len()];
        for point in points {
            let digits = |axis: usize| if halved[axis] == 0 { 0 } else { point[axis] >> (32 - halved[axis]) };
            is_filled[(0..D).fold(0, |number, axis| (number << halved[axis]) | digits(axis) as usize)] = true;
        }
        points.len() as f64 / is_filled.iter().filter(|filled| **filled).count() as f64
    }

    fn share_of_even_shapes<const D: usize>(points: &[[f64; D]], m: u32) -> f64 {
        let points: Vec<_> = points.iter().map(|point| point.map(|x| (x * 4_294_967_296.0) as u32)).collect();
        let shapes = shapes::<D>(m);
        shapes.iter().filter(|halved| points_per_box(&points, halved) == 1.0).count() as f64 / shapes.len() as f64
    }

    #[test]
    fn conditional_pairs_are_even_overall_and_in_parts_of_the_first_square() {
        let key = BranchKey::CAMERA;
        for (m, start) in (2..=8_u32).flat_map(|m| [(m, 0), (m, 5 << 16)]) {
            let samples = |points: &dyn Fn(Sampler) -> [f64; 4]| {
                (start..start + (1 << m)).map(|i| points(Sampler::of_pixel(3, [5, 7], i))).collect::<Vec<_>>()
            };
            let beside = |pair: usize| {
                samples(&|sampler| {
                    let (place, ways) = (sampler.get_4d(key, 0), sampler.conditional_pairs(0, key, 1));
                    [place[0], place[1], ways[2 * pair], ways[2 * pair + 1]]
                })
            };
            let independent = samples(&|sampler| {
                let (place, ways) = (sampler.get_4d(key, 0), sampler.get_4d(key, 1));
                [place[0], place[1], ways[0], ways[1]]
            });
            for pair in 0..2 {
                let points = beside(pair);
                let ways: Vec<[f64; 2]> = points.iter().map(|point| [point[2], point[3]]).collect();
                assert_eq!(share_of_even_shapes(&ways, m), 1.0, "{m}");
                let [with, without] = [&points, &independent].map(|points| share_of_even_shapes(points, m));
                println!(
                    "2^{m} samples, pair {pair}: {with:.2} of the shapes are even; {without:.2} of independent pairs"
                );
                assert!(with > 0.5 && (m < 4 || with > without + 0.2), "{m} {pair}: {with} {without}");
            }
        }
    }

    /// The search that found [`PAIR_DIMENSIONS`].
    #[test]
    fn no_other_dimensions_leave_fewer_boxes_uneven() {
        let pair = |index: u32| [0, 1].map(|dimension| sobol_rev(index.reverse_bits(), dimension).reverse_bits());
        let at = |dimension: u32, index: u32| pair(sobol_rev(index.reverse_bits(), dimension));
        let shapes: Vec<Vec<[u32; 4]>> = (2..=8).map(shapes).collect();
        // Boxes weigh less, the more elongated they are within a pair. They count more, the more points share one.
        let weight = |[a, b, c, d]: [u32; 4]| {
            0.5_f64.powi((a.abs_diff(b).max(1) - 1) as i32 + (c.abs_diff(d).max(1) - 1) as i32)
        };
        let uneven = |first: u32, second: u32| -> f64 {
            let unevenness = |shapes: &Vec<[u32; 4]>| {
                let m = shapes[0].iter().sum::<u32>();
                let points: Vec<_> = (0..1 << m)
                    .map(|index| {
                        let ([a, b], [c, d]) = (at(first, index), at(second, index));
                        [a, b, c, d]
                    })
                    .collect();
                let sum: f64 =
                    shapes.iter().map(|halved| weight(*halved) * (points_per_box(&points, halved) - 1.0)).sum();
                sum / shapes.iter().map(|halved| weight(*halved)).sum::<f64>()
            };
            shapes.iter().map(unevenness).sum()
        };
        let best_dimension =
            |of: &dyn Fn(u32) -> f64| (2..256).min_by(|a, b| of(*a).total_cmp(&of(*b))).expect("dimensions");
        let beside: Vec<f64> = (0..256).map(|dimension| uneven(0, dimension.max(1))).collect();
        let first = best_dimension(&|dimension| beside[dimension as usize]);
        let both: Vec<f64> = (0..256).map(|i| beside[i as usize] + uneven(first, i.max(1))).collect();
        assert_eq!([first, best_dimension(&|dimension| both[dimension as usize])], PAIR_DIMENSIONS);
    }
}
