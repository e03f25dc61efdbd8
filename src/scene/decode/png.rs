use std::io::Cursor;

use png::{BitDepth, Decoder, DecodingError, Info, Limits, ScaledFloat, SourceChromaticities, Transformations};

use super::texels::{IntegerImage, IntegerTexels, Unreadable, fits};
use super::{exif, icc};
use crate::film::MAX_TEXELS;
use crate::spectrum::{ColorSpace, Primaries};

/// Reads a PNG (ISO/IEC 15948). Palettes, transparent colors and depths below 8 bits are expanded to numbers of 8 bits.
///
/// # Errors
/// If the file is not a PNG, is damaged, or claims an impossible size.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<IntegerImage, Unreadable> {
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: 12 * MAX_TEXELS });
    decoder.set_ignore_text_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    let [width, height] = [reader.info().width, reader.info().height].map(|side| side as usize);
    let size = reader.output_buffer_size().ok_or(DecodingError::LimitsExceeded)?;
    fits(width, height, size as u64, bytes)?;
    let mut numbers = vec![0; size];
    reader.next_frame(&mut numbers)?;
    let not_srgb = not_srgb(reader.info());
    let is_rotated = reader.info().exif_metadata.as_deref().is_some_and(exif::is_rotated);
    let (color, depth) = reader.output_color_type();
    let steps = match depth {
        BitDepth::Sixteen => {
            IntegerTexels::Words(numbers.as_chunks().0.iter().map(|word| u16::from_be_bytes(*word)).collect())
        }
        _ => IntegerTexels::Bytes(numbers),
    };
    Ok(IntegerImage { width, channels: color.samples(), not_srgb, is_rotated, steps })
}

/// Returns what a file says about its colors, if they are not sRGB. The chunk that takes precedence decides.
fn not_srgb(info: &Info) -> Option<String> {
    if let Some(points) = info.coding_independent_code_points {
        let codes = [points.color_primaries, points.transfer_function];
        return (!SRGB_POINTS.contains(&codes)).then(|| format!("cICP {} {}", codes[0], codes[1]));
    }
    if let Some(profile) = &info.icc_profile {
        return icc::not_srgb(profile);
    }
    if info.srgb.is_some() {
        return None;
    }
    let gamma = info.gama_chunk.map(ScaledFloat::into_value).filter(|gamma| (gamma * 2.2 - 1.0).abs() > 0.02);
    let has_other_primaries = |found: &SourceChromaticities| {
        let found = [found.red, found.green, found.blue, found.white].map(|(x, y)| [x, y].map(ScaledFloat::into_value));
        let Primaries { red, green, blue, white } = ColorSpace::Rec709.primaries();
        let known = [red, green, blue, white];
        let pairs = found.as_flattened().iter().zip(known.as_flattened());
        pairs.into_iter().any(|(found, known)| (f64::from(*found) - known).abs() > 0.005)
    };
    let primaries = info.chrm_chunk.filter(has_other_primaries).map(|_| "other primaries (cHRM)".to_owned());
    gamma.map(|gamma| format!("a gamma of {gamma} (gAMA)")).or(primaries)
}

/// Color primaries and transfer functions of sRGB, and of Rec.709, which displays show in the same way. The numbers are
/// those of ITU-T H.273.
const SRGB_POINTS: [[u8; 2]; 2] = [[1, 13], [1, 1]];
