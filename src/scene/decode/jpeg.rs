use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::texels::{Steps, Unreadable, Whole};
use crate::film::fits;

/// Reads a JPEG: gray stays gray, all other colors become red, green and blue.
///
/// # Errors
/// If it is none, is damaged, or claims a size that it cannot have.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<Whole, Unreadable> {
    let any = DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), any);
    decoder.decode_headers()?;
    let (width, height) = decoder.dimensions().ok_or(DecodeErrors::ExhaustedData)?;
    let (color, channels) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (ColorSpace::Luma, 1),
        _ => (ColorSpace::RGB, 3),
    };
    fits(width, height, (width * height * channels) as u64, bytes).map_err(Unreadable::Unfit)?;
    decoder.set_options(any.jpeg_set_out_colorspace(color));
    let mut numbers = vec![0; width * height * channels];
    decoder.decode_into(&mut numbers)?;
    Ok(Whole { width, channels, steps: Steps::Bytes(numbers) })
}
