//! Images with a spectrum in each pixel.

use serde::{Deserialize, Serialize};

use crate::spectrum::WavelengthBands;

/// The spectra of an image's pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectralImage {
    /// The wavelength bands.
    pub bands: WavelengthBands,
    /// Whether S1, S2 and S3 of each band follow the radiance, which is S0.
    pub has_stokes: bool,
    /// For each pixel from the top left, the radiance of all bands, followed by the other components in the same way if
    /// there are any. Values are per nm, the mean over the band.
    pub values: Vec<f32>,
}

impl SpectralImage {
    /// Returns the number of components of each band: S0 alone, or S0 to S3.
    pub fn components(&self) -> usize {
        if self.has_stokes { 4 } else { 1 }
    }

    /// Returns the number of values per pixel.
    pub fn numbers(&self) -> usize {
        self.components() * self.bands.count()
    }

    /// Returns the radiance of all bands of a pixel, given its index.
    pub fn pixel(&self, number: usize) -> &[f32] {
        self.component(number, 0)
    }

    /// Returns a Stokes component of all bands of a pixel, given its index.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn component(&self, number: usize, component: usize) -> &[f32] {
        let bands = self.bands.count();
        &self.values[number * self.numbers()..][..self.numbers()][component * bands..][..bands]
    }
}
