//! Builds the tree. Items are split top-down into clusters, obvhs builds each cluster, and the result is collapsed to
//! nodes with eight children.

use std::ops::Range;
use std::time::Duration;

use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use super::node::{Node, Outer, Pair};
use super::slabs::{Child, WIDTH};
use super::stack::STACK;
use crate::math::{DVec3, mix};

/// Maximum number of items in a cluster. Building a cluster takes some 200 bytes per item.
const CLUSTER: usize = 1 << 17;
/// Number of slices along an axis, between which items are split into clusters.
const SLICES: usize = 32;
/// Depth beyond which items are split into clusters by halves.
const DEEP: u32 = 24;
/// Maximum number of levels for which the stack of a walk suffices. Each level leaves all but one of its children on
/// the stack.
const MAX_LEVELS: usize = (STACK - 1) / (WIDTH - 1);
/// Cost of visiting an inner node, in tests of an item.
const NODE_COST: f32 = 3.0;

/// Largest share of its longest side by which a box is enlarged, divided by 2^24, and the smallest value that counts as
/// its longest side. Boxes are scaled to a cube of about unit size, and their coordinates have steps of about 2^-24.
const UNEVEN: f32 = 1.0 / (1_u64 << 30) as f32;
const LEAST_SIZE: f32 = 1.0 / (1 << 16) as f32;

/// A tree under construction.
pub struct Builder<'a> {
    boxes: &'a [Outer],
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
    pub fn build(boxes: &'a [Outer], owners: &'a [u32], group: usize) -> (Option<Child>, Vec<Node>, Vec<u32>) {
        if boxes.is_empty() {
            return (None, Vec::new(), Vec::new());
        }
        let mut built = Self::started(boxes, owners, group);
        let mut root = built.clusters();
        if built.levels(root) > MAX_LEVELS {
            built = Self::started(boxes, owners, group);
            root = built.by_halves();
        }
        built.nodes.shrink_to_fit();
        built.items.shrink_to_fit();
        (Some(root), built.nodes, built.items)
    }

    fn started(boxes: &'a [Outer], owners: &'a [u32], group: usize) -> Self {
        let order = (0..boxes.len() as u32).collect();
        Self { boxes, owners, group, order, nodes: Vec::new(), items: Vec::new() }
    }

    fn around(&self, range: Range<usize>) -> Outer {
        self.order[range].iter().fold(Outer::EMPTY, |all, &item| all.union(self.boxes[item as usize]))
    }

    /// Builds a tree whose upper part splits the items into clusters where that costs the fewest tests.
    fn clusters(&mut self) -> Child {
        let split = |built: &mut Self, range, depth| if depth < DEEP { built.split(range) } else { built.halve(range) };
        self.tree(CLUSTER, split, Self::by_surface_area)
    }

    /// Builds a tree whose depth is the logarithm of the number of items, whatever the boxes.
    fn by_halves(&mut self) -> Child {
        self.tree(self.group, |built, range, _| built.halve(range), |_, _, _, _| ())
    }

    /// Builds a tree by splitting top-down into leaves of at most `most` items, each of which `finish` completes.
    fn tree(
        &mut self,
        most: usize,
        split: impl Fn(&mut Self, Range<usize>, u32) -> usize,
        finish: impl Fn(&mut Self, Range<usize>, usize, &mut Vec<Pair>),
    ) -> Child {
        let whole = 0..self.order.len();
        let mut pairs = vec![Pair::leaf(&whole)];
        let mut open = vec![(0, whole, 0)];
        while let Some((index, range, depth)) = open.pop() {
            if range.len() <= most {
                finish(self, range, index, &mut pairs);
                continue;
            }
            let middle = range.start + split(self, range.clone(), depth);
            let first = pairs.len();
            pairs[index] = Pair::two(first);
            for (child, half) in [range.start..middle, middle..range.end].into_iter().enumerate() {
                pairs.push(Pair::leaf(&half));
                open.push((first + child, half, depth + 1));
            }
        }
        self.fit(&mut pairs);
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
                let middle = self.boxes[item as usize].middle(axis);
                (*low, *high) = (low.min(middle), high.max(middle));
            }
        }
        let mut best: Option<(f64, usize, usize)> = None;
        let slice = |outer: &Outer, axis: usize| {
            let [low, high] = centers[axis];
            (((outer.middle(axis) - low) / (high - low) * SLICES as f64) as usize).min(SLICES - 1)
        };
        let mut slices = [[(Outer::EMPTY, 0usize); SLICES]; 3];
        for &item in &self.order[range.clone()] {
            let outer = &self.boxes[item as usize];
            for axis in 0..3 {
                let (all, count) = &mut slices[axis][slice(outer, axis)];
                (*all, *count) = (all.union(*outer), *count + 1);
            }
        }
        for (axis, slices) in slices.iter().enumerate() {
            let cost =
                |&(outer, count): &(Outer, usize)| if count == 0 { 0.0 } else { outer.half_area() * count as f64 };
            let join = |a: &(Outer, usize), b: &(Outer, usize)| (a.0.union(b.0), a.1 + b.1);
            let mut after = [(Outer::EMPTY, 0); SLICES + 1];
            (0..SLICES).rev().for_each(|i| after[i] = join(&slices[i], &after[i + 1]));
            let mut before = (Outer::EMPTY, 0);
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
            let middles = items.iter().map(|&item| boxes[item as usize].middle(axis));
            let (low, high) = middles.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            high - low
        };
        let axis = DVec3::from(std::array::from_fn(spread)).max_position();
        let key = |item: &u32| boxes[*item as usize].middle(axis);
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        half
    }

    /// Replaces a leaf by the tree over its range that costs the fewest tests.
    fn by_surface_area(&mut self, range: Range<usize>, root: usize, pairs: &mut Vec<Pair>) {
        let items = self.order[range.clone()].to_vec();
        let scaled = self.scaled(range.clone());
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
            0 => Pair::two(shift + node.first_index as usize),
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
    fn scaled(&self, range: Range<usize>) -> Vec<Scaled> {
        let all = self.around(range.clone());
        let low = DVec3::from(all.min.map(f64::from));
        let size = (DVec3::from(all.max.map(f64::from)) - low).max_element().max(f64::MIN_POSITIVE);
        let shrink = libm::exp2(-libm::floor(libm::log2(size)));
        let place = |corner: [f32; 3]| ((DVec3::from(corner.map(f64::from)) - low) * shrink).as_vec3a();
        let uneven = |item: u32| {
            let Outer { min, max } = self.boxes[item as usize];
            let [low, high] = [min, max].map(place);
            let longest = (high - low).max_element().max(LEAST_SIZE);
            let [below, above] = [0, 1].map(|end| (mix(2 * u64::from(item) + end) >> 40) as f32 * (UNEVEN * longest));
            Scaled(Aabb::new(low - below, high + above))
        };
        self.order[range].iter().map(|&item| uneven(item)).collect()
    }

    /// Gives every node of a binary tree the box of its items.
    fn fit(&self, pairs: &mut [Pair]) {
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
                count => self.around(first..first + count),
            };
        }
    }
}

struct Scaled(Aabb);

impl Boundable for Scaled {
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
        for count in [1000, CLUSTER as u32] {
            let at = |i: u32| Outer { min: [i as f32, 0.0, 0.0], max: [i as f32 + 1.0, 1.0, 0.0] };
            let row: Vec<Outer> = (0..count).map(at).collect();
            let owners = Vec::from_iter(0..count);
            let scaled = Builder::started(&row, &owners, 4).scaled(0..row.len());
            let areas: Vec<f32> = scaled.windows(2).map(|pair| pair[0].0.union(&pair[1].0).half_area()).collect();
            let pairs = areas.windows(3).filter(|area| area[1] <= area[0] && area[1] < area[2]).count();
            assert!(pairs > row.len() / 5, "{pairs} of {count}");
        }
    }

    /// Row B4 of the stability catalog.
    #[test]
    fn b4_equal_and_geometric_boxes_give_trees_no_deeper_than_the_stack() {
        let unit = Outer { min: [0.0; 3], max: [1.0; 3] };
        let equal = vec![unit; 4096];
        let geometric: Vec<Outer> = (0..4096)
            .map(|i| {
                let x = libm::pow(1.02, f64::from(i));
                Outer::of(&Bounds { min: DVec3::splat(x), max: DVec3::splat(x * 1.1) })
            })
            .collect();
        let owners = Vec::from_iter(0..4096);
        for boxes in [equal, geometric] {
            for group in [1, 4] {
                let (root, nodes, items) = Builder::build(&boxes, &owners, group);
                let built = Builder { nodes, items, ..Builder::started(&boxes, &owners, group) };
                assert!(built.levels(root.expect("a tree")) <= MAX_LEVELS);
                let mut halved = Builder::started(&boxes, &owners, group);
                let root = halved.by_halves();
                assert!(halved.levels(root) <= 12);
            }
        }
    }
}
