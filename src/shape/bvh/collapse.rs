//! Collapses a binary tree to nodes with eight children.

use super::build::Builder;
use super::node::{Node, Pair};
use super::slabs::{Child, NO_ITEM, WIDTH};

impl Builder<'_> {
    /// Turns a binary tree into nodes with eight children: replaces the largest child by its own children until there
    /// are eight.
    ///
    /// The children of a node are stored side by side, because they are often visited together.
    pub fn collapse(&mut self, pairs: &[Pair]) -> Child {
        if pairs[0].count > 0 {
            return self.leaf(&pairs[0]);
        }
        self.nodes.push(Node::EMPTY);
        let mut open = vec![(pairs[0].first, 0)];
        while let Some((first, node)) = open.pop() {
            let mut parts = vec![first as usize, first as usize + 1];
            while parts.len() < WIDTH {
                let divisible = (0..parts.len()).filter(|&i| pairs[parts[i]].count == 0);
                let area = |i: usize| pairs[parts[i]].outer.half_area();
                let Some(largest) = divisible.max_by(|&a, &b| area(a).total_cmp(&area(b))) else { break };
                let first = pairs[parts[largest]].first as usize;
                parts[largest] = first;
                parts.push(first + 1);
            }
            for (slot, pair) in parts.iter().map(|&part| &pairs[part]).enumerate() {
                let child = if pair.count > 0 {
                    self.leaf(pair)
                } else {
                    open.push((pair.first, self.nodes.len()));
                    self.nodes.push(Node::EMPTY);
                    Child::inner(self.nodes.len() - 1)
                };
                self.nodes[node].set(slot, &pair.outer, child);
            }
        }
        Child::inner(0)
    }

    fn leaf(&mut self, pair: &Pair) -> Child {
        let first = self.items.len();
        for &part in &self.order[pair.first as usize..(pair.first + pair.count) as usize] {
            let item = self.owners[part as usize];
            if !self.items[first..].contains(&item) {
                self.items.push(item);
            }
        }
        let full = self.items.len().next_multiple_of(self.group);
        self.items.resize(full, NO_ITEM);
        Child::leaf(first / self.group, (full - first) / self.group)
    }

    /// Returns the number of nodes on the longest path from the root to a leaf.
    pub fn levels(&self, root: Child) -> usize {
        let (mut deepest, mut open) = (0, vec![(root, 0)]);
        while let Some((child, level)) = open.pop() {
            deepest = deepest.max(level);
            if let Err(index) = child.unpack() {
                open.extend(self.nodes[index].present_children().map(|child| (child, level + 1)));
            }
        }
        deepest
    }
}
