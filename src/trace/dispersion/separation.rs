//! How far dispersion pulls colors apart, measured by rays of two colors that start the same way.

use super::caustic_separation::lit_pixels;
use super::color_walk::Colors;
use super::search::search;
use super::targets::{SEEN_PIXELS, Targets};
use crate::spectrum::Draw;
use crate::trace::World;

/// The result of tracing rays of two colors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersion {
    /// Share of the view that is on dispersive surfaces.
    pub seen: f64,
    /// How many pixels apart 400 and 700 nm are behind dispersive surfaces, on a fifth of a pixel or more.
    pub seen_pixels: f64,
    /// How many pixels apart light of 400 and 700 nm lands on visible diffuse surfaces, after dispersive ones.
    pub lit_pixels: f64,
    /// Whether no ray that hit a dispersive surface saw anything, so that nothing is known about what is seen.
    pub dark: bool,
}

impl Dispersion {
    /// Returns whether lanes have to part.
    pub fn is_visible(&self) -> bool {
        self.dark || self.seen_pixels.max(self.lit_pixels) >= SEEN_PIXELS
    }
}

/// The colors whose paths are compared, in nm. Nearly everything that is seen lies between them.
pub const COLORS_NM: [f64; 2] = [400.0, 700.0];

/// Traces some thousand rays, however many pixels there are, through a world of two lanes, those of [`COLORS_NM`].
pub fn dispersion(world: &World) -> Dispersion {
    let colors = Colors { world, draw: Draw::fixed(2) };
    let targets = Targets::new(&colors);
    let found = search(&colors, &targets);
    let lit_pixels = lit_pixels(&colors, &targets, &found.reached);
    Dispersion { seen: found.dispersive_share, seen_pixels: found.pixels, lit_pixels, dark: found.dark }
}
