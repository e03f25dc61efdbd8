//! Shapes as authors write them.

use crate::shape::Shape;

/// A shape before any transform.
pub(super) struct ShapeText<'d> {
    pub(super) shape: Shape,
    /// The file that it was read from.
    pub(super) file: Option<&'d str>,
}

impl From<Shape> for ShapeText<'_> {
    fn from(shape: Shape) -> Self {
        Self { shape, file: None }
    }
}
