//! Random numbers that are the same on every machine.

use abbe::math::{DVec3, sample_sphere};

/// A stream of independent random numbers.
///
/// Steele, Lea & Flood 2014, *Fast Splittable Pseudorandom Number Generators* (SplitMix64).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95))
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// Returns a uniform number in [0, 1).
    pub fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a uniform point in the unit square.
    pub fn pair(&mut self) -> [f64; 2] {
        [self.number(), self.number()]
    }

    /// Returns a uniform number between two others.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.number()
    }

    /// Returns a damaged copy of a file. By turns it is truncated, has one byte changed near its beginning, or has four
    /// bits flipped.
    pub fn damaged(&mut self, whole: &[u8], turn: usize) -> Vec<u8> {
        let mut bytes = whole.to_vec();
        let mut random_below = |most: usize| (self.number() * most as f64) as usize;
        match turn % 3 {
            0 => bytes.truncate(random_below(whole.len())),
            1 => {
                let at = random_below(whole.len().min(600));
                bytes[at] = random_below(256) as u8;
            }
            _ => (0..4).for_each(|_| {
                let at = random_below(whole.len());
                bytes[at] ^= 1 << random_below(8);
            }),
        }
        bytes
    }

    /// Returns a uniform unit vector.
    pub fn direction(&mut self) -> DVec3 {
        sample_sphere(self.pair())
    }
}
