//! Boxes around parts of triangles, for triangles that fill their own boxes badly.
//!
//! A long diagonal triangle leaves most of its box empty, and rays enter that box for nothing. Cut into parts with a
//! box each, it costs little more than a compact triangle (Ernst & Greiner 2007, *Early Split Clipping for Bounding
//! Volume Hierarchies*). The cut that saves most comes first (Karras & Aila 2013, *Fast Parallel Construction of
//! High-Quality Bounding Volume Hierarchies*, section 5).

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Bvh;
use super::bvh::GROUP;
use crate::math::{Bounds, DVec3, gamma};

/// Minimum gain of a cut, in multiples of half the surface area of a box that the triangle would fill.
const MIN_GAIN: f64 = 8.0;
/// Maximum number of cuts per triangle, on average over a mesh, unless these are more than `FREE_CUTS` in all.
const MAX_CUTS: usize = 8;
/// Number of cuts that are allowed in any mesh. It is limited because each cut takes some 200 bytes. A mesh of more
/// triangles than this may have one cut per triangle.
const FREE_CUTS: usize = 1 << 20;

/// The part of a triangle that lies in a box.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fragment {
    triangle: u32,
    bounds: Bounds,
}

/// Builds the tree over some triangles, and cuts those that fill their boxes badly.
pub(super) fn build_tree(count: u32, corners: impl Fn(u32) -> [DVec3; 3]) -> Bvh {
    let cut = fragments(count, &corners);
    let is_whole = |triangle: &u32| cut.binary_search_by_key(triangle, |fragment| fragment.triangle).is_err();
    let whole = (0..count).filter(is_whole).map(|triangle| (triangle, Bounds::around(corners(triangle))));
    Bvh::of_parts::<GROUP>(whole.chain(cut.iter().map(|fragment| (fragment.triangle, fragment.bounds))))
}

/// Returns the fragments of the triangles that are worth cutting, sorted by triangle.
fn fragments(count: u32, corners: impl Fn(u32) -> [DVec3; 3]) -> Vec<Fragment> {
    let ideal = |triangle| ideal_half_area(corners(triangle));
    let mean = (0..count).map(ideal).sum::<f64>() / f64::from(count);
    let cut = |fragment: Fragment| Cut::new(fragment, &corners(fragment.triangle));
    let is_worthwhile = |cut: &Cut| cut.gain > mean.max(MIN_GAIN * ideal(cut.fragment.triangle));
    let whole = |triangle| Fragment { triangle, bounds: Bounds::around(corners(triangle)) };
    // A cut cannot save more than the surface area of the whole box.
    let large = (0..count).map(whole).filter(|fragment| fragment.bounds.half_area() > mean);
    let mut open: BinaryHeap<Cut> = large.map(cut).filter(is_worthwhile).collect();
    let max_fragments = open.len() + (MAX_CUTS * count as usize).min(FREE_CUTS.max(count as usize));
    let mut done = Vec::new();
    while open.len() + done.len() < max_fragments
        && let Some(Cut { fragment: Fragment { triangle, .. }, halves, .. }) = open.pop()
    {
        for bounds in halves.into_iter().filter(|half| !half.is_empty()) {
            let next = cut(Fragment { triangle, bounds });
            if is_worthwhile(&next) { open.push(next) } else { done.push(next.fragment) }
        }
    }
    done.extend(open.into_iter().map(|cut| cut.fragment));
    done.sort_by_key(|fragment| fragment.triangle);
    done
}

/// Returns half the surface area that a triangle's box would have if the triangle lay along two axes, with a right
/// angle at a corner of the box.
fn ideal_half_area([a, b, c]: [DVec3; 3]) -> f64 {
    (b - a).cross(c - a).abs().element_sum()
}

struct Cut {
    fragment: Fragment,
    halves: [Bounds; 2],
    /// Half the surface area of the box, minus those of both halves.
    gain: f64,
}

impl Cut {
    /// Cuts a fragment across its longest side.
    fn new(fragment: Fragment, corners: &[DVec3; 3]) -> Self {
        let Bounds { min, max } = fragment.bounds;
        let axis = (max - min).max_position();
        // The cut is rounded to 32 bits, so that the boxes of the tree, which are in 32 bits, meet there.
        let middle = f64::from((0.5 * min[axis] + 0.5 * max[axis]) as f32);
        if !(min[axis] < middle && middle < max[axis]) {
            return Self { fragment, halves: [fragment.bounds; 2], gain: 0.0 };
        }
        let halves = sides(corners, axis, middle).map(|side| side.intersection(fragment.bounds));
        let gain = fragment.bounds.half_area() - halves[0].half_area() - halves[1].half_area();
        Self { fragment, halves, gain }
    }
}

/// Returns the boxes around the parts of a triangle on both sides of a plane across an axis.
fn sides(corners: &[DVec3; 3], axis: usize, at: f64) -> [Bounds; 2] {
    let mut sides = [Bounds::EMPTY; 2];
    for (i, &a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % 3];
        if a[axis] <= at {
            sides[0] = sides[0].union(Bounds::around([a]));
        }
        if a[axis] >= at {
            sides[1] = sides[1].union(Bounds::around([a]));
        }
        if (a[axis] < at) != (b[axis] < at) && b[axis] != at && a[axis] != at {
            let intersection = a + (b - a) * ((at - a[axis]) / (b[axis] - a[axis]));
            // Five roundings of the product, which is at most twice the larger coordinate, and one of the sum.
            let error = a.abs().max(b.abs()) * gamma(11);
            let around = Bounds { min: intersection - error, max: intersection + error };
            sides = sides.map(|side| side.union(around));
        }
    }
    let [mut low, mut high] = sides;
    (low.max[axis], high.min[axis]) = (at, at);
    [low, high]
}

impl PartialEq for Cut {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Cut {}

impl PartialOrd for Cut {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Cut {
    fn cmp(&self, other: &Self) -> Ordering {
        self.gain.total_cmp(&other.gain).then(other.fragment.triangle.cmp(&self.fragment.triangle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, sample_triangle};
    use libm::{cos, sin};

    /// Returns a pipe along a direction, with two triangles per side.
    fn pipe(sides: u32, along: DVec3) -> Vec<[DVec3; 3]> {
        let frame = Frame::about(along);
        let at = |side: u32, end: f64| {
            let turn = std::f64::consts::TAU * f64::from(side % sides) / f64::from(sides);
            frame.to_world(DVec3::new(0.3 * cos(turn), 0.3 * sin(turn), end))
        };
        let two = |i| [[at(i, -1.0), at(i + 1, -1.0), at(i + 1, 1.0)], [at(i, -1.0), at(i + 1, 1.0), at(i, 1.0)]];
        (0..sides).flat_map(two).collect()
    }

    fn cut(triangles: &[[DVec3; 3]]) -> Vec<Fragment> {
        fragments(triangles.len() as u32, |index| triangles[index as usize])
    }

    /// Row B6 of the stability catalog.
    #[test]
    fn b6_long_triangles_that_run_aslant_are_cut_and_others_are_not() {
        let aslant = pipe(1000, DVec3::new(0.5, 0.6, 0.7).normalize());
        let fragments = cut(&aslant);
        assert!(fragments.len() <= 9 * aslant.len(), "{}", fragments.len());
        let whole: f64 = aslant.iter().map(|&points| Bounds::around(points).half_area()).sum();
        let parts: f64 = fragments.iter().map(|fragment| fragment.bounds.half_area()).sum();
        assert!(parts < 0.15 * whole, "{parts} of {whole}");
        // Along an axis, boxes are hardly larger than their contents. A large triangle need not be long.
        assert_eq!(cut(&pipe(100, DVec3::Z)), []);
        let mut compact = pipe(40, DVec3::new(0.5, 0.6, 0.7).normalize());
        compact.push([DVec3::X, DVec3::Y, DVec3::Z].map(|corner| 100.0 * corner));
        assert_eq!(cut(&compact), []);
    }

    #[test]
    fn fragments_hold_all_of_their_triangles() {
        let triangles = pipe(100, DVec3::new(-0.5, 0.6, 0.3).normalize());
        let fragments = cut(&triangles);
        let mut number = 0.5;
        for (index, points) in (0..).zip(&triangles) {
            let own: Vec<Fragment> = fragments.iter().filter(|fragment| fragment.triangle == index).copied().collect();
            assert!(own.len() > 1);
            for fragment in &own {
                assert_eq!(fragment.bounds.intersection(Bounds::around(*points)), fragment.bounds);
            }
            for _ in 0..1000 {
                let mut next = || {
                    number = (number + 0.5_f64.sqrt()).fract();
                    number
                };
                let [u, v] = sample_triangle([next(), next()]);
                let point = points[0] + (points[1] - points[0]) * u + (points[2] - points[0]) * v;
                let holds = |fragment: &Fragment| {
                    let Bounds { min, max } = fragment.bounds.padded(8);
                    point.cmpge(min).all() && point.cmple(max).all()
                };
                assert!(own.iter().any(holds), "{point}");
            }
        }
    }
}
