//! From a binary tree to nodes of eight.

use std::ops::Range;

use super::Bvh;
use super::build::Builder;
use super::node::{Child, Node, Outer, WIDTH};

/// A node of a binary tree.
#[derive(Clone, Copy)]
pub struct Pair {
    pub outer: Outer,
    pub below: Below,
}

#[derive(Clone, Copy)]
pub enum Below {
    /// First of two neighboring nodes.
    Two(usize),
    /// A range of `order`.
    Items(usize, usize),
    /// A subtree that is done.
    Done(Child),
}

impl Builder<'_> {
    /// Turns a binary tree into nodes of eight: the children of the largest child take its place until there are eight.
    pub fn collapse(&mut self, pairs: &[Pair]) -> Child {
        let mut root = Child::inner(self.nodes.len());
        // Each binary node becomes a child of a node, the first one the root.
        let mut open = vec![(0, None)];
        while let Some((index, slot)) = open.pop() {
            let child = match pairs[index].below {
                Below::Done(child) => child,
                Below::Items(first, count) => self.leaf(first..first + count),
                Below::Two(first) => {
                    let node = self.nodes.len();
                    let mut parts = vec![first, first + 1];
                    while parts.len() < WIDTH {
                        let divisible = (0..parts.len()).filter(|&i| matches!(pairs[parts[i]].below, Below::Two(_)));
                        let area = |i: usize| pairs[parts[i]].outer.half_area();
                        let Some(largest) = divisible.max_by(|&a, &b| area(a).total_cmp(&area(b))) else { break };
                        let Below::Two(first) = pairs[parts[largest]].below else { break };
                        parts[largest] = first;
                        parts.push(first + 1);
                    }
                    self.nodes.push(Node::EMPTY);
                    for (slot, &part) in parts.iter().enumerate() {
                        self.nodes[node].set(slot, &pairs[part].outer, Child(0));
                        open.push((part, Some((node, slot))));
                    }
                    Child::inner(node)
                }
            };
            match slot {
                None => root = child,
                Some((node, slot)) => self.nodes[node].children[slot] = child,
            }
        }
        root
    }

    fn leaf(&mut self, range: Range<usize>) -> Child {
        let first = self.items.len();
        self.items.extend_from_slice(&self.order[range]);
        let full = self.items.len().next_multiple_of(self.group);
        self.items.resize(full, Bvh::NONE);
        Child::leaf(first / self.group, (full - first) / self.group)
    }

    /// Nodes on the longest way from the root to a leaf.
    pub fn levels(&self, root: Child) -> usize {
        let (mut deepest, mut open) = (0, vec![(root, 0)]);
        while let Some((child, level)) = open.pop() {
            deepest = deepest.max(level);
            if let Err(index) = child.open() {
                open.extend(self.nodes[index].present().map(|child| (child, level + 1)));
            }
        }
        deepest
    }
}
