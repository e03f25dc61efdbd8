//! Random numbers as a pure function of seed, pixel, sample, branch and use.

use sobol_burley::sample_4d;

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
    /// The numbers of one sample of one pixel under a seed.
    pub fn new(seed: u64, pixel: [u32; 2], sample: u32) -> Self {
        let place = (u64::from(pixel[1]) << 32) | u64::from(pixel[0]);
        let pixel = mix(mix(seed) ^ place).wrapping_add(u64::from(sample / SEQUENCE));
        Self { pixel, index: sample % SEQUENCE }
    }

    /// Four numbers in [0, 1) for one use (`purpose`) at one vertex.
    ///
    /// Owen-scrambled Sobol points in four dimensions, padded by an independent scramble and shuffle for each use.
    /// Burley 2020, *Practical Hash-based Owen Scrambling*.
    pub fn four(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = mix(self.pixel ^ branch.0.wrapping_add(u64::from(purpose)));
        sample_4d(self.index, 0, (seed >> 32) as u32).map(f64::from)
    }

    /// Four more numbers for the same use at the same vertex: with those of [`four`](Self::four), points in eight
    /// dimensions.
    pub fn four_more(&self, branch: BranchKey, purpose: u32) -> [f64; 4] {
        let seed = mix(self.pixel ^ branch.0.wrapping_add(u64::from(purpose)));
        sample_4d(self.index, 1, (seed >> 32) as u32).map(f64::from)
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

/// A bijection of 64 bits that spreads every input bit over all output bits.
///
/// Steele, Lea & Flood 2014, *Fast Splittable Pseudorandom Number Generators* (mix64, variant 13 of Stafford).
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
