use std::ops::{Add, AddAssign, Index, Mul};

/// N numbers that travel together; arithmetic is lane by lane, and no lane has a meaning here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Lanes<const N: usize>(pub [f32; N]);

/// One bit for each lane. Read from a table, bits of four lanes are made at a time.
const BITS: [u32; 32] = {
    let (mut bits, mut i) = ([0; 32], 0);
    while i < 32 {
        bits[i] = 1 << i;
        i += 1;
    }
    bits
};

impl<const N: usize> Lanes<N> {
    /// All lanes 0.
    pub const ZERO: Self = Self([0.0; N]);
    /// All lanes 1.
    pub const ONE: Self = Self([1.0; N]);

    /// Lane `i` holds `value(i)`.
    #[inline]
    pub fn from_fn(mut value: impl FnMut(usize) -> f32) -> Self {
        let mut lanes = Self::ZERO;
        for (i, lane) in lanes.0.iter_mut().enumerate() {
            *lane = value(i);
        }
        lanes
    }

    /// The sum over the lanes, in a fixed order.
    pub fn sum(&self) -> f32 {
        self.0.iter().sum()
    }

    /// The lanes that are not 0, in their order.
    #[inline(always)]
    pub fn present(&self) -> impl Iterator<Item = usize> + use<N> {
        const { assert!(N <= 32) };
        let mut left = (0..N).fold(0, |bits, i| bits | if self.0[i] != 0.0 { BITS[i] } else { 0 });
        std::iter::from_fn(move || {
            let next = left.trailing_zeros() as usize;
            left &= left.wrapping_sub(1);
            (next < 32).then_some(next)
        })
    }

    /// Whether every lane is 0.
    pub fn is_zero(&self) -> bool {
        self.0.iter().all(|&x| x == 0.0)
    }
}

impl<const N: usize> Index<usize> for Lanes<N> {
    type Output = f32;
    fn index(&self, lane: usize) -> &f32 {
        &self.0[lane]
    }
}

impl<const N: usize> Add for Lanes<N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::from_fn(|i| self.0[i] + other.0[i])
    }
}

impl<const N: usize> AddAssign for Lanes<N> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Mul for Lanes<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::from_fn(|i| self.0[i] * other.0[i])
    }
}

impl<const N: usize> Mul<f32> for Lanes<N> {
    type Output = Self;
    fn mul(self, factor: f32) -> Self {
        Self::from_fn(|i| self.0[i] * factor)
    }
}
