//! A ray prepared for box tests, and the children that boxes stand for.

use crate::math::Ray;

/// Number of children of a node.
pub const WIDTH: usize = 8;

/// A child of a node: the index of an inner node, or a leaf as its first group of items and the number of its groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const FIRST_BITS: u32 = 28;
    /// Maximum number of groups in a leaf.
    pub const MAX_GROUPS: usize = 8;

    /// Creates the inner node with this index.
    pub fn inner(index: usize) -> Self {
        Self(index as u32)
    }

    /// Creates the leaf of some groups.
    pub fn leaf(first: usize, groups: usize) -> Self {
        assert!((1..=Self::MAX_GROUPS).contains(&groups) && first < 1 << Self::FIRST_BITS);
        Self(Self::LEAF | (groups as u32 - 1) << Self::FIRST_BITS | first as u32)
    }

    /// Returns the first group and the number of groups of a leaf, or as an error the index of an inner node.
    #[inline(always)]
    pub fn unpack(self) -> Result<(usize, usize), usize> {
        if self.0 & Self::LEAF == 0 {
            return Err(self.0 as usize);
        }
        let first = self.0 & ((1 << Self::FIRST_BITS) - 1);
        Ok((first as usize, (self.0 >> Self::FIRST_BITS & 7) as usize + 1))
    }
}

/// Stands for no item, in groups that are not full.
pub const NO_ITEM: u32 = u32::MAX;

/// A ray in 32-bit numbers, prepared so that no rounding makes it miss a box.
///
/// The distance to a plane b is (b - o) / d. For the sides where the ray enters, o is rounded forward along the ray.
/// For the sides where it leaves, o is rounded backward. So b - o is too small at entry and too large at exit. The
/// roundings of b - o, of 1 / d and of the product are relative. Three of u on each side and one of the factor are less
/// than the 12 u by which the far distance is enlarged (Ize 2013, *Robust BVH Ray Traversal*). If 1 / d overflows, it
/// becomes the largest number at entry and infinite at exit, which is conservative too.
#[derive(Clone, Copy, Debug)]
pub struct Slabs {
    pub backward: [bool; 3],
    pub entry: [f32; 3],
    pub exit: [f32; 3],
    pub entry_inverse: [f32; 3],
    pub exit_inverse: [f32; 3],
}

/// 1 + 12 u.
const WIDEN: f32 = 1.0 + 6.0 * f32::EPSILON;

/// Returns the number, limited to the finite range. With an origin that is not finite, the ray would enter the box of
/// an absent child, which is at infinity.
#[inline(always)]
fn clamped_to_finite(number: f32) -> f32 {
    if number.abs() <= f32::MAX { number } else { f32::MAX.copysign(number) }
}

/// Returns the largest 32-bit distance at which a box may begin that contains something at t or nearer.
#[inline(always)]
pub fn box_limit(t: f64) -> f32 {
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
            let rounded = origin[axis] as f32;
            // The conversion has an error of at most u, and so has the sum. Below the normal range, the error is less
            // than the smallest normal number.
            let slack = rounded.abs() * (2.0 * f32::EPSILON) + f32::MIN_POSITIVE;
            let sign = direction[axis] as f32;
            let onward = slack.copysign(sign);
            slabs.entry[axis] = clamped_to_finite(rounded + onward);
            slabs.exit[axis] = clamped_to_finite(rounded - onward);
            let inverse = direction[axis].recip().abs() as f32;
            let entry = inverse.clamp(f32::MIN_POSITIVE, f32::MAX);
            slabs.entry_inverse[axis] = entry.copysign(sign);
            slabs.exit_inverse[axis] = (inverse * WIDEN).max(f32::MIN_POSITIVE).copysign(sign);
        }
        slabs
    }
}
