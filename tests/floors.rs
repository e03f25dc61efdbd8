//! The house stays a house: a room uses only rooms on lower floors, as the drawing in `src/lib.rs` has them; no files
//! stand in a circle; a type's own `impl` stands beside it; files, functions and comments are short enough to read.
//!
//! ```text
//! cargo test --test all floors::
//! ```
//!
//! Each law is a function of the files' texts, and a test shows it a breach that it has to notice. A list of exceptions
//! is exact: an entry that is no longer needed fails as well, and a failure prints the list as it would have to be.

mod circles;
mod exceptions;
mod house;
mod laws;
mod rooms;
mod source;
