//! Measured optical data, looked up by name. Written by `tools/tabulate.py`.

mod color;
mod glass;
mod metal;
mod rows;
#[cfg(test)]
mod tests;

pub use color::{Grid, color_matching, illuminant, illuminants, reflectance, reflectances};
pub use glass::{
    Formula, GLASS_MAKERS, Glass, GlassConstants, bare, glass, glass_constants, glass_makers, glass_names, glasses,
    known_as,
};
pub use metal::{Metal, metal, metal_names, metals};
