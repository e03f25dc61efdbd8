//! The text of a scene as values that know where they stand, and what is told of those that are wrong.
//!
//! What a scene may hold is told in `compile`, once: by the functions that read it.

mod document;
mod fields;
mod suggest;
mod syntax;
mod value;

pub(super) use document::{Document, Mistake};
pub(super) use fields::{Choice, Fields};
pub(super) use syntax::explain;
pub(super) use value::{At, Value, above_0_to, at};
