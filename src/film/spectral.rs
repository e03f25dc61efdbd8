//! Images that hold a spectrum in each pixel.

use serde::{Deserialize, Serialize};

use crate::spectrum::WavelengthBands;

/// The spectra of an image's pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpectralImage {
    /// Where their bands lie.
    pub bands: WavelengthBands,
    /// Whether S1, S2 and S3 of each band follow the radiance, which is S0.
    pub has_stokes: bool,
    /// The radiance of all bands of a pixel, and the other components in the same way if there are any, pixel by pixel
    /// from the top left; per nm, the mean over the band.
    pub values: Vec<f32>,
}

impl SpectralImage {
    /// Components of each band: S0 alone, or S0 to S3.
    pub fn components(&self) -> usize {
        if self.has_stokes { 4 } else { 1 }
    }

    /// Numbers of a pixel.
    pub fn numbers(&self) -> usize {
        self.components() * self.bands.count()
    }

    /// The radiance of all bands of a pixel, by its number.
    pub fn pixel(&self, number: usize) -> &[f32] {
        self.component(number, 0)
    }

    /// A Stokes component of all bands of a pixel, by its number.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn component(&self, number: usize, component: usize) -> &[f32] {
        let bands = self.bands.count();
        &self.values[number * self.numbers()..][..self.numbers()][component * bands..][..bands]
    }
}
