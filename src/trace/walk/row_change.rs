//! How a surface changes rows of Stokes weights.

use std::array::from_fn;

use super::rotation::Rotation;
use crate::material::{Block, Mueller};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// The weights of S0 in each of K rows, then those of S1, S2 and S3.
pub type Weights<const K: usize> = [[f32; K]; 4];

/// How a Mueller matrix changes rows.
#[derive(Clone, Debug)]
pub struct Change<const N: usize> {
    /// The part of unpolarized light that leaves.
    pub value: Lanes<N>,
    /// The factor that makes rows relative to the throughput beyond.
    pub scale: Lanes<N>,
    /// Rotation from the frame before the surface to that of the block.
    pub to_block: Rotation,
    /// Rotations from the frame before the surface to that of the base, and from there to the frame beyond.
    pub base: [Rotation; 2],
    /// The x axis of the frame beyond.
    pub x: DVec3,
    /// The only lane that goes this way, if there is just one. Changing it alone takes a fraction of the time.
    pub only_lane: Option<usize>,
}

impl<const N: usize> Change<N> {
    pub const NONE: Self = Self {
        value: Lanes::ZERO,
        scale: Lanes::ZERO,
        to_block: Rotation::NONE,
        base: [Rotation::NONE; 2],
        x: DVec3::ZERO,
        only_lane: None,
    };

    /// Returns the rows of one lane beyond the surface, not yet relative to what leaves.
    #[inline(always)]
    pub fn apply_block<const K: usize>(&self, block: &Block<Lanes<N>>, i: usize, weights: Weights<K>) -> Weights<K> {
        let [q0, q1, q2, q3] = weights;
        let [r1, r2] = self.to_block.apply(q1, q2);
        let (value, a, d, c, q) = (self.value[i], block.a[i], block.d[i], block.c[i], block.q[i]);
        [
            from_fn(|k| value * q0[k] + d * r1[k]),
            from_fn(|k| d * q0[k] + a * r1[k]),
            from_fn(|k| c * r2[k] + q * q3[k]),
            from_fn(|k| c * q3[k] - q * r2[k]),
        ]
    }

    /// Returns the rows of one lane beyond a surface, with light from below its coat, not yet relative to what leaves.
    #[inline(always)]
    pub fn apply<const K: usize>(&self, mueller: &Mueller<N>, i: usize, weights: Weights<K>) -> Weights<K> {
        let mut after = self.apply_block(&mueller.block, i, weights);
        if let Some(base) = &mueller.base {
            let ([q0, q1, q2, _], [turn, back]) = (weights, self.base);
            let [u1, _] = turn.apply(q1, q2);
            let [v1, v2] = back.apply(from_fn(|k| base.arriving[i] * q0[k] + base.both[i] * u1[k]), [0.0; K]);
            for k in 0..K {
                after[0][k] += base.leaving[i] * u1[k];
                after[1][k] += v1[k];
                after[2][k] += v2[k];
            }
        }
        after
    }
}
