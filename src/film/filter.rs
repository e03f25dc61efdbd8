use serde::Deserialize;

use crate::math::DVec2;

/// Where in its pixel a camera sample falls.
///
/// ```toml
/// film.filter = "box"        # or "center"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Filter {
    /// Anywhere in the pixel, evenly.
    #[default]
    Box,
    /// In the middle, always.
    Center,
}

impl Filter {
    /// A position within the unit pixel, y down. A sample counts for one pixel alone.
    pub fn place(self, u: [f64; 2]) -> DVec2 {
        match self {
            Self::Box => u.into(),
            Self::Center => DVec2::splat(0.5),
        }
    }

    /// The filter's name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Center => "center",
        }
    }
}
