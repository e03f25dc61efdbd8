//! A map of points: a balanced k-d tree.
//!
//! Bentley 1975, *Multidimensional Binary Search Trees Used for Associative Searching*; Jensen 2001, *Realistic Image
//! Synthesis Using Photon Mapping*, section 6.2, keeps photons in one.

use std::ops::Range;

use crate::math::DVec3;

/// Points with what belongs to them, in the order of a tree: the middle of every range splits it.
#[derive(Clone, Debug)]
pub(super) struct Map<T> {
    points: Vec<(DVec3, T)>,
    /// Along which axis each point splits its range.
    axes: Vec<u8>,
}

/// Ranges of so few points are not split.
const FEW: usize = 8;
/// Ranges of so many are put in order side by side.
const MANY: usize = 1 << 14;

impl<T: Send> Map<T> {
    pub(super) fn new(mut points: Vec<(DVec3, T)>) -> Self {
        let mut axes = vec![0; points.len()];
        order(&mut points, &mut axes);
        Self { points, axes }
    }
}

impl<T> Map<T> {
    /// Visits all points nearer to a place than a radius, in an order that never changes.
    pub(super) fn near(&self, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        self.visit(0..self.points.len(), place, radius, visit);
    }

    fn visit(&self, range: Range<usize>, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        let Range { start, end } = range;
        if end - start <= FEW {
            self.look(start..end, place, radius, visit);
            return;
        }
        let middle = start + (end - start) / 2;
        let axis = usize::from(self.axes[middle]);
        let beyond = place[axis] - self.points[middle].0[axis];
        if beyond < radius {
            self.visit(start..middle, place, radius, visit);
        }
        self.look(middle..middle + 1, place, radius, visit);
        if beyond > -radius {
            self.visit(middle + 1..end, place, radius, visit);
        }
    }

    fn look(&self, range: Range<usize>, place: DVec3, radius: f64, visit: &mut impl FnMut(DVec3, &T)) {
        for (point, found) in &self.points[range] {
            if (*point - place).length_squared() < radius * radius {
                visit(*point, found);
            }
        }
    }
}

/// Puts points in the order of a tree.
fn order<T: Send>(points: &mut [(DVec3, T)], axes: &mut [u8]) {
    if points.len() <= FEW {
        return;
    }
    let [low, high] = [DVec3::min, DVec3::max].map(|of| points.iter().map(|point| point.0).reduce(of));
    let size = high.unwrap_or_default() - low.unwrap_or_default();
    let axis = (1..3).fold(0, |widest, axis| if size[axis] > size[widest] { axis } else { widest });
    let middle = points.len() / 2;
    points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
    axes[middle] = axis as u8;
    let ((before, after), (axes_before, axes_after)) = (points.split_at_mut(middle), axes.split_at_mut(middle));
    let mut left = || order(before, axes_before);
    let mut right = || order(&mut after[1..], &mut axes_after[1..]);
    if middle > MANY {
        rayon::join(left, right);
    } else {
        left();
        right();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{BranchKey, Sampler};

    #[test]
    fn all_points_within_the_radius_are_visited_once() {
        for count in [0, 1, 8, 9, 100, 40_000] {
            let place = |i: u32| {
                let [x, y, z, _] = Sampler::new(7, [0, 0], i).four_plain(BranchKey::CAMERA, 0);
                // Many alike along one axis, as on a floor.
                DVec3::new(x, (8.0 * y).floor(), 0.1 * z)
            };
            let map = Map::new((0..count).map(|i| (place(i), i)).collect());
            for (number, radius) in [0.0, 0.01, 0.1, 1.0, 20.0].into_iter().enumerate() {
                let from = place(1_000_000 + number as u32);
                let mut found = Vec::new();
                map.near(from, radius, &mut |point, &i| {
                    assert_eq!(point, place(i));
                    found.push(i);
                });
                found.sort_unstable();
                let wanted: Vec<u32> = (0..count).filter(|&i| (place(i) - from).length() < radius).collect();
                assert_eq!(found, wanted, "{count} points, radius {radius}");
            }
        }
    }
}
