//! The values that an OpenEXR file holds for each pixel.

use exr::prelude::{Text, f16};

use super::image::Film;

/// A channel: its name, and the value of the pixel that it holds.
pub(super) struct Column {
    pub(super) name: Text,
    /// Whether the channel has 16 bits instead of 32.
    pub(super) is_half: bool,
    pub(super) content: ColumnContent,
}

/// A value of a pixel.
#[derive(Clone, Copy)]
pub(super) enum ColumnContent {
    Alpha,
    /// Red, green or blue, by index.
    Color(usize),
    Depth,
    /// A layer and one of its channels, by index.
    Layer {
        layer: usize,
        channel: usize,
    },
    /// A Stokes component of a spectral band, by index.
    Band {
        component: usize,
        band: usize,
    },
}

impl Column {
    pub(super) fn new(name: &str, is_half: bool, content: ColumnContent) -> Self {
        Self { name: Text::new_or_panic(name), is_half, content }
    }

    /// Appends the bytes of `pixels` pixels, starting at number `first`. Returns how many values exceeded the range of
    /// 16 bits and were clamped.
    pub(super) fn append_bytes(&self, film: &Film, first: usize, pixels: usize, bytes: &mut Vec<u8>) -> u64 {
        let all = &film.pixels[first..first + pixels];
        match self.content {
            ColumnContent::Alpha => self.put_all(all.iter().map(|pixel| pixel.alpha), bytes),
            ColumnContent::Color(number) => self.put_all(all.iter().map(|pixel| pixel.rgb[number]), bytes),
            ColumnContent::Depth => self.put_all(all.iter().map(|pixel| pixel.depth), bytes),
            ColumnContent::Layer { layer, channel } => {
                let image = &film.layers[layer];
                let stride = image.numbers();
                let values = &image.values[first * stride..(first + pixels) * stride];
                self.put_all(values.iter().skip(channel).step_by(stride).copied(), bytes)
            }
            ColumnContent::Band { component, band } => {
                let spectral = film.spectral.as_ref().expect("bands are of a film with spectra");
                self.put_all((first..first + pixels).map(|pixel| spectral.component(pixel, component)[band]), bytes)
            }
        }
    }

    fn put_all(&self, values: impl Iterator<Item = f32>, bytes: &mut Vec<u8>) -> u64 {
        let mut clamped = 0;
        if self.is_half {
            values.for_each(|value| bytes.extend(half(value, &mut clamped).to_ne_bytes()));
        } else {
            values.for_each(|value| bytes.extend(value.to_ne_bytes()));
        }
        clamped
    }
}

/// Converts a value to 16 bits. A value out of range is counted, and clamped to the largest finite one.
fn half(value: f32, clamped: &mut u64) -> f16 {
    let half = f16::from_f32(value);
    if half.is_finite() {
        return half;
    }
    *clamped += 1;
    if value < 0.0 { f16::MIN } else { f16::MAX }
}
