//! The architecture of the source: a room uses only rooms on lower floors, as drawn in `src/lib.rs`. Files form no
//! cycles. A type's inherent `impl` stands in the file that defines it. Files, functions and comments are short enough
//! to read.
//!
//! ```text
//! cargo test --test all floors::
//! ```
//!
//! Each law is a function of the files' texts, and a test shows it a violation that it has to notice. Lists of
//! exceptions are exact: an entry that is no longer needed fails as well, and a failure prints the list as it should
//! be.

mod circles;
mod exceptions;
mod house;
mod laws;
mod rooms;
mod source;
