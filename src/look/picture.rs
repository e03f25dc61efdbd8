use std::path::Path;

use super::tone::{Tone, shown};
use crate::error::Result;
use crate::film::{Channel, ExrFile, ExrLayer, png, replace_file};
use crate::spectrum::{IDENTITY, Matrix, apply, encode_srgb, file_to_rec709};

/// The value from which depths and the like stand for nothing at all.
const EMPTY_VALUE: f64 = 1e9;

/// The brightness at which colors are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Exposure {
    /// The exponent of the power of 2 by which light is multiplied.
    pub stops: f64,
    /// The tone curve that is applied afterwards.
    pub tone: Tone,
}

/// A picture for a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: usize,
    /// Red, green and blue from 0 to 1, row by row.
    pixels: Vec<[f32; 3]>,
    /// Whether the pixels are linear light, or else values that are shown as they are.
    is_light: bool,
}

impl Picture {
    /// Converts a layer to a picture. Also returns remarks on how it is shown.
    ///
    /// Colors are converted to Rec.709 and exposed. In directions (`N`, `Nd`), -1 becomes 0 and 1 becomes 1. In any
    /// other layer, the first three channels are stretched from their 1st to their 99th percentile; a single channel is
    /// shown as gray.
    pub fn of_layer(file: &ExrFile, layer: &ExrLayer, exposure: Exposure) -> (Self, Vec<String>) {
        let width = layer.part.bounds.size[0];
        if let Some(color) = layer.color() {
            let (to_rec709, remarks) = to_rec709(file);
            let gain = libm::exp2(exposure.stops);
            let expose =
                |rgb: [f64; 3]| apply(&to_rec709, rgb.map(|x| x * gain)).map(|x| exposure.tone.shown(x) as f32);
            let all = 0..layer.part.bounds.pixels();
            let pixels = all.map(|index| expose(color.map(|channel| channel.at(index)))).collect();
            return (Self { width, pixels, is_light: true }, remarks.into_iter().collect());
        }
        let (mut planes, mut remarks, is_direction) = (Vec::new(), Vec::new(), is_direction(layer));
        for channel in layer.channels.iter().take(3) {
            let (low, high) = if is_direction { (-1.0, 1.0) } else { value_range(channel) };
            if !is_direction {
                remarks.push(format!(
                    "{}: black is {:?}, white {:?}, the 1st and 99th percentile of the finite values below 1e9",
                    channel.full_name(),
                    low as f32,
                    high as f32
                ));
            }
            planes.push(stretch(channel, low, high));
        }
        let pixel = |index: usize| match &planes[..] {
            [gray] => [gray[index]; 3],
            planes => std::array::from_fn(|i| planes.get(i).map_or(0.0, |plane| plane[index])),
        };
        let pixels = (0..planes.first().map_or(0, Vec::len)).map(pixel).collect();
        (Self { width, pixels, is_light: false }, remarks)
    }

    /// Creates a picture from linear Rec.709 light up to 1, row by row.
    pub fn of_light(width: usize, light: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let pixels = light.into_iter().map(|rgb| rgb.map(|x| shown(x) as f32)).collect();
        Self { width, pixels, is_light: true }
    }

    /// Creates a picture from gray values between 0 and 1, row by row.
    pub fn of_grays(width: usize, grays: impl IntoIterator<Item = f64>) -> Self {
        Self { width, pixels: grays.into_iter().map(|gray| [gray as f32; 3]).collect(), is_light: false }
    }

    /// Returns the number of pixels per row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Returns the number of rows.
    pub fn height(&self) -> usize {
        self.pixels.len() / self.width
    }

    /// Resamples the picture to the given size. Each pixel is the mean over the area that it covers.
    #[must_use]
    pub fn scaled(&self, width: usize, height: usize) -> Self {
        let [across, down] = [shares(self.width, width), shares(self.height(), height)];
        let mean = |shares: &[(usize, f32)], pixel: &dyn Fn(usize) -> [f32; 3]| {
            shares.iter().fold([0.0; 3], |sum: [f32; 3], &(index, share)| {
                let pixel = pixel(index);
                std::array::from_fn(|i| sum[i] + share * pixel[i])
            })
        };
        let rows = self.pixels.chunks_exact(self.width);
        let narrow: Vec<[f32; 3]> = rows.flat_map(|row| across.iter().map(|x| mean(x, &|index| row[index]))).collect();
        let column = |y: &[(usize, f32)], x: usize| mean(y, &|index| narrow[index * width + x]);
        let pixels = down.iter().flat_map(|y| (0..width).map(move |x| column(y, x))).collect();
        Self { width, pixels, is_light: self.is_light }
    }

    /// Returns 8-bit red, green and blue, row by row.
    pub fn bytes(&self) -> Vec<[u8; 3]> {
        let plain = |pixel: [f32; 3]| pixel.map(|x| (255.0 * x).round() as u8);
        self.pixels.iter().map(|pixel| if self.is_light { encode_srgb(*pixel) } else { plain(*pixel) }).collect()
    }

    /// Writes the picture as an 8-bit PNG.
    ///
    /// # Errors
    /// If the file cannot be written. Nothing is then left behind.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        replace_file(path, &self.encode(path)?)
    }

    /// Encodes the picture as an 8-bit PNG.
    ///
    /// # Errors
    /// If the encoder refuses the size.
    pub fn png(&self) -> Result<Vec<u8>> {
        self.encode(Path::new("the picture"))
    }

    /// Encodes the picture as an 8-bit PNG; `path` names it in errors.
    fn encode(&self, path: &Path) -> Result<Vec<u8>> {
        png(self.bytes().as_flattened(), [self.width as u32, self.height() as u32], path)
    }
}

/// Returns, for each of `to` pixels, which of `from` pixels it covers and how large a share each of these has in it.
fn shares(old_size: usize, new_size: usize) -> Vec<Vec<(usize, f32)>> {
    let step = old_size as f64 / new_size as f64;
    let share = |i: usize| {
        let (low, high) = (i as f64 * step, (i + 1) as f64 * step);
        let covered = (low as usize)..(libm::ceil(high) as usize).min(old_size);
        let part = |index: usize| high.min((index + 1) as f64) - low.max(index as f64);
        covered.map(|index| (index, (part(index) / step) as f32)).collect()
    };
    (0..new_size).map(share).collect()
}

/// Returns whether a layer holds unit vectors: normals of any kind, recognized by the names that renderers give them.
fn is_direction(layer: &ExrLayer) -> bool {
    let last = layer.name.rsplit('.').next().unwrap_or_default().to_lowercase();
    layer.channels.len() == 3 && (matches!(&*last, "n" | "nd" | "ns" | "ng") || last.contains("normal"))
}

/// Returns the matrix from the colors of a file to linear Rec.709, and a remark if it is unknown.
pub(super) fn to_rec709(file: &ExrFile) -> (Matrix, Option<String>) {
    match file_to_rec709(file.attribute("colorInteropID"), file.chromaticities) {
        Ok(matrix) => (matrix, None),
        Err(remarks) => (IDENTITY, Some(format!("{remarks}: it is shown as linear Rec.709"))),
    }
}

/// Returns the 1st and 99th percentile of the finite values of a channel, without those that stand for nothing.
fn value_range(channel: &Channel) -> (f64, f64) {
    let values: Vec<f64> = channel.values().filter(|x| x.is_finite() && *x < EMPTY_VALUE).collect();
    let [low, high] = [1, 99].map(|percent| percentile(values.clone(), percent));
    (low.unwrap_or(0.0), high.unwrap_or(1.0))
}

/// Returns the value at a percentile, 0 to 100, or none if there are no values.
pub(super) fn percentile(mut values: Vec<f64>, percent: usize) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    Some(*values.select_nth_unstable_by((last * percent + 50) / 100, f64::total_cmp).1)
}

/// Maps values linearly, so that `low` becomes 0 and `high` becomes 1. If both are equal, they become the middle.
fn stretch(channel: &Channel, low: f64, high: f64) -> Vec<f32> {
    let scale = |x: f64| if high > low { (x - low) / (high - low) } else { x - low + 0.5 };
    channel.values().map(|x| shown(scale(x)) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(width: usize, values: &[f32]) -> Picture {
        Picture { width, pixels: values.iter().map(|x| [*x; 3]).collect(), is_light: true }
    }

    #[test]
    fn a_scaled_picture_has_the_mean_of_each_area_in_linear_light() {
        let checker = light(2, &[0.0, 1.0, 1.0, 0.0]);
        // The sRGB encoding of 0.5 (IEC 61966-2-1).
        assert_eq!(checker.scaled(1, 1).bytes(), [[188; 3]]);
        let row = light(3, &[0.0, 0.6, 1.0]);
        let two: Vec<f32> = row.scaled(2, 1).pixels.iter().map(|pixel| pixel[0]).collect();
        // Each covers one and a half pixels: (0 + 0.3) / 1.5 and (0.3 + 1) / 1.5.
        assert!((two[0] - 0.2).abs() < 1e-6 && (two[1] - 1.3 / 1.5).abs() < 1e-6, "{two:?}");
        assert_eq!(row.scaled(3, 1), row);
    }

    #[test]
    fn the_shares_of_an_area_are_all_of_it() {
        for (old_size, new_size) in [(7, 3), (3, 7), (1920, 80), (81, 80), (1, 1)] {
            let shares = shares(old_size, new_size);
            assert_eq!(shares.len(), new_size);
            for share in shares {
                assert!(
                    (share.iter().map(|(_, part)| part).sum::<f32>() - 1.0).abs() < 1e-5,
                    "{old_size} to {new_size}"
                );
                assert!(share.iter().all(|(index, part)| *index < old_size && *part >= 0.0));
            }
        }
    }
}
