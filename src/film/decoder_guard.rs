//! Guards against third-party decoders: some panic on damaged files, some trust any size that a file claims to have.

use std::cell::Cell;
use std::fmt::Display;
use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use exr::block::chunk::CompressedBlock;
use exr::meta::header::Header;
use exr::prelude::Compression;

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Runs a decoder. Returns its result, or an error if it panics, without printing the panic.
pub(crate) fn catch_panics<T, E: Display>(decode: impl FnOnce() -> Result<T, E>) -> Result<T, String> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let previous_hook = take_hook();
        set_hook(Box::new(move |info| {
            if !QUIET.get() {
                previous_hook(info);
            }
        }));
    });
    let was_quiet = QUIET.replace(true);
    let answer = catch_unwind(AssertUnwindSafe(decode));
    QUIET.set(was_quiet);
    match answer {
        Ok(answer) => answer.map_err(|error| error.to_string()),
        Err(_) => Err("its data is inconsistent".into()),
    }
}

/// The maximum number of texels of an image: 16384 x 8192.
pub(crate) const MAX_TEXELS: usize = 1 << 27;

/// The maximum number of pixels of a film, and of an image that is read.
pub(crate) const MAX_PIXELS: usize = 1 << 28;

/// Returns the message for an image with more pixels than are read, or none if it is small enough.
pub(crate) fn too_large(width: usize, height: usize, max: usize) -> Option<String> {
    let message = || format!("its {width} x {height} pixels are more than {max}");
    (width.saturating_mul(height) > max).then(message)
}

/// The bytes of texels that a file of any length may claim.
const ALWAYS_ALLOWED_BYTES: u64 = 1 << 27;
/// The maximum bytes of texels per byte of a file. Deflate compresses at best 1032 bytes into one (RFC 1951: 258 by 2
/// bits), and with a palette of two colors each bit is a texel of 3 bytes. Nothing else in these formats is as dense.
const MAX_EXPANSION: u64 = 1032 * 24;

/// Refuses images without texels, and sizes whose `bytes` would exhaust the memory before the decoder notices that the
/// file does not have these texels.
pub(crate) fn fits(width: usize, height: usize, bytes: u64, file: &[u8]) -> Result<(), String> {
    if width == 0 || height == 0 {
        return Err("it has no pixels".into());
    }
    if bytes > ALWAYS_ALLOWED_BYTES.max(MAX_EXPANSION * file.len() as u64) {
        return Err(format!("its {} bytes cannot hold {width} x {height} pixels", file.len()));
    }
    Ok(())
}

/// The bytes that a section of a DWAA or DWAB block may claim in addition to twice the bytes of the block's pixels.
const MAX_EXTRA_BYTES: u64 = 1 << 20;

/// Refuses an OpenEXR file with DWAA or DWAB blocks that claim to be much larger than their pixels, because the decoder
/// allocates the memory before it unpacks them. Each block begins with a version and nine counts of bytes or half
/// floats, little-endian, unless it is stored uncompressed because compression would make it larger.
pub(crate) fn check_claimed_sizes(bytes: &[u8]) -> exr::error::Result<()> {
    let reader = exr::block::read(Cursor::new(bytes), false)?;
    let is_packed = |header: &Header| matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    let headers = reader.headers().to_vec();
    if !headers.iter().any(is_packed) {
        return Ok(());
    }
    for chunk in reader.all_chunks(false)? {
        let chunk = chunk?;
        let Some(header) = headers.get(chunk.layer_index).filter(|header| is_packed(header)) else { continue };
        let packed = match &chunk.compressed_block {
            CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
            CompressedBlock::Tile(block) => &block.compressed_pixels_le,
            CompressedBlock::DeepScanLine(_) | CompressedBlock::DeepTile(_) => continue,
        };
        let place = header.get_block_data_indices(&chunk.compressed_block)?;
        let pixels = header.get_absolute_block_pixel_coordinates(place)?.size.area();
        let size = (pixels as u64).saturating_mul(header.channels.bytes_per_pixel as u64);
        let numbers = packed.as_chunks::<8>().0.iter().map(|number| u64::from_le_bytes(*number));
        let most = size.saturating_mul(2).saturating_add(MAX_EXTRA_BYTES);
        if packed.len() as u64 != size && numbers.skip(1).take(9).any(|number| number > most) {
            return Err(exr::error::Error::Invalid("a block claims to be larger than the image".into()));
        }
    }
    Ok(())
}
