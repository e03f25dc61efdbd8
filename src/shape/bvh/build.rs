//! Builds the tree. Items are split top-down into clusters, obvhs builds each cluster, and the result is collapsed to
//! nodes with eight children.

use std::ops::Range;
use std::time::Duration;

use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use super::node::{Node, OuterBox, Pair};
use super::slabs::{Child, WIDTH};
use super::stack::STACK_SIZE;
use crate::math::{DVec3, mix_bits};

/// Maximum number of items in a cluster. Building a cluster takes some 200 bytes per item.
const MAX_CLUSTER_ITEMS: usize = 1 << 17;
/// Number of slices along an axis, between which items are split into clusters.
const SLICES: usize = 32;
/// Depth beyond which items are split into clusters by halves.
const HALVING_DEPTH: u32 = 24;
/// Maximum number of levels for which the stack of a walk suffices. Each level leaves all but one of its children on
/// the stack.
const MAX_LEVELS: usize = (STACK_SIZE - 1) / (WIDTH - 1);
/// Cost of visiting an inner node, in tests of an item.
const NODE_COST: f32 = 3.0;

/// Largest share of its longest side by which a box is enlarged, divided by 2^24, and the smallest value that counts as
/// its longest side. Boxes are scaled to a cube of about unit size, and their coordinates have steps of about 2^-24.
const JITTER: f32 = 1.0 / (1_u64 << 30) as f32;
const MIN_SIZE: f32 = 1.0 / (1 << 16) as f32;

/// A tree under construction.
pub struct Builder<'a> {
    boxes: &'a [OuterBox],
    /// The item of each box.
    pub(super) owners: &'a [u32],
    pub(super) group: usize,
    /// Indices of the boxes, reordered in place.
    pub(super) order: Vec<u32>,
    pub(super) nodes: Vec<Node>,
    pub(super) items: Vec<u32>,
}

impl<'a> Builder<'a> {
    /// Builds a tree and returns its root, its nodes and its items. Leaves are filled up to whole groups.
    pub fn build(boxes: &'a [OuterBox], owners: &'a [u32], group: usize) -> (Option<Child>, Vec<Node>, Vec<u32>) {
        if boxes.is_empty() {
            return (None, Vec::new(), Vec::new());
        }
        let mut builder = Self::new(boxes, owners, group);
        let mut root = builder.build_clusters();
        if builder.levels(root) > MAX_LEVELS {
            builder = Self::new(boxes, owners, group);
            root = builder.build_by_halves();
        }
        builder.nodes.shrink_to_fit();
        builder.items.shrink_to_fit();
        (Some(root), builder.nodes, builder.items)
    }

    fn new(boxes: &'a [OuterBox], owners: &'a [u32], group: usize) -> Self {
        let order = (0..boxes.len() as u32).collect();
        Self { boxes, owners, group, order, nodes: Vec::new(), items: Vec::new() }
    }

    fn bounds_of(&self, range: Range<usize>) -> OuterBox {
        self.order[range].iter().fold(OuterBox::EMPTY, |all, &item| all.union(self.boxes[item as usize]))
    }

    /// Builds a tree whose upper part splits the items into clusters where that costs the fewest tests.
    fn build_clusters(&mut self) -> Child {
        let split = |builder: &mut Self, range, depth| {
            if depth < HALVING_DEPTH { builder.split(range) } else { builder.halve(range) }
        };
        self.build_tree(MAX_CLUSTER_ITEMS, split, Self::build_by_sah)
    }

    /// Builds a tree whose depth is the logarithm of the number of items, whatever the boxes.
    fn build_by_halves(&mut self) -> Child {
        self.build_tree(self.group, |builder, range, _| builder.halve(range), |_, _, _, _| ())
    }

    /// Builds a tree by splitting top-down into leaves of at most `max_items` items, each of which `finish` completes.
    fn build_tree(
        &mut self,
        max_items: usize,
        split: impl Fn(&mut Self, Range<usize>, u32) -> usize,
        finish: impl Fn(&mut Self, Range<usize>, usize, &mut Vec<Pair>),
    ) -> Child {
        let whole = 0..self.order.len();
        let mut pairs = vec![Pair::leaf(&whole)];
        let mut open = vec![(0, whole, 0)];
        while let Some((index, range, depth)) = open.pop() {
            if range.len() <= max_items {
                finish(self, range, index, &mut pairs);
                continue;
            }
            let middle = range.start + split(self, range.clone(), depth);
            let first = pairs.len();
            pairs[index] = Pair::inner(first);
            for (child, half) in [range.start..middle, middle..range.end].into_iter().enumerate() {
                pairs.push(Pair::leaf(&half));
                open.push((first + child, half, depth + 1));
            }
        }
        self.refit(&mut pairs);
        self.collapse(&pairs)
    }

    /// Splits a range into two groups and reorders it so that the first group comes first. Returns the size of the
    /// first group.
    ///
    /// The split minimizes the surface area times the number of items, summed over both groups: Wald 2007, *On fast
    /// Construction of SAH-based Bounding Volume Hierarchies*.
    fn split(&mut self, range: Range<usize>) -> usize {
        let mut centers = [[f64::INFINITY, f64::NEG_INFINITY]; 3];
        for &item in &self.order[range.clone()] {
            for (axis, [low, high]) in centers.iter_mut().enumerate() {
                let middle = self.boxes[item as usize].twice_center(axis);
                (*low, *high) = (low.min(middle), high.max(middle));
            }
        }
        let mut best: Option<(f64, usize, usize)> = None;
        let slice = |outer: &OuterBox, axis: usize| {
            let [low, high] = centers[axis];
            (((outer.twice_center(axis) - low) / (high - low) * SLICES as f64) as usize).min(SLICES - 1)
        };
        let mut slices = [[(OuterBox::EMPTY, 0usize); SLICES]; 3];
        for &item in &self.order[range.clone()] {
            let outer = &self.boxes[item as usize];
            for axis in 0..3 {
                let (all, count) = &mut slices[axis][slice(outer, axis)];
                (*all, *count) = (all.union(*outer), *count + 1);
            }
        }
        for (axis, slices) in slices.iter().enumerate() {
            let cost =
                |&(outer, count): &(OuterBox, usize)| if count == 0 { 0.0 } else { outer.half_area() * count as f64 };
            let join = |a: &(OuterBox, usize), b: &(OuterBox, usize)| (a.0.union(b.0), a.1 + b.1);
            let mut after = [(OuterBox::EMPTY, 0); SLICES + 1];
            (0..SLICES).rev().for_each(|i| after[i] = join(&slices[i], &after[i + 1]));
            let mut before = (OuterBox::EMPTY, 0);
            for i in 0..SLICES - 1 {
                before = join(&before, &slices[i]);
                let total = cost(&before) + cost(&after[i + 1]);
                if before.1 > 0 && after[i + 1].1 > 0 && best.is_none_or(|best| total < best.0) {
                    best = Some((total, axis, i));
                }
            }
        }
        let Some((_, axis, last)) = best else { return self.halve(range) };
        let items = &mut self.order[range];
        let (mut low, mut high) = (0, items.len());
        while low < high {
            if slice(&self.boxes[items[low] as usize], axis) <= last {
                low += 1;
            } else {
                high -= 1;
                items.swap(low, high);
            }
        }
        low
    }

    /// Splits and reorders a range in halves, along the axis where the centers of the items spread most. Returns the
    /// size of the first half.
    fn halve(&mut self, range: Range<usize>) -> usize {
        let boxes = self.boxes;
        let items = &mut self.order[range];
        let spread = |axis: usize| {
            let middles = items.iter().map(|&item| boxes[item as usize].twice_center(axis));
            let (low, high) = middles.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let axis = DVec3::from(std::array::from_fn(spread)).max_position();
        let key = |item: &u32| boxes[*item as usize].twice_center(axis);
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        half
    }

    /// Replaces a leaf by the tree over its range that costs the fewest tests.
    fn build_by_sah(&mut self, range: Range<usize>, root: usize, pairs: &mut Vec<Pair>) {
        let items = self.order[range.clone()].to_vec();
        let scaled = self.scaled_boxes(range.clone());
        let params = BvhBuildParams {
            max_prims_per_leaf: (self.group * 2).min(8) as u32,
            collapse_traversal_cost: NODE_COST,
            ..BvhBuildParams::medium_build()
        };
        let mut time = Duration::ZERO;
        let tree = build_bvh2(&scaled, params, &mut time);
        for (place, &index) in self.order[range.clone()].iter_mut().zip(&tree.primitive_indices) {
            *place = items[index as usize];
        }
        // The cluster's root replaces the leaf. Its other nodes are appended to the existing ones.
        let shift = pairs.len() - 1;
        let mut nodes = tree.nodes.iter().map(|node| match node.prim_count {
            0 => Pair::inner(shift + node.first_index as usize),
            count => Pair { first: range.start as u32 + node.first_index, ..Pair::leaf(&(0..count as usize)) },
        });
        pairs[root] = nodes.next().expect("a tree has a root");
        pairs.extend(nodes);
    }

    /// Returns the boxes of a range, scaled to a cube of about unit size and made slightly uneven.
    ///
    /// The scale is a power of two, so that a scene of any size gets the same tree and no area over- or underflows. The
    /// tree builder merges pairs of boxes that are nearest to each other. In a row with equal distances this is a
    /// single pair, then the next one, which takes quadratic time. So the boxes are changed until hardly any two
    /// distances are equal.
    fn scaled_boxes(&self, range: Range<usize>) -> Vec<ScaledBox> {
        let all = self.bounds_of(range.clone());
        let low = DVec3::from(all.min.map(f64::from));
        let size = (DVec3::from(all.max.map(f64::from)) - low).max_element().max(f64::MIN_POSITIVE);
        let shrink = libm::exp2(-libm::floor(libm::log2(size)));
        let place = |corner: [f32; 3]| ((DVec3::from(corner.map(f64::from)) - low) * shrink).as_vec3a();
        let jittered = |item: u32| {
            let OuterBox { min, max } = self.boxes[item as usize];
            let [low, high] = [min, max].map(place);
            let longest = (high - low).max_element().max(MIN_SIZE);
            let [below, above] =
                [0, 1].map(|end| (mix_bits(2 * u64::from(item) + end) >> 40) as f32 * (JITTER * longest));
            ScaledBox(Aabb::new(low - below, high + above))
        };
        self.order[range].iter().map(|&item| jittered(item)).collect()
    }

    /// Gives every node of a binary tree the box of its items.
    fn refit(&self, pairs: &mut [Pair]) {
        let mut order = vec![0u32];
        let mut next = 0;
        while next < order.len() {
            let pair = pairs[order[next] as usize];
            if pair.count == 0 {
                order.extend([pair.first, pair.first + 1]);
            }
            next += 1;
        }
        for &index in order.iter().rev() {
            let Pair { first, count, .. } = pairs[index as usize];
            let first = first as usize;
            pairs[index as usize].outer = match count as usize {
                0 => pairs[first].outer.union(pairs[first + 1].outer),
                count => self.bounds_of(first..first + count),
            };
        }
    }
}

struct ScaledBox(Aabb);

impl Boundable for ScaledBox {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Bounds;

    /// Row B5 of the stability catalog.
    #[test]
    fn b5_in_a_row_of_equal_boxes_many_pairs_are_nearest_to_each_other() {
        for count in [1000, MAX_CLUSTER_ITEMS as u32] {
            let at = |i: u32| OuterBox { min: [i as f32, 0.0, 0.0], max: [i as f32 + 1.0, 1.0, 0.0] };
            let row: Vec<OuterBox> = (0..count).map(at).collect();
            let owners = Vec::from_iter(0..count);
            let scaled = Builder::new(&row, &owners, 4).scaled_boxes(0..row.len());
            let areas: Vec<f32> = scaled.windows(2).map(|pair| pair[0].0.union(&pair[1].0).half_area()).collect();
            let pairs = areas.windows(3).filter(|area| area[1] <= area[0] && area[1] < area[2]).count();
            assert!(pairs > row.len() / 5, "{pairs} of {count}");
        }
    }

    /// Row B4 of the stability catalog.
    #[test]
    fn b4_equal_and_geometric_boxes_give_trees_no_deeper_than_the_stack() {
        let unit = OuterBox { min: [0.0; 3], max: [1.0; 3] };
        let equal = vec![unit; 4096];
        let geometric: Vec<OuterBox> = (0..4096)
            .map(|i| {
                let x = libm::pow(1.02, f64::from(i));
                OuterBox::from_bounds(&Bounds { min: DVec3::splat(x), max: DVec3::splat(x * 1.1) })
            })
            .collect();
        let owners = Vec::from_iter(0..4096);
        for boxes in [equal, geometric] {
            for group in [1, 4] {
                let (root, nodes, items) = Builder::build(&boxes, &owners, group);
                let builder = Builder { nodes, items, ..Builder::new(&boxes, &owners, group) };
                assert!(builder.levels(root.expect("a tree")) <= MAX_LEVELS);
                let mut halved = Builder::new(&boxes, &owners, group);
                let root = halved.build_by_halves();
                assert!(halved.levels(root) <= 12);
            }
        }
    }
}
