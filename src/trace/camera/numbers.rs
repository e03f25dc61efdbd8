//! The random numbers of a camera sample, and which of them are spread evenly together.
//!
//! What edges and bumps hide of the light differs from place to place in a pixel. So the directions to lights and of
//! bounces are spread evenly, at the first surface, over each part of the pixel and not over the pixel alone. Later
//! surfaces have points of their own.

use crate::math::{BranchKey, Sampler};
use crate::trace::walk::Path;

/// Use of the camera's numbers, which have the first vertex's key: two for the place in the pixel and one for the
/// wavelengths, and two for the place on the lens.
pub const PLACE: u32 = 0;
pub const LENS: u32 = 3;
/// Use of the numbers at a vertex: directions. The walk has 2, which branches are followed, and 4, the first hit.
const SCATTER: u32 = 1;
/// Which vertices of light paths are looked at.
pub const VERTEX: u32 = 5;
/// Whether a path ends where its light was looked for there.
pub const COMPLEMENT: u32 = 6;
/// The directions by which albedo is found.
pub const ALBEDO: u32 = 7;
/// More digits of what chooses a light; these are plain numbers, and those of the lens are not.
pub const MORE_DIGITS: u32 = 3;
/// Directions to further lights, two to each use from this one on.
pub const FURTHER_LIGHTS: u32 = 16;
/// Surfaces of a path whose directions are drawn from a sequence spread over the pixel's samples. Behind them the
/// samples see so many different places that plain random numbers, which cost less, are taken.
const SPREAD: u32 = 4;

/// At a surface that scatters widely: two numbers for the direction to a light, two for that of the bounce.
pub fn scatter<const N: usize, P>(sampler: &Sampler, path: &Path<N, P>) -> [f64; 4] {
    if path.key == BranchKey::CAMERA {
        sampler.pairs_beside(PLACE, path.key, SCATTER)
    } else if path.vertices <= SPREAD {
        sampler.four(path.key, SCATTER)
    } else {
        sampler.four_plain(path.key, SCATTER)
    }
}
