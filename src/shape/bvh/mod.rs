//! A tree of boxes over anything that has bounds. It does not depend on shapes.

mod build;
mod collapse;
mod node;
mod slabs;
mod stack;
mod vectors;
mod walk;

pub use vectors::{Computation, Crossings, GROUP, Instructions, Line, Number, Vectors, prefetch};
pub use walk::{VectorVisitor, Visitor};

use crate::math::{Bounds, Ray};
use build::Builder;
use node::{Node, OuterBox};
use slabs::{Child, NO_ITEM};
use walk::Walk;

/// A bounding volume hierarchy over numbered items, with eight children per node.
///
/// Boxes are stored as f32, rounded outward, and tested so that a ray that hits an item always reaches it. Boxes never
/// decide a result, they only save work.
#[derive(Clone, Debug)]
pub struct Bvh {
    root: Option<Child>,
    nodes: Vec<Node>,
    /// Items in the order of the leaves. Each leaf has whole groups of items. The last group is filled up with
    /// `Bvh::NONE`.
    items: Vec<u32>,
    instructions: Instructions,
}

impl Bvh {
    /// Stands for no item, in groups that are not full.
    pub const NONE: u32 = NO_ITEM;

    /// Builds the tree over items 0, 1, 2, .. with the given finite boxes, in groups of `GROUP`.
    pub fn new<const GROUP: usize>(bounds: impl Iterator<Item = Bounds>) -> Self {
        Self::of_parts::<GROUP>((0..).zip(bounds))
    }

    /// Builds the tree over items that may have several boxes each. Together, the boxes of an item contain all of it.
    pub fn of_parts<const GROUP: usize>(parts: impl Iterator<Item = (u32, Bounds)>) -> Self {
        let (owners, boxes): (Vec<u32>, Vec<OuterBox>) =
            parts.map(|(item, bounds)| (item, OuterBox::from_bounds(&bounds))).unzip();
        let (root, nodes, items) = Builder::build(&boxes, &owners, GROUP);
        Self { root, nodes, items, instructions: Instructions::best() }
    }

    /// Returns the items in the order of the leaves, with `NONE` in groups that are not full.
    pub fn items(&self) -> &[u32] {
        &self.items
    }

    /// Calls the visitor for the leaves whose boxes the ray may meet before `t_max`, nearer ones first if `ORDERED`.
    #[inline]
    pub fn walk<const ORDERED: bool>(&self, ray: &Ray, t_max: f64, visitor: &mut impl Visitor) {
        self.walk_with_vectors::<ORDERED>(ray, t_max, visitor);
    }

    /// Calls the visitor like [`walk`](Self::walk), and lends it the vector instructions of the machine.
    #[inline]
    pub(super) fn walk_with_vectors<const ORDERED: bool>(
        &self,
        ray: &Ray,
        t_max: f64,
        visitor: &mut impl VectorVisitor,
    ) {
        self.instructions.run(Walk::<ORDERED, _> { root: self.root, nodes: &self.nodes, ray, t_max, visitor })
    }

    /// Returns the tree, to be walked without instructions that only some machines have.
    #[cfg(test)]
    pub(super) fn plain(self) -> Self {
        Self { instructions: Instructions::Plain, ..self }
    }
}
