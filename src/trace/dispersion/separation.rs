//! How far dispersion pulls colors apart, measured by rays of two colors that are sent the same way.

use super::color_walk::Colors;
use super::lit::lit_pixels;
use super::search::search;
use super::targets::{SEEN_PIXELS, Targets};
use crate::spectrum::Draw;
use crate::trace::World;

/// What rays of two colors found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispersion {
    /// Share of the view that is on dispersive surfaces.
    pub seen: f64,
    /// How many pixels apart 400 and 700 nm are behind dispersive surfaces, on a fifth of a pixel or more.
    pub seen_pixels: f64,
    /// How many pixels apart light of 400 and 700 nm lands on diffuse surfaces that are seen, after dispersive ones.
    pub lit_pixels: f64,
    /// Whether no ray that went by a dispersive surface saw anything, so that nothing is known of what is seen.
    pub dark: bool,
}

impl Dispersion {
    /// Whether lanes have to part.
    pub fn is_visible(&self) -> bool {
        self.dark || self.seen_pixels.max(self.lit_pixels) >= SEEN_PIXELS
    }
}

/// The colors whose ways are compared, in nm: between them lies nearly all that is seen.
pub const COLORS_NM: [f64; 2] = [400.0, 700.0];

/// Sends some thousand rays through a world of two lanes, those of [`COLORS_NM`]; as many for any number of pixels.
pub fn dispersion(world: &World) -> Dispersion {
    let colors = Colors { world, draw: Draw::fixed(2) };
    let targets = Targets::new(&colors);
    let found = search(&colors, &targets);
    let lit_pixels = lit_pixels(&colors, &targets, &found.reached);
    Dispersion { seen: found.seen, seen_pixels: found.pixels, lit_pixels, dark: found.dark }
}
