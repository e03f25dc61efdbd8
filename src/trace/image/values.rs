//! Computes the values of an image from its sums.

use std::borrow::Cow;

use super::layer_sums::{PixelSums, SplatWeights};
use super::tile::Tile;
use crate::film::{Film, PixelSum, SampleWeights, TileValues};
use crate::trace::World;

/// Returns the values of a tile of a film.
pub fn values_of(world: &World, film: &Film, tile: &Tile, splat_weights: SplatWeights) -> TileValues {
    let mut values = TileValues::blank(film, tile.sums.len());
    (0..tile.sums.len()).for_each(|place| write_pixel(&mut values, world, tile, splat_weights, place));
    values
}

fn write_pixel(values: &mut TileValues, world: &World, tile: &Tile, splat_weights: SplatWeights, place: usize) {
    let (filter, layers) = (world.scene.film.filter, &world.layers);
    let (sum, none) = (&tile.sums[place], PixelSum::default());
    let subtracted = tile.subtracted.get(place).unwrap_or(&none);
    let weights = SampleWeights::new(filter, [sum.kept(), subtracted.kept()]);
    let splatted = tile.splatted.pixels.get(place).copied().unwrap_or_default().map(|x| x * splat_weights.image);
    let pixel = &mut values.pixels[place];
    *pixel = sum.pixel(subtracted, &weights, splatted);
    if layers.is_empty() {
        return;
    }
    let (sums, numbers) = (tile.layers.rows(layers, place), place * layers.row_len..(place + 1) * layers.row_len);
    let splatted = tile.splatted.layers.get(numbers).unwrap_or_default();
    let splatted = &*scaled(splatted, splat_weights.image);
    let (covered, rgb) = (&tile.layers.covered, [sum.rgb(), subtracted.rgb()]);
    let variance = splat_weights.samples.and_then(|each| tile.replicates.variance(place, filter, each));
    let pixel_sums = PixelSums { sums, splatted, splat_weights, variance, rgb, weights, covered, place };
    pixel_sums.write(layers, &mut values.layers);
    if let Some(spectrum) = &layers.spectrum {
        pixel_sums.write_spectrum(spectrum, &mut values.spectral);
    }
    if let Some(caught) = layers.catcher_light(sums[0], splatted, weights.added()) {
        let alpha = f64::from(pixel.alpha) + layers.catcher_luminance(&caught).coverage();
        pixel.alpha = alpha.min(1.0) as f32;
    }
}

/// Multiplies numbers by a factor.
fn scaled(numbers: &[f64], factor: f64) -> Cow<'_, [f64]> {
    if factor == 1.0 { numbers.into() } else { numbers.iter().map(|x| x * factor).collect() }
}
