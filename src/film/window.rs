//! Which pixels of an image there are.

/// A rectangle of pixels, counted from the top left corner of the format; it may begin left of it or above.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its first column.
    pub left: i32,
    /// Its first row.
    pub top: i32,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// The pixel in the middle of a cell, of `side` x `side` cells of the window that are counted row by row.
    pub fn middle_of_cell(&self, side: u32, cell: u32) -> [i32; 2] {
        let middle = |i: u32, size: u32| ((u64::from(2 * i + 1) * u64::from(size)) / u64::from(2 * side)) as i32;
        [self.left + middle(cell % side, self.width), self.top + middle(cell / side, self.height)]
    }

    /// The cell of a pixel that is counted from the window's corner, of `side` x `side` cells, row by row.
    pub fn cell_of(&self, side: u32, [x, y]: [u32; 2]) -> usize {
        let cell = |at: u32, size: u32| (u64::from(at) * u64::from(side) / u64::from(size)) as usize;
        cell(y, self.height) * side as usize + cell(x, self.width)
    }

    /// The pixels in the middle of all of side x side cells, far ones first: any number of them is spread over the
    /// window.
    pub fn middles_of_cells(self, side: u32) -> impl Iterator<Item = [i32; 2]> {
        // A stride that is coprime to the number of cells visits them all.
        (0..side * side).map(move |i| self.middle_of_cell(side, (i * 229) % (side * side)))
    }

    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Its first column and row, and the first ones beyond it.
    pub fn ends(&self) -> [[i64; 2]; 2] {
        let first = [self.left, self.top].map(i64::from);
        [first, [first[0] + i64::from(self.width), first[1] + i64::from(self.height)]]
    }

    /// Whether all of another window lies in it.
    pub fn holds(&self, other: &Self) -> bool {
        let ([first, end], [other_first, other_end]) = (self.ends(), other.ends());
        (0..2).all(|axis| first[axis] <= other_first[axis] && other_end[axis] <= end[axis])
    }
}

/// Pixels that are made around the format, so that work on the image finds some beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overscan {
    /// Columns before the first.
    pub left: u32,
    /// Rows above the first.
    pub top: u32,
    /// Columns behind the last.
    pub right: u32,
    /// Rows below the last.
    pub bottom: u32,
}

impl Overscan {
    /// As many pixels on all sides.
    pub fn even(pixels: u32) -> Self {
        Self { left: pixels, top: pixels, right: pixels, bottom: pixels }
    }

    /// The widest of its sides.
    pub fn widest(&self) -> u32 {
        self.left.max(self.top).max(self.right).max(self.bottom)
    }
}
