//! The dimensions of a camera sample: what its random numbers are used for, and which are jointly well distributed.
//!
//! The light that edges and bumps hide differs from place to place in a pixel. At the first surface, the directions to
//! lights and of bounces are therefore well distributed over each part of the pixel, and not only over the whole pixel.
//! Later surfaces have points of their own.

use crate::math::{BranchKey, Sampler};
use crate::trace::walk::Path;

/// Use of the camera's numbers, which have the key of the first vertex: two for the place in the pixel and one for the
/// wavelengths, and two for the place on the lens.
pub const PLACE: u32 = 0;
pub const LENS: u32 = 3;
/// Use of the numbers for directions at a vertex. The walk uses 2 to choose branches, and 4 at the first hit.
const SCATTER: u32 = 1;
/// Use of the numbers that choose vertices of light paths.
pub const VERTEX: u32 = 5;
/// Use of the number that decides whether a path ends where its light was estimated at light vertices.
pub const COMPLEMENT: u32 = 6;
/// Use of the numbers for the directions by which the albedo is estimated.
pub const ALBEDO: u32 = 7;
/// Use of the numbers for the points of samples that are aimed at highlights.
pub const HIGHLIGHT: u32 = 8;
/// Use of the numbers that add digits to the choice of a light. They are plain numbers, unlike those of the lens.
pub const MORE_DIGITS: u32 = 3;
/// Use of the numbers for directions to further lights, from this one on: two lights for each use.
pub const FURTHER_LIGHTS: u32 = 16;
/// Surfaces of a path whose directions are drawn from a sequence that is well distributed over the pixel's samples.
/// Behind them the samples see so many different places that plain random numbers, which cost less, are used.
const SEQUENCE_SURFACES: u32 = 4;

/// Returns the numbers for a surface that scatters widely: two for the direction to a light, two for the bounce.
pub fn scatter<const N: usize, P>(sampler: &Sampler, path: &Path<N, P>) -> [f64; 4] {
    if path.key == BranchKey::CAMERA {
        sampler.conditional_pairs(PLACE, path.key, SCATTER)
    } else if path.vertices <= SEQUENCE_SURFACES {
        sampler.get_4d(path.key, SCATTER)
    } else {
        sampler.get_random_4d(path.key, SCATTER)
    }
}
