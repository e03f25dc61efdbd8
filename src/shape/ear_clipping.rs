//! Triangulation of polygons in a plane.

use crate::math::DVec2;

/// Maximum number of corners of a polygon that is cut. The time grows with the square of the number.
pub(super) const MAX_CORNERS: usize = 1 << 12;

/// Returns the triangles of a counterclockwise polygon, given by its corners, each of which is off by up to `error`.
/// Returns `None` if its sides cross. Every corner of the polygon is a corner of a triangle.
///
/// A corner is an ear if the triangle with its two neighbors lies inside. It is cut off, and the remaining polygon has
/// ears again (Meisters 1975, *Polygons Have Ears*). A polygon may touch itself, like one that goes around a hole.
pub(super) fn clip_ears(corners: &[DVec2], error: f64) -> Option<Vec<[usize; 3]>> {
    let count = corners.len();
    let ring = Ring { corners, error, next: Vec::new(), previous: Vec::new() };
    if !(3..=MAX_CORNERS).contains(&count) || ring.crosses_itself() {
        return None;
    }
    let next = (1..count).chain([0]).collect();
    let previous = [count - 1].into_iter().chain(0..count - 1).collect();
    let (mut ring, mut triangles, mut remaining, mut at) = (Ring { next, previous, ..ring }, Vec::new(), count, 0);
    // Ears that are certain in spite of rounding are cut first. After a cut, only the two corners next to it can become
    // ears, apart from corners that others touch. Those are tested again in the next round.
    for is_sure in [true, true, true, false, false] {
        let (mut tested, mut untested) = (vec![false; count], remaining);
        while remaining > 3 && untested > 0 {
            let [previous, next] = [ring.previous[at], ring.next[at]];
            if tested[at] || !ring.is_ear(at, is_sure) {
                tested[at] = true;
                untested -= 1;
            } else {
                triangles.push([previous, at, next]);
                (ring.next[previous], ring.previous[next]) = (next, previous);
                (tested[previous], tested[next]) = (false, false);
                remaining -= 1;
                untested = remaining;
            }
            at = next;
        }
    }
    let last = [ring.previous[at], at, ring.next[at]];
    let (orientation, rounding) = ring.orientation(last.map(|corner| corners[corner]));
    triangles.push(last);
    (remaining == 3 && orientation >= -rounding).then_some(triangles)
}

/// The corners that are not yet cut off.
struct Ring<'a> {
    corners: &'a [DVec2],
    error: f64,
    next: Vec<usize>,
    previous: Vec<usize>,
}

impl Ring<'_> {
    /// Returns twice the area of a triangle, above 0 if it runs counterclockwise, and the largest value that rounding
    /// makes of 0.
    fn orientation(&self, [a, b, c]: [DVec2; 3]) -> (f64, f64) {
        let (along, across, opposite) = (b - a, c - a, c - b);
        (along.perp_dot(across), self.error * (along.length() + across.length() + opposite.length()))
    }

    /// Returns whether a corner can be cut off: with certainty if `is_sure`, otherwise as far as rounding allows one to
    /// tell.
    fn is_ear(&self, at: usize, is_sure: bool) -> bool {
        let (first, last) = (self.previous[at], self.next[at]);
        let [a, b, c] = [first, at, last].map(|corner| self.corners[corner]);
        let is_left = |from: DVec2, to: DVec2, point: DVec2, sure: bool| {
            let (orientation, rounding) = self.orientation([from, to, point]);
            orientation > if sure { rounding } else { -rounding }
        };
        if !is_left(a, b, c, is_sure) {
            return false;
        }
        let mut other = self.next[last];
        while other != first {
            let point = self.corners[other];
            let is_inside = [[a, b], [b, c], [c, a]].iter().all(|&[from, to]| is_left(from, to, point, !is_sure));
            if is_inside && point != a && point != b && point != c {
                return false;
            }
            other = self.next[other];
        }
        true
    }

    fn crosses_itself(&self) -> bool {
        let count = self.corners.len();
        let side = |at: usize| [self.corners[at], self.corners[(at + 1) % count]];
        let cross =
            |one: usize, other: usize| self.separates(side(one), side(other)) && self.separates(side(other), side(one));
        (0..count).any(|one| (one + 2..count).any(|other| cross(one, other)))
    }

    /// Returns whether two points lie on different sides of the line through two others.
    fn separates(&self, [from, to]: [DVec2; 2], points: [DVec2; 2]) -> bool {
        let [(one, near), (other, far)] = points.map(|point| self.orientation([from, to, point]));
        one.abs() > near && other.abs() > far && (one > 0.0) != (other > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    fn area(corners: &[DVec2]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        0.5 * corners.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    }

    /// Returns whether the polygon is cut. The triangles lie side by side if none has a negative area and their total
    /// area is that of the polygon.
    fn is_cut(corners: &[DVec2]) -> bool {
        let Some(triangles) = clip_ears(corners, 1e-15) else { return false };
        let areas: Vec<f64> = triangles.iter().map(|corner| area(&corner.map(|at| corners[at]))).collect();
        assert_eq!(areas.len(), corners.len() - 2);
        assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
        assert!((areas.iter().sum::<f64>() - area(corners)).abs() < 1e-12);
        true
    }

    /// Returns whether the polygon is cut, whichever corner is listed first.
    fn is_cut_from_any_corner(corners: &[[f64; 2]]) -> bool {
        (0..corners.len()).all(|first| {
            let rotated: Vec<DVec2> =
                corners.iter().cycle().skip(first).take(corners.len()).map(|&corner| corner.into()).collect();
            is_cut(&rotated)
        })
    }

    #[test]
    fn polygons_are_cut_into_triangles_that_lie_side_by_side() {
        let dart = [[0.0, 0.0], [2.0, 2.0], [0.0, 0.5], [-2.0, 2.0]];
        let corner = [[-1.0, -1.0], [1.0, -1.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0]];
        let points_on_sides = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [1.0, 1.0], [0.0, 1.0]];
        // Around a square hole, and back the same way.
        let hole = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [3.0, 3.0],
            [3.0, 1.0],
            [1.0, 1.0],
        ];
        for polygon in [&dart[..], &corner, &points_on_sides, &hole] {
            assert!(is_cut_from_any_corner(polygon), "{polygon:?}");
        }
        let comb = |i: u32| [f64::from(i), if i.is_multiple_of(2) { 0.1 } else { 9.0 }];
        let comb: Vec<[f64; 2]> = (0..60).rev().map(comb).chain([[-1.0, -1.0], [60.0, -1.0]]).collect();
        assert!(is_cut_from_any_corner(&comb));
        let around = |i: u32, distance: f64| DVec2::from_angle(f64::from(i) / 40.0 * TAU) * distance;
        let out = (0..120).map(|i| around(i, 1.0 + f64::from(i) / 40.0));
        let spiral: Vec<DVec2> = out.chain((0..120).rev().map(|i| around(i, 0.7 + f64::from(i) / 40.0))).collect();
        assert!(is_cut(&spiral));
    }

    #[test]
    fn polygons_whose_sides_cross_are_not_cut() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(DVec2::from);
        assert_eq!(clip_ears(&bow, 1e-15), None);
        let star: Vec<DVec2> = (0..5).map(|i| DVec2::from_angle(f64::from(i) * 0.4 * TAU)).collect();
        assert_eq!(clip_ears(&star, 1e-15), None);
        assert_eq!(clip_ears(&[DVec2::NAN; 5], 1e-15), None);
        assert_eq!(clip_ears(&[DVec2::ONE; 2], 1e-15), None);
    }

    #[test]
    fn cutting_a_polygon_of_one_point_or_one_line_ends() {
        for count in [3, 4, 50] {
            let _ = clip_ears(&vec![DVec2::ONE; count], 1e-15);
            let line: Vec<DVec2> = (0..count).map(|i| DVec2::splat((i * 7 % count) as f64)).collect();
            let _ = clip_ears(&line, 1e-15);
        }
    }
}
