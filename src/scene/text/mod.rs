//! The text of a scene, as values with their places in it, and the messages about values that are wrong.
//!
//! The functions of `compile` that read a scene define what it may contain, and nothing else does.

mod aliases;
mod document;
mod fields;
mod include;
mod mistake;
mod named_file;
mod rows;
mod settings;
mod suggest;
mod syntax;
mod texts;
mod toml_slips;
mod tree;
mod utf8;
mod value;
mod variables;
mod words;

pub(super) use document::Document;
pub(super) use fields::{Choice, Fields};
pub(super) use include::{INCLUDE, IncludedTexts, MAX_BYTES, merge_files};
pub(super) use mistake::Mistake;
pub(super) use named_file::{Fault, FileKind, IMAGES, TABLES};
pub use rows::{Numbers, Rows};
pub(super) use settings::set;
pub(super) use texts::{LocatedBy, Texts};
pub(super) use tree::parse_toml;
pub(super) use utf8::utf8;
pub(super) use value::{Spanned, Value, above_0_to, exactly, spanned};
pub(super) use variables::{SET, substitute_variables};
pub(super) use words::{and_more, six_digits};
