//! An image: its pixels and what they mean.

use serde::{Deserialize, Serialize};

use super::cryptomatte::Manifest;
use super::layers::LayerImage;
use super::spectral::SpectralImage;
use super::window::Window;
use crate::spectrum::ColorSpace;

/// Depth of a pixel whose rays meet nothing, the value compositing packages expect.
pub const DEPTH_OF_NOTHING: f32 = 1e10;

/// What one camera sample saw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Film red, green and blue, linear.
    pub rgb: [f64; 3],
    /// Depth of the surface that the camera ray hit, if it hit any.
    pub depth: Option<f64>,
    /// Whether it fell where the filter is negative.
    pub is_subtracted: bool,
}

/// A finished pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pixel {
    /// Film red, green and blue, linear, the mean of the samples as the filter weighs them.
    pub rgb: [f32; 3],
    /// Share of the camera rays that hit something, weighed by the filter, from 0 to 1.
    pub alpha: f32,
    /// The nearest depth among the samples, [`DEPTH_OF_NOTHING`] where none met anything.
    pub depth: f32,
    /// How many samples the mean is made of.
    pub samples: f32,
}

impl Pixel {
    /// One of which nothing is known.
    pub(super) const BLANK: Self = Self { rgb: [0.0; 3], alpha: 0.0, depth: 0.0, samples: 0.0 };
}

/// A finished image, with its overscan or a part of it, rows from the top.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Column and row of the first pixel, counted from the top left corner of the format: negative in its overscan.
    pub corner: [i32; 2],
    /// Pixels per row and rows of the format.
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
    /// Which pixels of the format it has.
    pub fn window(&self) -> Window {
        let [left, top] = self.corner;
        Window { left, top, width: self.width, height: self.height }
    }

    /// Makes room for a number of rows.
    pub fn resize(&mut self, rows: u32) {
        self.height = rows;
        let pixels = self.width as usize * rows as usize;
        self.pixels.resize(pixels, Pixel::BLANK);
        self.layers.iter_mut().for_each(|layer| layer.values.resize(pixels * layer.numbers(), 0.0));
        if let Some(spectral) = &mut self.spectral {
            spectral.values.resize(pixels * spectral.numbers(), 0.0);
        }
    }

    /// The pixel in column x, row y of the part that is there.
    pub fn at(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[(y as usize) * self.width as usize + x as usize]
    }
}
