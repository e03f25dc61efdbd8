use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::texels::{IntegerImage, IntegerTexels, Unreadable, fits};
use super::{exif, icc};

/// Reads a JPEG. Gray stays gray; all other colors become red, green and blue.
///
/// # Errors
/// If the file is not a JPEG, is damaged, or claims an impossible size.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<IntegerImage, Unreadable> {
    let any = DecoderOptions::default().set_strict_mode(false).set_max_width(usize::MAX).set_max_height(usize::MAX);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), any);
    decoder.decode_headers()?;
    let (width, height) = decoder.dimensions().ok_or(DecodeErrors::ExhaustedData)?;
    let (color, channels) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (ColorSpace::Luma, 1),
        _ => (ColorSpace::RGB, 3),
    };
    fits(width, height, (width * height * channels) as u64, bytes)?;
    decoder.set_options(any.jpeg_set_out_colorspace(color));
    let mut numbers = vec![0; width * height * channels];
    decoder.decode_into(&mut numbers)?;
    if !is_complete(bytes) {
        return Err(Unreadable::Short);
    }
    let not_srgb = decoder.icc_profile().and_then(|profile| icc::not_srgb(&profile));
    let is_rotated = decoder.exif().is_some_and(|exif| exif::is_rotated(exif));
    Ok(IntegerImage { width, channels, not_srgb, is_rotated, steps: IntegerTexels::Bytes(numbers) })
}

/// Returns whether the markers of a file (ITU-T T.81, B.1.1) lead to the end of its image. Anything may follow that.
///
/// The decoder fills missing data with gray. Its strict mode would report that, but it also refuses files of cameras
/// with stray bytes between segments.
fn is_complete(bytes: &[u8]) -> bool {
    const END: u8 = 0xd9;
    // These markers have no segment: the start of the image, restarts within a scan, and a private marker.
    let stands_alone = |marker: u8| matches!(marker, 0x01 | 0xd0..=0xd8);
    let mut rest = bytes;
    // Data outside of segments, above all that of scans, contains no marker: each of its bytes 255 is followed by a 0.
    while let Some(at) = rest.windows(2).position(|pair| pair[0] == 0xff && !matches!(pair[1], 0 | 0xff)) {
        let marker = rest[at + 1];
        if marker == END {
            return true;
        }
        rest = &rest[at + 2..];
        if !stands_alone(marker) {
            let length = rest.first_chunk().map(|high_first| usize::from(u16::from_be_bytes(*high_first)));
            let Some(behind) = length.and_then(|length| rest.get(length..)) else { return false };
            rest = behind;
        }
    }
    false
}
