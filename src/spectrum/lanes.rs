use std::ops::{Add, AddAssign, Index, Mul};

/// N numbers that travel together; arithmetic is lane by lane, and no lane has a meaning here.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(16))]
pub struct Lanes<const N: usize>(pub [f32; N]);

impl<const N: usize> Lanes<N> {
    /// All lanes 0.
    pub const ZERO: Self = Self([0.0; N]);
    /// All lanes 1.
    pub const ONE: Self = Self([1.0; N]);

    /// Lane `i` holds `value(i)`.
    pub fn from_fn(value: impl FnMut(usize) -> f32) -> Self {
        Self(std::array::from_fn(value))
    }

    /// The sum over the lanes, in a fixed order.
    pub fn sum(&self) -> f32 {
        self.0.iter().sum()
    }

    /// Whether every lane is 0.
    pub fn is_zero(&self) -> bool {
        self.0.iter().all(|&x| x == 0.0)
    }

    /// The lanes for which `keep` holds; the others are 0.
    pub fn filter(self, keep: impl Fn(usize) -> bool) -> Self {
        Self::from_fn(|i| if keep(i) { self.0[i] } else { 0.0 })
    }

    /// The groups of lanes that are not 0 and share a key, each with its key; lanes outside a group are 0 in it.
    ///
    /// Groups come in the order of their first lanes. Plain glass has one group, dispersive glass several.
    pub fn groups_by<K: PartialEq + Copy>(self, keys: [K; N]) -> impl Iterator<Item = (K, Self)> {
        let mut rest = self;
        std::iter::from_fn(move || {
            let key = keys[rest.0.iter().position(|&x| x != 0.0)?];
            let group = rest.filter(|i| keys[i] == key);
            rest = rest.filter(|i| keys[i] != key);
            Some((key, group))
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_take_lanes_of_equal_key_and_leave_out_empty_lanes() {
        let lanes = Lanes([1.0, 2.0, 3.0, 0.0]);
        let groups: Vec<_> = lanes.groups_by([1.5, 1.6, 1.5, 1.7]).collect();
        assert_eq!(groups, [(1.5, Lanes([1.0, 0.0, 3.0, 0.0])), (1.6, Lanes([0.0, 2.0, 0.0, 0.0]))]);
        assert_eq!(Lanes([0.0; 4]).groups_by([1; 4]).count(), 0);
    }
}
