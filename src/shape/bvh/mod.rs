//! A tree of boxes over anything that has bounds; it never names a shape.

mod build;
mod collapse;
mod node;
mod slabs;
mod stack;
mod vectors;
mod walk;

pub use vectors::{Computation, Crossings, GROUP, Instructions, Line, Number, Vectors, prefetch};
pub use walk::Visitor;

use crate::math::{Bounds, Ray};
use build::Builder;
use node::{Node, Outer};
use slabs::{Child, NO_ITEM};
use walk::Walk;

/// A bounding volume hierarchy over numbered items, eight children to a node.
///
/// Boxes are f32 rounded outward and tested so that a ray that hits an item always reaches it. Boxes never decide a
/// result, they only save work.
#[derive(Clone, Debug)]
pub struct Bvh {
    root: Option<Child>,
    nodes: Vec<Node>,
    /// Items in the order of the leaves. A leaf has whole groups of them, the last one filled up with `Bvh::NONE`.
    items: Vec<u32>,
    instructions: Instructions,
}

impl Bvh {
    /// Stands for no item, where a group is not full.
    pub const NONE: u32 = NO_ITEM;

    /// The tree over items 0, 1, 2, .. with the given finite boxes, in groups of `GROUP`.
    pub fn new<const GROUP: usize>(bounds: impl Iterator<Item = Bounds>) -> Self {
        Self::of_parts::<GROUP>((0..).zip(bounds))
    }

    /// The tree over items that may have several boxes each, which contain all that is to be found of them together.
    pub fn of_parts<const GROUP: usize>(parts: impl Iterator<Item = (u32, Bounds)>) -> Self {
        let (owners, boxes): (Vec<u32>, Vec<Outer>) = parts.map(|(item, bounds)| (item, Outer::of(&bounds))).unzip();
        let (root, nodes, items) = Builder::build(&boxes, &owners, GROUP);
        Self { root, nodes, items, instructions: Instructions::best() }
    }

    /// The items in the order of the leaves, with `NONE` where groups are not full.
    pub fn items(&self) -> &[u32] {
        &self.items
    }

    /// Shows a visitor the leaves whose boxes the ray may meet before `t_max`, nearer ones first if `ORDERED`.
    #[inline]
    pub fn walk<const ORDERED: bool>(&self, ray: &Ray, t_max: f64, visitor: &mut impl Visitor) {
        self.instructions.run(Walk::<ORDERED, _> { root: self.root, nodes: &self.nodes, ray, t_max, visitor })
    }

    /// The same tree, walked without the instructions that only some machines have.
    #[cfg(test)]
    pub(super) fn plain(self) -> Self {
        Self { instructions: Instructions::Plain, ..self }
    }
}
