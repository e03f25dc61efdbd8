use std::path::Path;

use super::atomic_file::replace_file;
use super::image::Film;
use crate::error::{Error, Result};
use crate::spectrum::{apply, encode_srgb};

/// Writes an 8-bit sRGB picture for viewing: RGB times 2^`exposure`, clipped to 0..1, without alpha.
///
/// # Errors
/// If the file cannot be written. Nothing is then left behind.
pub fn write_png(film: &Film, exposure: f64, path: impl AsRef<Path>) -> Result<()> {
    let path = path.as_ref();
    replace_file(path, &film_png(film, exposure, path)?)
}

/// Encodes the picture that [`write_png`] writes; `path` names it in errors.
///
/// # Errors
/// If the encoder refuses the size.
pub fn film_png(film: &Film, exposure: f64, path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let gain = libm::exp2(exposure);
    let to_rec709 = film.color_space.to_rec709();
    let encode_pixel =
        |rgb: [f32; 3]| encode_srgb(apply(&to_rec709, rgb.map(|x| f64::from(x) * gain)).map(|x| x as f32));
    let bytes: Vec<u8> = film.pixels.iter().flat_map(|pixel| encode_pixel(pixel.rgb)).collect();
    png(&bytes, [film.width, film.height], path)
}

/// Encodes 8-bit red, green and blue, row by row, as a PNG of the given width and height. Marks it as sRGB; `path`
/// names it in errors.
///
/// # Errors
/// If the encoder refuses the size.
pub fn png(bytes: &[u8], [width, height]: [u32; 2], path: impl AsRef<Path>) -> Result<Vec<u8>> {
    let encode = || {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::Fast);
        encoder.set_filter(png::Filter::Adaptive);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(bytes)?;
        writer.finish()?;
        Ok(file)
    };
    let failed = |message: String| Error::Encode { path: path.as_ref().to_owned(), message };
    encode().map_err(|error: png::EncodingError| failed(error.to_string()))
}
