/// The sides of a surface that emit light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sides {
    /// Front and back.
    #[default]
    Both,
    /// The front alone; the back is black.
    Front,
}

impl Sides {
    /// Returns whether the front emits light if `front`, otherwise whether the back does.
    pub fn shine(self, front: bool) -> bool {
        front || self == Self::Both
    }
}
