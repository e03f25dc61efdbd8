//! The values of a tile, before they are copied into an image.

use serde::{Deserialize, Serialize};

use super::image::{Film, Pixel};
use super::shard::TilePlace;
use super::spectral::SpectralImage;
use super::window::Window;

/// A tile's pixels, row by row, with their values in each layer and in the spectral image.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TileValues {
    /// The pixels of the image.
    pub pixels: Vec<Pixel>,
    /// The values of each layer.
    pub layers: Vec<Vec<f32>>,
    /// The spectra, if requested.
    pub spectral: Vec<f32>,
}

impl TileValues {
    /// Creates pixels without data, with room for everything that the film has.
    pub fn blank(film: &Film, pixels: usize) -> Self {
        let layers = film.layers.iter().map(|layer| vec![0.0; pixels * layer.numbers()]).collect();
        let spectra = film.spectral.as_ref().map_or(0, SpectralImage::numbers);
        Self { pixels: vec![Pixel::BLANK; pixels], layers, spectral: vec![0.0; pixels * spectra] }
    }

    /// Returns whether there are exactly as many values as the film has in this tile.
    pub fn fit(&self, place: TilePlace, film: &Film) -> bool {
        let spectra = film.spectral.as_ref().map_or(0, SpectralImage::numbers);
        self.pixels.len() == place.pixels()
            && self.layers.iter().map(Vec::len).eq(film.layers.iter().map(|layer| place.pixels() * layer.numbers()))
            && self.spectral.len() == place.pixels() * spectra
    }

    /// Copies the values to their place in a film.
    pub fn put_into(&self, film: &mut Film, place: TilePlace) {
        let window = film.window();
        copy_rows(&self.pixels, 1, window, place, &mut film.pixels);
        for (layer, values) in film.layers.iter_mut().zip(&self.layers) {
            copy_rows(values, layer.numbers(), window, place, &mut layer.values);
        }
        if let Some(spectral) = &mut film.spectral {
            copy_rows(&self.spectral, spectral.numbers(), window, place, &mut spectral.values);
        }
    }
}

/// Copies the values of a tile, `each` per pixel, into the rows of a window.
fn copy_rows<T: Copy>(values: &[T], each: usize, window: Window, place: TilePlace, rows: &mut [T]) {
    let length = place.width as usize * each;
    for (row, values) in (0..place.height).zip(values.chunks_exact(length)) {
        let first = place.pixel(window, row * place.width) * each;
        rows[first..first + length].copy_from_slice(values);
    }
}
