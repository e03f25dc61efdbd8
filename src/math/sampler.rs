//! Random numbers as a pure function of seed, pixel, sample, branch and use.

use std::sync::LazyLock;

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev, sobol_int4_rev};

/// Samples after which the Sobol sequence is continued under another scramble.
const SEQUENCE: u32 = 1 << 16;

/// The place of a ray vertex in its camera sample's tree of branches.
///
/// Two vertices of one tree never share a key, and the vertices reached by the same choices in other samples of the
/// pixel do: so their numbers are well spread over the pixel's samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BranchKey(u64);

impl BranchKey {
    /// The camera's own: film position and lens.
    pub const CAMERA: Self = Self(0);

    /// The key of the `index`-th way on from here.
    pub fn child(self, index: usize) -> Self {
        Self(mix(self.0 ^ (index as u64 + 1)))
    }
}

/// The random numbers of one camera sample.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    pixel: u64,
    index: u32,
}

impl Sampler {
    /// The numbers of one sample of one pixel under a seed. Columns and rows may be negative, as in the overscan.
    pub fn of_pixel(seed: u64, pixel: [i32; 2], sample: u32) -> Self {
        // The bits of a negative number are those of a positive one that no image has.
        Self::new(seed, pixel.map(|place| place as u32), sample)
    }

    /// The numbers of one sample of anything that two numbers tell from all others, under a seed.
    pub fn new(seed: u64, key: [u32; 2], sample: u32) -> Self {
        let place = (u64::from(key[1]) << 32) | u64::from(key[0]);
        let pixel = mix(mix(seed) ^ place).wrapping_add(u64::from(sample / SEQUENCE));
        Self { pixel, index: sample % SEQUENCE }
    }

    /// Four numbers in [0, 1) for one use (`purpose`) at one vertex.
    ///
    /// Owen-scrambled Sobol points in four dimensions, padded by an independent scramble and shuffle for each use.
    /// Burley 2020, *Practical Hash-based Owen Scrambling*.
    pub fn four(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = mix(self.pixel ^ branch.0.wrapping_add(u64::from(purpose)));
        sobol(self.index, 0, (seed >> 32) as u32)
    }

    /// Four more numbers for the same use at the same vertex: with those of [`four`](Self::four), points in eight
    /// dimensions.
    pub fn four_more(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = mix(self.pixel ^ branch.0.wrapping_add(u64::from(purpose)));
        sobol(self.index, 1, (seed >> 32) as u32)
    }

    /// Four numbers in [0, 1) for one use at one vertex, independent from sample to sample.
    pub fn four_plain(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let sample = mix(self.pixel ^ u64::from(self.index).wrapping_mul(0xd134_2543_de82_ef95));
        let a = mix(sample ^ branch.0.wrapping_add(u64::from(purpose)));
        let b = mix(a);
        let unit = |x: u64| f64::from(x as u32) * (1.0 / 4_294_967_296.0);
        [unit(a), unit(a >> 32), unit(b), unit(b >> 32)]
    }
}

/// The seed of one of several renders of the same image that shall know nothing of each other.
pub fn seed_of(seed: u64, number: u64) -> u64 {
    mix(mix(seed) ^ number.wrapping_add(1))
}

/// Four dimensions of a shuffled and scrambled point, the numbers of `sobol_burley::sample_4d`.
fn sobol(index: u32, dimensions: usize, seed: u32) -> [f64; 4] {
    let shuffled = owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a));
    let digit = |i: usize| SOBOL[dimensions][i][(shuffled >> (28 - 4 * i)) as usize & 15];
    let [a, b, c, d] = [digit(0), digit(1), digit(2), digit(3)];
    let point: [u32; 4] = std::array::from_fn(|i| (a[i] ^ b[i]) ^ (c[i] ^ d[i]));
    let seed = seed.wrapping_mul(0x9c8f_2d3b) ^ dimensions as u32;
    let scramble = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].map(|x: u32| x ^ seed);
    owen_scramble_int4_rev(point.into(), hash_int4(scramble.into())).reverse_bits().to_f32_norm().map(f64::from)
}

/// Of two sets of four dimensions, the points of each of the four hexadecimal digits of an index, bits reversed. The
/// sequence is linear: an index has the sum of its digits' points, bit by bit.
static SOBOL: LazyLock<[[[[u32; 4]; 16]; 4]; 2]> = LazyLock::new(|| {
    let point =
        |set: usize, i: usize, digit: usize| Int4::into(sobol_int4_rev((digit as u32) << (28 - 4 * i), set as u32));
    std::array::from_fn(|set| std::array::from_fn(|i| std::array::from_fn(|digit| point(set, i, digit))))
});

/// A bijection of 64 bits that spreads every input bit over all output bits.
///
/// Steele, Lea & Flood 2014, *Fast Splittable Pseudorandom Number Generators* (mix64, variant 13 of Stafford).
fn mix(x: u64) -> u64 {
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
            let (index, seed) = (i.wrapping_mul(0x9e37_79b1) >> 16, mix(u64::from(i)) as u32);
            for dimensions in 0..2 {
                let plain = sobol_burley::sample_4d(index, dimensions, seed).map(f64::from);
                assert_eq!(sobol(index, dimensions as usize, seed), plain, "{index} {seed}");
            }
        }
    }
}
