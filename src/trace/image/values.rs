//! The values of an image, made of sums.

use std::borrow::Cow;

use super::layer_sums::{ShownCounts, Taken, images, spectral_image, write};
use super::tile::Tile;
use crate::film::{LayerImage, Pixel, PixelSum, SampleWeights, SpectralImage};
use crate::trace::World;
use crate::trace::layers::Layers;

/// The values of some pixels.
pub struct Values {
    /// The image.
    pub pixels: Vec<Pixel>,
    /// The layers beside it.
    pub layers: Vec<LayerImage>,
    /// Spectra, if they are asked for.
    pub spectral: Option<SpectralImage>,
}

const BLANK: Pixel = Pixel { rgb: [0.0; 3], alpha: 0.0, depth: 0.0, samples: 0.0 };

impl Values {
    /// Of so many pixels of which nothing is known.
    pub(super) fn new(layers: &Layers, count: usize) -> Self {
        let (layers, spectral) = (images(layers, count), spectral_image(layers, count));
        Self { pixels: vec![BLANK; count], layers, spectral }
    }

    /// Of a tile's pixels, row by row.
    pub(super) fn of_tile(world: &World, tile: &Tile, counts: ShownCounts) -> Self {
        let mut values = Self::new(&world.layers, tile.sums.len());
        (0..tile.sums.len()).for_each(|place| values.write_pixel(world, tile, counts, place));
        values
    }

    /// Puts in the values of a tile, of whose pixels each has a number here.
    pub(super) fn put(&mut self, tile: &Self, number: &dyn Fn(usize) -> usize) {
        let numbers: Vec<usize> = (0..tile.pixels.len()).map(number).collect();
        numbers.iter().zip(&tile.pixels).for_each(|(&at, pixel)| self.pixels[at] = *pixel);
        let layers = self.layers.iter_mut().zip(&tile.layers).map(|(to, from)| (&mut to.values, &from.values));
        let spectral = self.spectral.iter_mut().zip(&tile.spectral).map(|(to, from)| (&mut to.values, &from.values));
        for (to, from) in layers.chain(spectral) {
            let size = from.len() / numbers.len().max(1);
            for (&at, values) in numbers.iter().zip(from.chunks_exact(size.max(1))) {
                to[size * at..][..size].copy_from_slice(values);
            }
        }
    }

    fn write_pixel(&mut self, world: &World, tile: &Tile, counts: ShownCounts, place: usize) {
        let (filter, layers) = (world.scene.film.filter, &world.layers);
        let (sum, none) = (&tile.sums[place], PixelSum::default());
        let subtracted = tile.subtracted.get(place).unwrap_or(&none);
        let weights = SampleWeights::new(filter, [sum.kept(), subtracted.kept()]);
        let shown = tile.shown_at(place).map(|x| x * counts.image);
        self.pixels[place] = sum.pixel(subtracted, &weights, shown);
        if layers.is_empty() {
            return;
        }
        let (sums, shown) = (tile.layers.rows(layers, place), tile.shown_in_layers(layers, place));
        let shown = &*times(shown, counts.image);
        let (covered, rgb) = (tile.layers.covered(), [sum.rgb(), subtracted.rgb()]);
        let variance = counts.samples.and_then(|each| tile.replicates.variance(place, filter, each));
        let taken = Taken { sums, shown, counts, variance, rgb, weights, covered, place };
        write(layers, &taken, place, &mut self.layers);
        if let (Some(image), Some(spectrum)) = (&mut self.spectral, &layers.spectrum) {
            taken.write_spectrum(spectrum, place, image);
        }
        if let Some(caught) = layers.caught(sums[0], shown, weights.added()) {
            let alpha = f64::from(self.pixels[place].alpha) + layers.luminance_caught(&caught).coverage();
            self.pixels[place].alpha = alpha.min(1.0) as f32;
        }
    }
}

/// Numbers so many times as large.
fn times(numbers: &[f64], factor: f64) -> Cow<'_, [f64]> {
    if factor == 1.0 { numbers.into() } else { numbers.iter().map(|x| x * factor).collect() }
}
