//! What rays meet, leave and lead to.

use crate::shape::Intersection;

/// Where a ray first meets the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object met.
    pub object: u32,
    /// Where on it.
    pub intersection: Intersection,
}

impl Hit {
    /// What was met.
    pub fn primitive(&self) -> Primitive {
        Primitive { object: self.object, part: self.intersection.part }
    }
}

/// A part of an object: a triangle of its mesh, a face of its cube, or all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// The object.
    pub object: u32,
    /// The part, 0 of other shapes.
    pub part: u32,
}

impl Primitive {
    /// None.
    pub(super) const NONE: Self = Self { object: u32::MAX, part: 0 };

    /// The part, if it is one of this object.
    pub(super) fn of(self, object: u32) -> Option<u32> {
        (self.object == object).then_some(self.part)
    }
}

/// What a ray leads from and to, if those are surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayEnds {
    /// What the ray leaves. A triangle is not met again by a ray that leaves it, which is not tested.
    pub left: Option<Primitive>,
    /// The object of the light that it leads to, which does not occlude itself ..
    pub light: Option<u32>,
    /// .. but where one of its triangles is meant, which the others do occlude.
    pub part: Option<u32>,
}

impl From<Option<u32>> for RayEnds {
    fn from(light: Option<u32>) -> Self {
        Self { light, ..Self::default() }
    }
}
