//! Nodes with eight children, and the test of a ray against eight boxes at once.

use std::ops::Range;

use super::slabs::{Child, Slabs, WIDTH};
use super::vectors::{Keys, Vectors};
use crate::math::Bounds;

/// Eight boxes side by side, in four cache lines. Absent children have boxes that no ray meets.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Node {
    min: [[f32; WIDTH]; 3],
    max: [[f32; WIDTH]; 3],
    pub children: [Child; WIDTH],
}

/// A box in 32-bit numbers that contains a box in 64-bit numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OuterBox {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl OuterBox {
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    pub fn from_bounds(bounds: &Bounds) -> Self {
        Self { min: bounds.min.to_array().map(round_down), max: bounds.max.to_array().map(round_up) }
    }

    pub fn union(self, other: Self) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis].min(other.min[axis])),
            max: std::array::from_fn(|axis| self.max[axis].max(other.max[axis])),
        }
    }

    /// Returns twice the center along an axis, in 64 bits so that it does not overflow.
    pub fn twice_center(&self, axis: usize) -> f64 {
        f64::from(self.min[axis]) + f64::from(self.max[axis])
    }

    /// Returns half the surface area.
    pub fn half_area(&self) -> f64 {
        let [x, y, z] = std::array::from_fn(|axis| f64::from(self.max[axis]) - f64::from(self.min[axis]));
        x * y + y * z + z * x
    }
}

impl Node {
    pub const EMPTY: Self =
        Self { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3], children: [Child(0); WIDTH] };

    pub fn set(&mut self, slot: usize, outer: &OuterBox, child: Child) {
        for axis in 0..3 {
            self.min[axis][slot] = outer.min[axis];
            self.max[axis][slot] = outer.max[axis];
        }
        self.children[slot] = child;
    }

    /// Returns the children that are present.
    pub fn present_children(&self) -> impl Iterator<Item = Child> + '_ {
        (0..WIDTH).filter(|&slot| self.min[0][slot] <= self.max[0][slot]).map(|slot| self.children[slot])
    }

    /// Returns a bit for each child whose box the ray may enter before `reach`, and the keys of all children.
    ///
    /// Comparisons ignore the NaN of 0 * infinity, which occurs for a ray within the plane of a side.
    #[inline(always)]
    pub fn enter(&self, vectors: impl Vectors, slabs: &Slabs, reach: f32) -> (u32, Keys) {
        let side = |axis: usize, max: bool| if max { &self.max[axis] } else { &self.min[axis] };
        let [x, y, z] = slabs.backward;
        let first = [side(0, x), side(1, y), side(2, z)];
        let last = [side(0, !x), side(1, !y), side(2, !z)];
        vectors.enter(first, last, &self.children, slabs, reach)
    }
}

/// Returns the largest f32 that is not above x.
fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

/// Returns the smallest f32 that is not below x.
fn round_up(x: f64) -> f32 {
    -round_down(-x)
}

/// A node of a binary tree.
#[derive(Clone, Copy)]
pub struct Pair {
    pub outer: OuterBox,
    /// Index of the first of two neighboring nodes, or the start of a range of `Builder::order`.
    pub first: u32,
    /// Number of items in a leaf, 0 for an inner node.
    pub count: u32,
}

impl Pair {
    pub fn leaf(range: &Range<usize>) -> Self {
        Self { outer: OuterBox::EMPTY, first: range.start as u32, count: range.len() as u32 }
    }

    pub fn inner(first: usize) -> Self {
        Self { outer: OuterBox::EMPTY, first: first as u32, count: 0 }
    }
}
