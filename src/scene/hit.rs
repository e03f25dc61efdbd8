//! Ray hits, and the surfaces at both ends of a ray.

use crate::shape::Intersection;

/// The first intersection of a ray with the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object that was hit.
    pub object: u32,
    /// The intersection with it.
    pub intersection: Intersection,
}

impl Hit {
    /// Returns the primitive that was hit.
    pub fn primitive(&self) -> Primitive {
        Primitive { object: self.object, part: self.intersection.part }
    }
}

/// A part of an object: a triangle of its mesh, a face of its cube, or all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// The object.
    pub object: u32,
    /// The part; 0 for other shapes.
    pub part: u32,
}

impl Primitive {
    /// No primitive.
    pub(super) const NONE: Self = Self { object: u32::MAX, part: 0 };

    /// Returns the part, if it belongs to this object.
    pub(super) fn part_of(self, object: u32) -> Option<u32> {
        (self.object == object).then_some(self.part)
    }
}

/// The surfaces that a ray leaves and leads to, if there are any.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayEnds {
    /// The primitive that the ray leaves. A ray that leaves a triangle cannot hit it again, so this triangle is not
    /// tested.
    pub start: Option<Primitive>,
    /// The object of the light that the ray leads to, which does not occlude itself unless `part` is given.
    pub light: Option<u32>,
    /// The triangle of that object that the ray leads to. The object's other triangles can occlude it.
    pub part: Option<u32>,
}

impl From<Option<u32>> for RayEnds {
    fn from(light: Option<u32>) -> Self {
        Self { light, ..Self::default() }
    }
}
