use std::ops::{Add, AddAssign, Index, Mul};

/// N numbers that travel together. Arithmetic is lane by lane, and lanes have no meaning here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Lanes<const N: usize>(pub [f32; N]);

/// A subset of up to 32 lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LaneSet(u32);

impl LaneSet {
    /// Returns the lanes in their order.
    #[inline(always)]
    pub fn iter(self) -> impl Iterator<Item = usize> {
        let mut remaining = self.0;
        std::iter::from_fn(move || {
            let next = remaining.trailing_zeros() as usize;
            remaining &= remaining.wrapping_sub(1);
            (next < 32).then_some(next)
        })
    }

    /// Returns the only lane; `None` if there are several or none.
    #[inline(always)]
    pub fn single_lane(self) -> Option<usize> {
        self.0.is_power_of_two().then(|| self.0.trailing_zeros() as usize)
    }
}

impl<const N: usize> Lanes<N> {
    /// All lanes 0.
    pub const ZERO: Self = Self([0.0; N]);
    /// All lanes 1.
    pub const ONE: Self = Self([1.0; N]);

    /// Creates lanes in which lane `i` holds `value(i)`.
    #[inline]
    pub fn from_fn(mut value: impl FnMut(usize) -> f32) -> Self {
        let mut lanes = Self::ZERO;
        for (i, lane) in lanes.0.iter_mut().enumerate() {
            *lane = value(i);
        }
        lanes
    }

    /// Returns the sum over the lanes, in a fixed order.
    pub fn sum(&self) -> f32 {
        self.0.iter().sum()
    }

    /// Returns the lanes that are not 0.
    #[inline(always)]
    pub fn nonzero(&self) -> LaneSet {
        const { assert!(N <= 32) };
        LaneSet((0..N).rev().fold(0, |bits, i| bits << 1 | u32::from(self.0[i] != 0.0)))
    }

    /// Returns 1 in the given lanes, and 0 in the others.
    pub fn mask_of(lanes: LaneSet) -> Self {
        Self::from_fn(|i| (lanes.0 >> i & 1) as f32)
    }

    /// Returns whether every lane is 0.
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
