//! Images that hold a spectrum in each pixel.

use serde::{Deserialize, Serialize};

use crate::spectrum::WavelengthBands;

/// The spectra of an image's pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectralImage {
    /// Where their bands lie.
    pub bands: WavelengthBands,
    /// The radiance of all bands of a pixel, pixel by pixel from the top left; per nm, the mean over the band.
    pub values: Vec<f32>,
}

impl SpectralImage {
    /// The radiance of all bands of a pixel, by its number.
    pub fn pixel(&self, number: usize) -> &[f32] {
        &self.values[number * self.bands.count()..][..self.bands.count()]
    }
}
