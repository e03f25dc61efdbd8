//! A map of points: a balanced k-d tree.
//!
//! Bentley 1975, *Multidimensional Binary Search Trees Used for Associative Searching*; Jensen 2001, *Realistic Image
//! Synthesis Using Photon Mapping*, section 6.2, stores photons in one. A grid would need one radius for all searches,
//! but each path has its own. What belongs to a point is stored separately, so that a search reads little memory.

use std::ops::Range;

use crate::math::{Bounds, DVec3};

/// Points, and what belongs to each of them.
#[derive(Clone, Debug)]
pub struct KdTree<T> {
    /// Leaf by leaf; within each, in the order in which they were given.
    points: Vec<DVec3>,
    values: Vec<T>,
    /// Level by level: the children of split i are 2 i + 1 and 2 i + 2.
    splits: Vec<Split>,
    bounds: Bounds,
}

/// A plane that separates the two halves of a range.
#[derive(Clone, Copy, Debug, Default)]
struct Split {
    position: f64,
    axis: u32,
}

/// Ranges of at most this many points are not split.
const MAX_LEAF_POINTS: usize = 8;

impl<T> KdTree<T> {
    pub fn new(points: Vec<(DVec3, T)>) -> Self {
        let mut order: Vec<(DVec3, u32)> = (0..).zip(&points).map(|(number, point)| (point.0, number)).collect();
        let mut splits = Vec::new();
        split(&mut order, 0, &mut splits);
        let mut unordered: Vec<Option<T>> = points.into_iter().map(|point| Some(point.1)).collect();
        let values = order.iter().filter_map(|&(_, number)| unordered[number as usize].take()).collect();
        let points: Vec<DVec3> = order.into_iter().map(|point| point.0).collect();
        let bounds = Bounds::around(points.iter().copied());
        Self { points, values, splits, bounds }
    }

    /// Visits all points closer to a place than a radius, in a fixed order.
    pub fn visit_near(&self, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        let Bounds { min, max } = self.bounds;
        // Everything is infinitely far from an empty tree.
        if (place.clamp(min, max) - place).length_squared() < radius * radius {
            self.visit(0, 0..self.points.len(), place, radius, visit);
        }
    }

    fn visit(&self, node: usize, range: Range<usize>, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        let Range { start, end } = range;
        if end - start <= MAX_LEAF_POINTS {
            self.visit_leaf(start..end, place, radius, visit);
            return;
        }
        let (Split { position, axis }, middle) = (self.splits[node], start + (end - start) / 2);
        let signed_distance = place[axis as usize] - position;
        if signed_distance < radius {
            self.visit(2 * node + 1, start..middle, place, radius, visit);
        }
        if signed_distance > -radius {
            self.visit(2 * node + 2, middle..end, place, radius, visit);
        }
    }

    fn visit_leaf(&self, range: Range<usize>, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        for (point, number) in self.points[range.clone()].iter().zip(range) {
            if (*point - place).length_squared() < radius * radius {
                visit(*point, &self.values[number]);
            }
        }
    }
}

/// Puts points in the order of a tree, which depends only on their numbers and places.
fn split(points: &mut [(DVec3, u32)], node: usize, splits: &mut Vec<Split>) {
    if points.len() <= MAX_LEAF_POINTS {
        points.sort_unstable_by_key(|point| point.1);
        return;
    }
    let bounds = Bounds::around(points.iter().map(|point| point.0));
    let size = bounds.size();
    let axis = (1..3).fold(0, |widest, axis| if size[axis] > size[widest] { axis } else { widest });
    let middle = points.len() / 2;
    let order = |a: &(DVec3, u32), b: &(DVec3, u32)| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1));
    points.select_nth_unstable_by(middle, order);
    if splits.len() <= node {
        splits.resize(node + 1, Split::default());
    }
    splits[node] = Split { position: points[middle].0[axis], axis: axis as u32 };
    let (before, beyond) = points.split_at_mut(middle);
    split(before, 2 * node + 1, splits);
    split(beyond, 2 * node + 2, splits);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{BranchKey, Sampler};

    #[test]
    fn all_points_within_the_radius_are_visited_once() {
        for count in [0, 1, 8, 9, 100, 40_000] {
            let place = |i: u32| {
                let [x, y, z, _] = Sampler::new(7, [0, 0], i).get_random_4d(BranchKey::CAMERA, 0);
                // Many share a coordinate along one axis, as on a floor.
                DVec3::new(x, (8.0 * y).floor(), 0.1 * z)
            };
            let map = KdTree::new((0..count).map(|i| (place(i), i)).collect());
            for (number, radius) in [0.0, 0.01, 0.1, 1.0, 20.0].into_iter().enumerate() {
                let from = place(1_000_000 + number as u32);
                let mut values = Vec::new();
                map.visit_near(from, radius, &mut |point, &i| {
                    assert_eq!(point, place(i));
                    values.push(i);
                });
                values.sort_unstable();
                let expected: Vec<u32> = (0..count).filter(|&i| (place(i) - from).length() < radius).collect();
                assert_eq!(values, expected, "{count} points, radius {radius}");
            }
        }
    }
}
