//! Boxes around pieces of long shapes.
//!
//! A long diagonal shape leaves most of its box empty: among blades and wires, rays enter many boxes for nothing. Cut
//! across its longest axis, the shape has a box for each piece, just as triangles have for their
//! [`fragments`](super::fragments).

use crate::math::{Bounds, DVec3};

/// Minimum gain of a further piece, in multiples of half the surface area of a box that the shape would fill. It is
/// smaller than for triangles, because several of those are tested at once.
const MIN_GAIN: f64 = 2.0;
/// Maximum number of pieces of a shape.
const MAX_PIECES: usize = 16;
/// Maximum number of pieces in a scene, because their boxes take memory. If this leaves fewer than two pieces for each
/// shape, each may still have two.
const MAX_SCENE_PIECES: usize = 1 << 20;

/// A volume that contains a shape, which may be diagonal: `center`, plus or minus up to each of three axes. If
/// `is_round`, it is the ellipsoid with these axes, otherwise all that lies between.
pub(super) struct Hull {
    center: DVec3,
    /// Half axes, the longest one first.
    axes: [DVec3; 3],
    is_round: bool,
    /// How far rounding may move points of the shape outside.
    pad: DVec3,
}

impl Hull {
    pub(super) fn new(center: DVec3, mut axes: [DVec3; 3], is_round: bool, pad: DVec3) -> Self {
        axes.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
        Self { center, axes, is_round, pad }
    }

    /// Returns the number of pieces that are worth their boxes in a scene of `shapes` shapes.
    pub(super) fn count(&self, shapes: usize) -> usize {
        let [a, b, c] = self.axes.map(|axis| 2.0 * axis.length());
        let (max_pieces, min_gain) =
            (MAX_PIECES.min((MAX_SCENE_PIECES / shapes.max(1)).max(2)), MIN_GAIN * (a * b + b * c + c * a));
        let surface = |count| self.pieces(count).map(|piece| piece.half_area()).sum::<f64>();
        let (mut count, mut current) = (1, surface(1));
        while 2 * count <= max_pieces {
            let next = surface(2 * count);
            if current - next <= count as f64 * min_gain {
                break;
            }
            (count, current) = (2 * count, next);
        }
        count
    }

    /// Returns the boxes of `count` pieces of equal length.
    pub(super) fn pieces(&self, count: usize) -> impl Iterator<Item = Bounds> {
        let [a, b, c] = self.axes;
        let half = 1.0 / count as f64;
        (0..count).map(move |piece| {
            let middle = (2 * piece + 1) as f64 * half - 1.0;
            let across = if self.is_round {
                let nearest = (middle.abs() - half).max(0.0);
                (b * b + c * c).map(f64::sqrt) * (1.0 - nearest * nearest).sqrt()
            } else {
                b.abs() + c.abs()
            };
            let (center, reach) = (self.center + a * middle, a.abs() * half + across + self.pad);
            Bounds { min: center - reach, max: center + reach }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Frame;

    /// Returns the surface area of the boxes of a shape, divided by that of a single box. The shape has three half axes
    /// of the given lengths in a frame.
    fn area_ratio(axes: [f64; 3], frame: &Frame, is_round: bool) -> f64 {
        let [x, y, z] = axes;
        let axes = [DVec3::X * x, DVec3::Y * y, DVec3::Z * z].map(|axis| frame.to_world(axis));
        let hull = Hull::new(DVec3::ONE, axes, is_round, DVec3::ZERO);
        let surface = |count| hull.pieces(count).map(|piece| piece.half_area()).sum::<f64>();
        surface(hull.count(1)) / surface(1)
    }

    /// Row B6 of the stability catalog.
    #[test]
    fn b6_long_shapes_that_run_aslant_have_boxes_of_their_pieces_and_others_have_one() {
        let aslant = Frame::about(DVec3::new(0.5, 0.6, 0.7).normalize());
        let straight = Frame::about(DVec3::Z);
        for is_round in [false, true] {
            let area_ratio = |axes, frame: &Frame| area_ratio(axes, frame, is_round);
            assert!(area_ratio([0.001, 0.001, 1.0], &aslant) < 0.1);
            assert!(area_ratio([0.01, 0.0, 1.0], &aslant) < 0.4);
            assert!(area_ratio([0.1, 0.1, 1.0], &aslant) < 0.8);
            for (axes, frame) in [([0.001, 0.001, 1.0], &straight), ([0.5, 0.5, 1.0], &aslant)] {
                assert_eq!(area_ratio(axes, frame), 1.0, "{axes:?}");
            }
        }
    }
}
