//! Access to images row by row, for writing them.

use std::ops::Range;

use super::image::Film;
use crate::error::Result;

/// The source of an image's rows while it is written, from the top down.
pub trait Rows {
    /// Returns the maximum number of rows that should be requested at once, or none if all are in memory.
    fn at_once(&self) -> Option<u32>;

    /// Returns a film that contains the requested rows, and the index in it of the first row's first pixel.
    ///
    /// # Errors
    /// If the rows cannot be read.
    fn rows(&mut self, rows: Range<u32>) -> Result<(&Film, usize)>;
}

/// An image that is in memory.
impl Rows for &Film {
    fn at_once(&self) -> Option<u32> {
        None
    }

    fn rows(&mut self, rows: Range<u32>) -> Result<(&Film, usize)> {
        Ok((self, rows.start as usize * self.width as usize))
    }
}
