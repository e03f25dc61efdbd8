//! A ray prepared for boxes, and what boxes lead to.

use crate::math::Ray;

/// Children of a node.
pub const WIDTH: usize = 8;

/// A child: an inner node by its index, or a leaf by its first group of items and the number of its groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const FIRST_BITS: u32 = 28;
    /// Most groups of a leaf.
    pub const MAX_GROUPS: usize = 8;

    /// The inner node of this index.
    pub fn inner(index: usize) -> Self {
        Self(index as u32)
    }

    /// The leaf of some groups.
    pub fn leaf(first: usize, groups: usize) -> Self {
        assert!((1..=Self::MAX_GROUPS).contains(&groups) && first < 1 << Self::FIRST_BITS);
        Self(Self::LEAF | (groups as u32 - 1) << Self::FIRST_BITS | first as u32)
    }

    /// First group and number of groups of a leaf, or the index of an inner node.
    #[inline(always)]
    pub fn open(self) -> Result<(usize, usize), usize> {
        if self.0 & Self::LEAF == 0 {
            return Err(self.0 as usize);
        }
        let first = self.0 & ((1 << Self::FIRST_BITS) - 1);
        Ok((first as usize, (self.0 >> Self::FIRST_BITS & 7) as usize + 1))
    }
}

/// Stands for no item, where a group is not full.
pub const NO_ITEM: u32 = u32::MAX;

/// A ray in 32 bits, prepared so that no rounding makes it miss a box.
///
/// The distance to a plane b is (b - o) / d. For sides where the ray enters, o is rounded onward along the ray, and for
/// sides where it leaves, backward: then b - o is too small there and too large here. Its rounding, that of 1 / d and
/// that of the product are relative; three of u on each side and one of the factor are less than the 12 u by which the
/// far distance is enlarged (Ize 2013, *Robust BVH Ray Traversal*). Where 1 / d overflows, it is the largest number for
/// entering and infinite for leaving, which is again on the safe side.
pub struct Slabs {
    pub backward: [bool; 3],
    pub entry: [f32; 3],
    pub exit: [f32; 3],
    pub entry_inverse: [f32; 3],
    pub exit_inverse: [f32; 3],
}

/// 1 + 12 u.
const WIDEN: f32 = 1.0 + 6.0 * f32::EPSILON;

/// The number, or the largest there is: from a place that is not finite, the box of an absent child, at infinity, would
/// be entered.
#[inline(always)]
fn finite(number: f32) -> f32 {
    if number.abs() <= f32::MAX { number } else { f32::MAX.copysign(number) }
}

/// The largest 32-bit distance at which a box may begin that holds something at t or nearer.
#[inline(always)]
pub fn reach(t: f64) -> f32 {
    // The conversion rounds once.
    t as f32 * WIDEN
}

impl Slabs {
    #[inline(always)]
    pub fn new(ray: &Ray) -> Self {
        let (origin, direction) = (ray.origin.to_array(), ray.direction.to_array());
        let backward = direction.map(f64::is_sign_negative);
        let mut slabs =
            Self { backward, entry: [0.0; 3], exit: [0.0; 3], entry_inverse: [0.0; 3], exit_inverse: [0.0; 3] };
        for axis in 0..3 {
            let near = origin[axis] as f32;
            // The conversion is off by u at most, and so is the sum; below the normal numbers by less than the
            // smallest.
            let slack = near.abs() * (2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
            let sign = direction[axis] as f32;
            let onward = slack.copysign(sign);
            slabs.entry[axis] = finite(near + onward);
            slabs.exit[axis] = finite(near - onward);
            let inverse = direction[axis].recip().abs() as f32;
            let entry = inverse.clamp(f32::MIN_POSITIVE, f32::MAX);
            slabs.entry_inverse[axis] = entry.copysign(sign);
            slabs.exit_inverse[axis] = (inverse * WIDEN).max(f32::MIN_POSITIVE).copysign(sign);
        }
        slabs
    }
}
