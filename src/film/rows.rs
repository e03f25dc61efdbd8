//! Images that are written row by row.

use std::ops::Range;

use super::image::Film;
use crate::error::Result;

/// Where the rows of an image come from while it is written, from the top down.
pub trait Rows {
    /// Most rows that should be asked for at once; none if all are there.
    fn at_once(&self) -> Option<u32>;

    /// Rows of the image: a film that has them, and the number in it of the first one's first pixel.
    ///
    /// # Errors
    /// If they cannot be read.
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
