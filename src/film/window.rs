//! The window of an image: the pixels that are rendered.

/// A rectangle of pixels, relative to the top left corner of the format. It may begin left of that corner or above it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// The first column.
    pub left: i32,
    /// The first row.
    pub top: i32,
    /// The number of pixels per row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
}

impl Window {
    /// Returns the middle pixel of a cell, if the window is divided into `side` x `side` cells, counted row by row.
    pub fn middle_of_cell(&self, side: u32, cell: u32) -> [i32; 2] {
        let middle = |i: u32, size: u32| ((u64::from(2 * i + 1) * u64::from(size)) / u64::from(2 * side)) as i32;
        [self.left + middle(cell % side, self.width), self.top + middle(cell / side, self.height)]
    }

    /// Returns the cell that contains a pixel, of `side` x `side` cells counted row by row. The pixel is relative to
    /// the window's corner.
    pub fn cell_of(&self, side: u32, [x, y]: [u32; 2]) -> usize {
        let cell = |coordinate: u32, size: u32| (u64::from(coordinate) * u64::from(side) / u64::from(size)) as usize;
        cell(y, self.height) * side as usize + cell(x, self.width)
    }

    /// Returns the pixels in the middle of all `side` x `side` cells. However many are taken from the start, they are
    /// spread over the window.
    pub fn middles_of_cells(self, side: u32) -> impl Iterator<Item = [i32; 2]> {
        // A stride that is coprime to the number of cells visits them all.
        (0..side * side).map(move |i| self.middle_of_cell(side, (i * 229) % (side * side)))
    }

    /// Returns the number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Returns the first column and row, and the first ones beyond the window.
    pub fn ends(&self) -> [[i64; 2]; 2] {
        let first = [self.left, self.top].map(i64::from);
        [first, [first[0] + i64::from(self.width), first[1] + i64::from(self.height)]]
    }

    /// Returns whether the window contains all of another one.
    pub fn holds(&self, other: &Self) -> bool {
        let ([first, end], [other_first, other_end]) = (self.ends(), other.ends());
        (0..2).all(|axis| first[axis] <= other_first[axis] && other_end[axis] <= end[axis])
    }
}

/// The overscan: pixels rendered around the format, so that image processing has data beyond the edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overscan {
    /// The number of columns left of the format.
    pub left: u32,
    /// The number of rows above the format.
    pub top: u32,
    /// The number of columns right of the format.
    pub right: u32,
    /// The number of rows below the format.
    pub bottom: u32,
}

impl Overscan {
    /// Creates an overscan of the same width on all sides.
    pub fn even(pixels: u32) -> Self {
        Self { left: pixels, top: pixels, right: pixels, bottom: pixels }
    }

    /// Returns the width of the widest side.
    pub fn widest(&self) -> u32 {
        self.left.max(self.top).max(self.right).max(self.bottom)
    }
}
