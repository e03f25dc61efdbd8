//! The film: its pixels and what they mean.

use serde::{Deserialize, Serialize};

use super::cryptomatte::Manifest;
use super::layers::LayerImage;
use super::spectral::SpectralImage;
use super::window::Window;
use crate::spectrum::ColorSpace;

/// The depth of a pixel whose rays hit nothing. This is the value that compositing packages expect.
pub const DEPTH_OF_NOTHING: f32 = 1e10;

/// The result of one camera sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Linear red, green and blue in the film's color space.
    pub rgb: [f64; 3],
    /// The depth of the surface that the camera ray hit, if any.
    pub depth: Option<f64>,
    /// Whether the sample fell where the filter is negative.
    pub is_subtracted: bool,
}

/// A finished pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pixel {
    /// Linear red, green and blue in the film's color space: the mean of the samples, weighted by the filter.
    pub rgb: [f32; 3],
    /// The fraction of the camera rays that hit something, weighted by the filter, from 0 to 1.
    pub alpha: f32,
    /// The smallest depth among the samples, or [`DEPTH_OF_NOTHING`] if none hit anything.
    pub depth: f32,
    /// The number of samples in the mean.
    pub samples: f32,
}

impl Pixel {
    /// A pixel without data.
    pub(super) const BLANK: Self = Self { rgb: [0.0; 3], alpha: 0.0, depth: 0.0, samples: 0.0 };
}

/// A finished image, possibly with overscan or cropped, with rows from the top.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// The number of pixels per row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// Column and row of the first pixel, counted from the top left corner of the format. Negative in the overscan.
    pub corner: [i32; 2],
    /// The number of pixels per row and the number of rows of the format.
    pub full: [u32; 2],
    /// The color space of red, green and blue.
    pub color_space: ColorSpace,
    /// `width * height` pixels, row by row.
    pub pixels: Vec<Pixel>,
    /// The requested layers.
    pub layers: Vec<LayerImage>,
    /// The spectra of the pixels, if requested.
    pub spectral: Option<SpectralImage>,
    /// The names behind the IDs in the mattes.
    pub manifests: Vec<Manifest>,
}

impl Film {
    /// Returns the window of the format that the film covers.
    pub fn window(&self) -> Window {
        let [left, top] = self.corner;
        Window { left, top, width: self.width, height: self.height }
    }

    /// Resizes the film to a number of rows.
    pub fn resize(&mut self, rows: u32) {
        self.height = rows;
        let pixels = self.width as usize * rows as usize;
        self.pixels.resize(pixels, Pixel::BLANK);
        self.layers.iter_mut().for_each(|layer| layer.values.resize(pixels * layer.numbers(), 0.0));
        if let Some(spectral) = &mut self.spectral {
            spectral.values.resize(pixels * spectral.numbers(), 0.0);
        }
    }

    /// Returns the pixel in column x, row y of the film's window.
    pub fn at(&self, x: u32, y: u32) -> &Pixel {
        &self.pixels[(y as usize) * self.width as usize + x as usize]
    }
}
