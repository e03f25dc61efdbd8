//! A tree of boxes over anything that has bounds; it never names a shape.

use std::time::Duration;

use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams};

use crate::math::{Bounds, DVec3, Ray, gamma};

/// A bounding volume hierarchy over numbered items.
///
/// Boxes are f32 rounded outward and tested in f64 with the far side moved out by 2 gamma(3) (Ize 2013, *Robust BVH Ray
/// Traversal*), so a ray that hits an item always reaches it. Boxes never decide a result, they only save work.
#[derive(Clone, Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    min: [f32; 3],
    /// First child, whose sibling follows it, or first entry of `items`.
    first: u32,
    max: [f32; 3],
    /// Number of items of a leaf, 0 for an inner node.
    count: u32,
}

/// Deepest tree that traversal accepts; a deeper one is rebuilt by halves.
const MAX_DEPTH: usize = 64;
/// Moves a far side out by the roundings of both sides' distances.
const WIDEN: f64 = 1.0 + 2.0 * gamma(3);
/// Items in a leaf of a tree built by halves.
const LEAF: usize = 4;

impl Bvh {
    /// The tree over items 0, 1, 2, .. with the given finite boxes.
    pub fn new(bounds: &[Bounds]) -> Self {
        if bounds.is_empty() {
            return Self { nodes: Vec::new(), items: Vec::new() };
        }
        let built = Self::by_surface_area(bounds);
        if built.depth() <= MAX_DEPTH { built } else { Self::by_halves(bounds) }
    }

    /// The tree that costs the fewest tests, built on boxes scaled to the unit cube.
    ///
    /// The scale is a power of two, so that a scene of any size gets the same tree and no area over- or underflows.
    fn by_surface_area(bounds: &[Bounds]) -> Self {
        let all = bounds.iter().fold(Bounds::EMPTY, |all, &b| all.union(b));
        let size = (all.max * 0.5 - all.min * 0.5).max_element().max(f64::MIN_POSITIVE);
        let shrink = libm::exp2(-libm::floor(libm::log2(size)));
        let scaled: Vec<Scaled> = bounds
            .iter()
            .map(|b| {
                let place = |p: DVec3| ((p - all.min) * shrink).as_vec3a();
                Scaled(Aabb::new(place(b.min), place(b.max)))
            })
            .collect();
        let mut build_time = Duration::ZERO;
        let tree = build_bvh2(&scaled, BvhBuildParams::medium_build(), &mut build_time);
        let nodes = tree.nodes.iter().map(|node| Node::empty(node.first_index, node.prim_count)).collect();
        let mut bvh = Self { nodes, items: tree.primitive_indices };
        bvh.fit(0, bounds);
        bvh
    }

    /// A tree whose depth is the logarithm of the number of items, whatever the boxes.
    fn by_halves(bounds: &[Bounds]) -> Self {
        let mut bvh = Self { nodes: vec![Node::empty(0, 0)], items: (0..bounds.len() as u32).collect() };
        let mut open = vec![(0, 0..bounds.len())];
        while let Some((node, range)) = open.pop() {
            if range.len() <= LEAF {
                bvh.nodes[node] = Node::empty(range.start as u32, range.len() as u32);
                continue;
            }
            let centers = range.clone().map(|i| bounds[bvh.items[i] as usize].center());
            let spread = Bounds::around(centers);
            let axis = (spread.max - spread.min).max_position();
            let middle = range.len() / 2;
            let key = |item: &u32| bounds[*item as usize].center()[axis];
            bvh.items[range.clone()].select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
            let first = bvh.nodes.len();
            bvh.nodes[node] = Node::empty(first as u32, 0);
            bvh.nodes.extend([Node::empty(0, 0); 2]);
            open.push((first, range.start..range.start + middle));
            open.push((first + 1, range.start + middle..range.end));
        }
        bvh.fit(0, bounds);
        bvh
    }

    /// Gives a node and all below it the boxes of their items, rounded outward.
    fn fit(&mut self, root: usize, bounds: &[Bounds]) {
        let mut order = vec![root];
        let mut next = 0;
        while next < order.len() {
            let node = self.nodes[order[next]];
            if node.count == 0 {
                order.extend([node.first as usize, node.first as usize + 1]);
            }
            next += 1;
        }
        for &index in order.iter().rev() {
            let node = self.nodes[index];
            let boxed = if node.count == 0 {
                self.nodes[node.first as usize].bounds().union(self.nodes[node.first as usize + 1].bounds())
            } else {
                let items = &self.items[node.first as usize..(node.first + node.count) as usize];
                items.iter().fold(Bounds::EMPTY, |all, &item| all.union(bounds[item as usize]))
            };
            self.nodes[index].min = boxed.min.to_array().map(round_down);
            self.nodes[index].max = boxed.max.to_array().map(round_up);
        }
    }

    fn depth(&self) -> usize {
        let (mut deepest, mut open) = (0, vec![(0, 1)]);
        while let Some((index, depth)) = open.pop() {
            deepest = deepest.max(depth);
            let node: &Node = &self.nodes[index];
            if node.count == 0 {
                open.extend([(node.first as usize, depth + 1), (node.first as usize + 1, depth + 1)]);
            }
        }
        deepest
    }

    /// Calls `test(item, t_max)` for the items whose boxes the ray may meet before `t_max`, nearer boxes first.
    ///
    /// `test` answers the new `t_max`, or none to end the walk.
    #[inline]
    pub fn walk(&self, ray: &Ray, mut t_max: f64, mut test: impl FnMut(u32, f64) -> Option<f64>) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = ray.direction.recip();
        let mut stack = [(0u32, 0f64); MAX_DEPTH + 1];
        let mut height = 0;
        let mut current = match self.nodes[0].enter(ray.origin, inverse, t_max) {
            Some(_) => 0,
            None => return,
        };
        loop {
            let node = &self.nodes[current];
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    match test(item, t_max) {
                        Some(nearer) => t_max = nearer,
                        None => return,
                    }
                }
            } else {
                let first = node.first;
                let enter = |child: u32| self.nodes[child as usize].enter(ray.origin, inverse, t_max);
                match (enter(first), enter(first + 1)) {
                    (Some(a), Some(b)) => {
                        let (near, far) = if a <= b { (first, (first + 1, b)) } else { (first + 1, (first, a)) };
                        stack[height] = far;
                        height += 1;
                        current = near as usize;
                        continue;
                    }
                    (Some(_), None) => {
                        current = first as usize;
                        continue;
                    }
                    (None, Some(_)) => {
                        current = first as usize + 1;
                        continue;
                    }
                    (None, None) => {}
                }
            }
            loop {
                if height == 0 {
                    return;
                }
                height -= 1;
                let (node, entered) = stack[height];
                if entered <= t_max * WIDEN {
                    current = node as usize;
                    break;
                }
            }
        }
    }
}

impl Node {
    fn empty(first: u32, count: u32) -> Self {
        Self { min: [0.0; 3], first, max: [0.0; 3], count }
    }

    fn bounds(&self) -> Bounds {
        Bounds { min: self.min.map(f64::from).into(), max: self.max.map(f64::from).into() }
    }

    /// Distance at which the ray may enter the box, if it meets it before `t_max`.
    ///
    /// `f64::max` and `min` ignore the NaN of 0 * infinity, which a ray within a side's plane produces. `t_max` is
    /// moved out too: a box that begins at a hit just found may hold an equally near one.
    #[inline]
    fn enter(&self, origin: DVec3, inverse: DVec3, t_max: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0, t_max * WIDEN);
        for axis in 0..3 {
            let a = (f64::from(self.min[axis]) - origin[axis]) * inverse[axis];
            let b = (f64::from(self.max[axis]) - origin[axis]) * inverse[axis];
            let (first, last) = if inverse[axis] < 0.0 { (b, a) } else { (a, b) };
            near = f64::max(near, first);
            far = f64::min(far, last * WIDEN);
        }
        (near <= far).then_some(near)
    }
}

/// The largest f32 that is not above x.
fn round_down(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) > x { rounded.next_down() } else { rounded }
}

/// The smallest f32 that is not below x.
fn round_up(x: f64) -> f32 {
    -round_down(-x)
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

    #[test]
    fn equal_and_geometric_boxes_give_trees_no_deeper_than_the_stack() {
        let unit = Bounds { min: DVec3::ZERO, max: DVec3::ONE };
        let equal = vec![unit; 4096];
        let geometric: Vec<Bounds> = (0..4096)
            .map(|i| {
                let x = libm::pow(1.02, f64::from(i));
                Bounds { min: DVec3::splat(x), max: DVec3::splat(x * 1.1) }
            })
            .collect();
        for boxes in [equal, geometric] {
            assert!(Bvh::new(&boxes).depth() <= MAX_DEPTH);
            assert!(Bvh::by_halves(&boxes).depth() <= 13);
        }
    }
}
