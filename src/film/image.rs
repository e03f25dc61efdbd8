//! An image: its pixels and what they mean.

use super::cryptomatte::Manifest;
use super::layers::LayerImage;
use super::spectral::SpectralImage;
use crate::spectrum::ColorSpace;

/// Depth of a pixel whose rays meet nothing, the value compositing packages expect.
pub const DEPTH_OF_NOTHING: f32 = 1e10;

/// What one camera sample saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Film red, green and blue, linear.
    pub rgb: [f64; 3],
    /// Depth of what the camera ray met, if it met anything.
    pub depth: Option<f64>,
}

/// A finished pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Film red, green and blue, linear, the mean of the samples.
    pub rgb: [f32; 3],
    /// Share of the camera rays that met something.
    pub alpha: f32,
    /// The nearest depth among the samples, [`DEPTH_OF_NOTHING`] where none met anything.
    pub depth: f32,
    /// How many samples the mean is made of.
    pub samples: f32,
}

/// A part of an image, in pixels from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Its first column.
    pub left: u32,
    /// Its first row.
    pub top: u32,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Window {
    /// The pixel of the full image in the middle of a cell, of `side` x `side` cells of the window that are counted row
    /// by row.
    pub fn middle_of_cell(&self, side: u32, cell: u32) -> [u32; 2] {
        let middle = |i: u32, size: u32| ((u64::from(2 * i + 1) * u64::from(size)) / u64::from(2 * side)) as u32;
        [self.left + middle(cell % side, self.width), self.top + middle(cell / side, self.height)]
    }
}

/// A finished image or part of one, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Column and row of the first pixel in the full image.
    pub corner: [u32; 2],
    /// Pixels per row and rows of the full image.
    pub full: [u32; 2],
    /// What red, green and blue mean.
    pub color_space: ColorSpace,
    /// `width * height` pixels, row by row.
    pub pixels: Vec<Pixel>,
    /// What was asked for beside them.
    pub layers: Vec<LayerImage>,
    /// Their spectra, if those were asked for.
    pub spectral: Option<SpectralImage>,
    /// What the numbers of their mattes stand for.
    pub manifests: Vec<Manifest>,
}

impl Film {
    /// The pixel in column x, row y of the part that is there.
    pub fn at(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[(y as usize) * self.width as usize + x as usize]
    }
}
