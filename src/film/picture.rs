use std::path::Path;

use super::file::replace_file;
use super::image::Film;
use crate::error::{Error, Result};
use crate::spectrum::{apply, encode_srgb};

/// Writes an 8-bit sRGB picture for looking at: RGB times 2^`exposure`, clipped to 0..1, without alpha.
///
/// # Errors
/// If the file cannot be written; nothing is left behind then.
pub fn write_png(film: &Film, exposure: f64, path: &Path) -> Result<()> {
    let gain = libm::exp2(exposure);
    let to_rec709 = film.color_space.to_rec709();
    let encoded = |rgb: [f32; 3]| encode_srgb(apply(&to_rec709, rgb.map(|x| f64::from(x) * gain)).map(|x| x as f32));
    let bytes: Vec<u8> = film.pixels.iter().flat_map(|pixel| encoded(pixel.rgb)).collect();
    let mut file = std::io::Cursor::new(Vec::new());
    image::write_buffer_with_format(
        &mut file,
        &bytes,
        film.width,
        film.height,
        image::ExtendedColorType::Rgb8,
        image::ImageFormat::Png,
    )
    .map_err(|error| Error::Encode { path: path.to_owned(), message: error.to_string() })?;
    replace_file(path, file.get_ref())
}
