use std::io::Cursor;

use png::{BitDepth, Decoder, DecodingError, Limits, Transformations};

use super::texels::{Steps, Unreadable, Whole, fits};
use crate::film::MOST_TEXELS;

/// Reads a PNG (ISO/IEC 15948): palettes, transparent colors and less than 8 bits become numbers of 8 bits.
///
/// # Errors
/// If it is none, is damaged, or claims a size that it cannot have.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<Whole, Unreadable> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: 12 * MOST_TEXELS });
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let [width, height] = [reader.info().width, reader.info().height].map(|side| side as usize);
    let size = reader.output_buffer_size().ok_or(DecodingError::LimitsExceeded)?;
    fits(width, height, size as u64, bytes)?;
    let mut numbers = vec![0; size];
    reader.next_frame(&mut numbers)?;
    let (color, depth) = reader.output_color_type();
    let steps = match depth {
        BitDepth::Sixteen => Steps::Words(numbers.as_chunks().0.iter().map(|word| u16::from_be_bytes(*word)).collect()),
        _ => Steps::Bytes(numbers),
    };
    Ok(Whole { width, channels: color.samples(), steps })
}
