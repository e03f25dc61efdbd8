/// Rows of numbers that a program gives beside the text of a scene, where text would be slow: a million points.
///
/// They stand for the `points`, `faces`, `normals` or `uv` of a mesh whose value is their [`mark`](Self::mark).
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// Numbers in a row, 1 or more.
    pub width: usize,
    /// All rows, one behind the other.
    pub numbers: Numbers,
}

/// Numbers of one kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Coordinates.
    Real(Vec<f64>),
    /// Numbers of points.
    Whole(Vec<u32>),
}

/// What no text of a person begins with.
const MARK: &str = "\0rows ";

impl Rows {
    /// The text that stands for the rows of a position.
    pub fn mark(position: usize) -> String {
        format!("{MARK}{position}")
    }

    /// The position of the rows that a text stands for, if it does.
    pub(super) fn marked(text: &str) -> Option<usize> {
        text.strip_prefix(MARK)?.parse().ok()
    }

    /// Calls `add` with the bytes of all that they are.
    pub(in crate::scene) fn digest(&self, mut add: impl FnMut(&[u8])) {
        add(&self.width.to_le_bytes());
        match &self.numbers {
            Numbers::Real(numbers) => numbers.iter().for_each(|number| add(&number.to_le_bytes())),
            Numbers::Whole(numbers) => numbers.iter().for_each(|number| add(&number.to_le_bytes())),
        }
    }
}
