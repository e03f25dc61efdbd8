//! A mistake in the texts of a scene.

use std::ops::Range;

/// What is wrong with a scene, and where.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Mistake {
    /// The bytes that are wrong.
    pub(in crate::scene) span: Range<usize>,
    pub(in crate::scene) message: String,
    /// What to do.
    pub(in crate::scene) help: Option<String>,
}
