//! Images that bend an object's normal, as the file says.
//!
//! They belong to the object and not to its material: a depth is a length on it, one material serves flat and dented things,
//! and of a mix or a mask it is clear which normal counts.

use serde::Deserialize;

use crate::spectrum::{Channel, Encoding, Wrap, number_or_two};

/// ```toml
/// normal_map = { image = "wall_normal.png", repeat = 2, strength = 1 }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalMapText {
    /// Directions: red along u, green along v, blue out of the surface, one half being none.
    pub image: String,
    /// How often it fits into one unit of u and of v.
    #[serde(default, deserialize_with = "number_or_two")]
    pub repeat: Option<[f64; 2]>,
    /// What there is beyond it.
    #[serde(default)]
    pub wrap: Wrap,
    /// Linear, if anything.
    pub encoding: Option<Encoding>,
    /// Factor on red and green; 1 if absent.
    pub strength: Option<f64>,
}

/// ```toml
/// bump_map = { image = "height.png", repeat = 2, depth = 0.02 }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BumpMapText {
    /// Heights.
    pub image: String,
    /// The one number of each texel that is read; the mean of all three if absent.
    pub channel: Option<Channel>,
    /// How often it fits into one unit of u and of v.
    #[serde(default, deserialize_with = "number_or_two")]
    pub repeat: Option<[f64; 2]>,
    /// What there is beyond it.
    #[serde(default)]
    pub wrap: Wrap,
    /// Linear, if anything.
    pub encoding: Option<Encoding>,
    /// Height of white over black in scene units; below 0 white lies deeper.
    pub depth: f64,
}
