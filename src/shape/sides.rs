/// Which sides of a surface shine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Front and back.
    #[default]
    Both,
    /// The front alone; the back is black.
    Front,
}

impl Sides {
    /// Whether the front (or the back) shines.
    pub fn shine(self, front: bool) -> bool {
        front || self == Self::Both
    }
}
