//! Shapes as authors write them.

use crate::shape::Shape;

/// A shape before any transform.
pub(super) struct Written<'d> {
    pub(super) shape: Shape,
    /// The file that it is read from.
    pub(super) file: Option<&'d str>,
    /// The edges of a cube, or of that around a sphere.
    pub(super) edges: Option<[f64; 3]>,
}

impl From<Shape> for Written<'_> {
    fn from(shape: Shape) -> Self {
        let edges = match &shape {
            Shape::Sphere(_) => shape.bounds().map(|bounds| (bounds.max - bounds.min).to_array()),
            _ => None,
        };
        Self { shape, file: None, edges }
    }
}
