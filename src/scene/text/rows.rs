/// Rows of numbers that a program passes beside the text of a scene, where a text would be slow, as for a million
/// points.
///
/// They are the `points`, `faces`, `normals` or `uv` of a mesh, whose value is then their [`mark`](Self::mark).
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Numbers per row, 1 or more.
    pub width: usize,
    /// All rows, one after another.
    pub numbers: Numbers,
}

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Coordinates.
    Real(Vec<f64>),
    /// Indices of points.
    Whole(Vec<u32>),
}

/// A prefix that no text written by a person has.
const PREFIX: &str = "\0rows ";

impl Rows {
    /// Returns the text that stands for the rows at a position.
    pub fn mark(position: usize) -> String {
        format!("{PREFIX}{position}")
    }

    /// Returns the position of the rows that a text stands for, if it does.
    pub(super) fn marked_position(text: &str) -> Option<usize> {
        text.strip_prefix(PREFIX)?.parse().ok()
    }

    /// Passes all bytes of the rows to `add`.
    pub(in crate::scene) fn digest(&self, mut add: impl FnMut(&[u8])) {
        add(&self.width.to_le_bytes());
        match &self.numbers {
            Numbers::Real(numbers) => numbers.iter().for_each(|number| add(&number.to_le_bytes())),
            Numbers::Whole(numbers) => numbers.iter().for_each(|number| add(&number.to_le_bytes())),
        }
    }
}
