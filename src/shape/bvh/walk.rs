//! The walk of a ray through the tree.

use super::node::Node;
use super::slabs::{Child, Slabs, box_limit};
use super::stack::{Stack, StackMemory};
use super::vectors::{Computation, Vectors, prefetch};
use crate::math::Ray;

/// What a walk does in a leaf.
pub trait Visitor {
    /// Visits some groups of items. Returns the new `t_max`, or `None` to end the walk.
    fn visit(&mut self, first: usize, groups: usize, t_max: f64) -> Option<f64>;
}

/// What a walk does in a leaf with vector instructions.
pub trait VectorVisitor {
    /// Visits some groups of items. Returns the new `t_max`, or `None` to end the walk.
    ///
    /// Implementations are `#[inline(always)]`.
    fn visit(&mut self, vectors: impl Vectors, first: usize, groups: usize, t_max: f64) -> Option<f64>;

    /// Prefetches a group that will be visited soon.
    #[inline(always)]
    fn prefetch(&self, _group: usize) {}
}

impl<T: Visitor> VectorVisitor for T {
    #[inline(always)]
    fn visit(&mut self, _: impl Vectors, first: usize, groups: usize, t_max: f64) -> Option<f64> {
        Visitor::visit(self, first, groups, t_max)
    }
}

/// A walk through the tree, which visits nearer boxes first if `ORDERED`, and boxes in any order otherwise.
pub struct Walk<'a, const ORDERED: bool, T> {
    pub root: Option<Child>,
    pub nodes: &'a [Node],
    pub ray: &'a Ray,
    pub t_max: f64,
    pub visitor: &'a mut T,
}

impl<const ORDERED: bool, T: VectorVisitor> Computation for Walk<'_, ORDERED, T> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(mut self, vectors: V) {
        let Some(root) = self.root else { return };
        let slabs = Slabs::new(self.ray);
        let mut limit = box_limit(self.t_max);
        // Children to visit, each with the distance at which its box begins.
        let mut memory = StackMemory::new();
        let mut stack = Stack::new(&mut memory);
        let mut current = root;
        loop {
            match current.unpack() {
                Ok((first, groups)) => match self.visitor.visit(vectors, first, groups, self.t_max) {
                    Some(t_max) => {
                        self.t_max = t_max;
                        limit = box_limit(t_max);
                    }
                    None => return,
                },
                Err(index) => {
                    let node = &self.nodes[index];
                    let (mut entered, keys) = node.enter(vectors, &slabs, limit);
                    let base = stack.height();
                    while entered != 0 {
                        let slot = (entered.trailing_zeros() & 7) as usize;
                        entered &= entered - 1;
                        let key = keys[slot];
                        match Child(key as u32).unpack() {
                            Ok((first, _)) => self.visitor.prefetch(first),
                            Err(index) => prefetch(&self.nodes[index]),
                        }
                        if ORDERED {
                            stack.push_in_order(key, base);
                        } else {
                            stack.push(key);
                        }
                    }
                }
            }
            loop {
                let Some(key) = stack.pop() else { return };
                if f32::from_bits((key >> 32) as u32) <= limit {
                    current = Child(key as u32);
                    break;
                }
            }
        }
    }
}
