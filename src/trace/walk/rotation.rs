//! Rotations between the frames of a ray's polarization.

use std::array::from_fn;

use crate::math::{DVec3, Frame};

/// A rotation of the frame of Stokes vectors: cosine and sine of twice the angle from one reference direction to
/// another, about the direction z of the light.
#[derive(Clone, Copy, Debug)]
pub struct Rotation(f32, f32);

impl Rotation {
    pub const NONE: Self = Self(1.0, 0.0);

    /// Returns the rotation from `x`, of any length; `None` if either direction has no component perpendicular to z.
    pub fn new(z: DVec3, x: DVec3, to: DVec3) -> Option<Self> {
        let (c, t) = (x.dot(to), z.cross(x).dot(to));
        let length = c * c + t * t;
        let inverse = 1.0 / length;
        (length > 0.0).then_some(Self(((c * c - t * t) * inverse) as f32, (2.0 * c * t * inverse) as f32))
    }

    /// Rotates the linear components, 1 and 2.
    #[inline(always)]
    pub fn apply<const K: usize>(self, one: [f32; K], two: [f32; K]) -> [[f32; K]; 2] {
        let Self(c, s) = self;
        [from_fn(|k| one[k] * c + two[k] * s), from_fn(|k| two[k] * c - one[k] * s)]
    }
}

/// Returns a unit vector perpendicular to z, near a direction.
pub fn perpendicular(z: DVec3, near: DVec3) -> DVec3 {
    (near - z * z.dot(near)).try_normalize().unwrap_or_else(|| Frame::about(z).to_world(DVec3::X))
}
