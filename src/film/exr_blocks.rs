//! The pixels of an OpenEXR file, compressed block by block on all threads and written as they come.

use std::ops::Range;
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::compression::Compression as Packing;
use exr::meta::attribute::ChannelList;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, compute_chunk_count};
use exr::prelude::{ChannelDescription, ImageAttributes, LayerAttributes, LineOrder, SampleType, Vec2};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use zlib_rs::{DeflateConfig, ReturnCode, compress_bound, compress_slice};

use super::atomic_file::{Destination, cannot_write};
use super::exr_column::Column;
use super::exr_head;
use super::format::Compression;
use super::image::Film;
use super::rows::Rows;
use crate::error::{Error, Result};

/// The deflate level. Its files are as large as those of level 4 of the EXR library, in half of the time
/// (`benches/README.md`).
const DEFLATE_LEVEL: i32 = 3;
/// The number of blocks that each thread compresses before all are written. Only these blocks are in memory. If blocks
/// have fewer than [`BLOCK_ROWS`] rows, there are proportionally more of them.
const BLOCKS_PER_THREAD: usize = 4;
const BLOCK_ROWS: usize = 16;
/// The bytes of an offset in the file.
const OFFSET_BYTES: usize = 8;

/// The attribute that counts the values that were clamped to the range of 16 bits.
pub(super) const CLAMPED_KEY: &str = "render/clamped";

/// A part of a scan-line file: its channels in the order of their names, and its header.
pub(super) struct ScanLinePart {
    columns: Vec<Column>,
    header: Header,
}

impl ScanLinePart {
    /// Creates a part with the pixels of a film.
    pub(super) fn new(
        film: &Film,
        mut columns: Vec<Column>,
        packed: Compression,
        shared_attributes: ImageAttributes,
        own_attributes: LayerAttributes,
    ) -> Self {
        columns.sort_by(|a, b| a.name.cmp(&b.name));
        let channel = |column: &Column| {
            let sample_type = if column.is_half { SampleType::F16 } else { SampleType::F32 };
            ChannelDescription::new(column.name.clone(), sample_type, false)
        };
        let (compression, blocks) = (packing(packed), BlockDescription::ScanLines);
        let layer_size = Vec2(film.width as usize, film.height as usize);
        let header = Header {
            channels: ChannelList::new(columns.iter().map(channel).collect()),
            compression,
            blocks,
            line_order: LineOrder::Increasing,
            layer_size,
            deep: false,
            deep_data_version: None,
            chunk_count: compute_chunk_count(compression, layer_size, blocks),
            max_samples_per_pixel: None,
            shared_attributes,
            own_attributes,
        };
        Self { columns, header }
    }

    fn block_rows(&self) -> u32 {
        self.header.compression.scan_lines_per_block() as u32
    }
}

fn packing(compression: Compression) -> Packing {
    match compression {
        Compression::None => Packing::Uncompressed,
        Compression::Rle => Packing::RLE,
        Compression::Zips => Packing::ZIP1,
        Compression::Zip => Packing::ZIP16,
        Compression::Piz => Packing::PIZ,
        Compression::Pxr24 => Packing::PXR24,
        // This uses OpenEXR's default level, 45. The attribute that could set another one is deprecated.
        Compression::Dwaa => Packing::DWAA(None),
        Compression::Dwab => Packing::DWAB(None),
    }
}

/// A block of rows of one part.
struct Block {
    part: usize,
    rows: Range<u32>,
}

/// Writes a complete scan-line file, and returns how many values were clamped. Its bytes do not depend on the number of
/// threads, nor on the number of rows supplied at a time.
///
/// All parts advance down the image together, so that each row is requested only once.
///
/// # Errors
/// If rows cannot be read, or the file cannot be encoded or written; `path` names the file in errors.
pub(super) fn write(
    parts: &[ScanLinePart],
    rows: &mut dyn Rows,
    output: &mut dyn Destination,
    path: &Path,
) -> Result<u64> {
    let encode = |error: exr::error::Error| Error::Encode { path: path.to_owned(), message: error.to_string() };
    let failed = |source| cannot_write(path, source);
    let headers: Vec<Header> = parts.iter().map(|part| part.header.clone()).collect();
    let mut head = exr_head::encode(&headers).map_err(encode)?;
    let mut offsets: Vec<Vec<u64>> = vec![Vec::new(); parts.len()];
    let offset_bytes = OFFSET_BYTES * headers.iter().map(|header| header.chunk_count).sum::<usize>();
    output.write_all(&head).and_then(|()| output.write_all(&vec![0; offset_bytes])).map_err(failed)?;
    let (mut end, mut clamped, mut bytes) = ((head.len() + offset_bytes) as u64, 0, Vec::new());
    let batch_scale = (BLOCK_ROWS / tallest_block(parts) as usize).max(1);
    let batch_size = BLOCKS_PER_THREAD * batch_scale * rayon::current_num_threads();
    for strip in strips(parts, rows.at_once()) {
        let blocks = blocks(parts, &strip);
        let (film, first) = rows.rows(strip.clone())?;
        let pack = |block: &Block| {
            let skipped_pixels = (block.rows.start - strip.start) as usize * film.width as usize;
            pack(parts, &headers, block, film, first + skipped_pixels)
        };
        for batch in blocks.chunks(batch_size) {
            let packed: Vec<_> = batch.par_iter().map(pack).collect();
            bytes.clear();
            for (block, packed) in batch.iter().zip(packed) {
                let Packed { chunk, clamped: more } = packed.map_err(encode)?;
                offsets[block.part].push(end + bytes.len() as u64);
                chunk.write(&mut bytes, parts.len()).map_err(encode)?;
                clamped += more;
            }
            output.write_all(&bytes).map_err(failed)?;
            end += bytes.len() as u64;
        }
    }
    exr_head::set_count(&mut head, CLAMPED_KEY, clamped);
    head.extend(offsets.into_iter().flatten().flat_map(u64::to_le_bytes));
    output.rewind().and_then(|()| output.write_all(&head)).map_err(failed)?;
    Ok(clamped)
}

/// Returns the number of rows of the tallest block. For every compression it is a power of two.
fn tallest_block(parts: &[ScanLinePart]) -> u32 {
    parts.iter().map(ScanLinePart::block_rows).max().unwrap_or(1)
}

/// Splits the image into strips of at most `at_once` rows, but at least as many as the tallest block has.
fn strips(parts: &[ScanLinePart], at_once: Option<u32>) -> impl Iterator<Item = Range<u32>> + use<> {
    let height = parts.iter().map(|part| part.header.layer_size.height() as u32).max().unwrap_or_default();
    let tallest = tallest_block(parts);
    let each = at_once.map_or(height, |rows| rows / tallest * tallest).max(tallest);
    (0..height).step_by(each as usize).map(move |first| first..height.min(first.saturating_add(each)))
}

/// Lists the blocks of a strip from the top. Blocks that start at the same row follow the order of their parts.
fn blocks(parts: &[ScanLinePart], strip: &Range<u32>) -> Vec<Block> {
    let end = strip.end;
    let part_blocks = |(number, part): (usize, &ScanLinePart)| {
        let each = part.block_rows();
        let rows = strip.clone().step_by(each as usize);
        rows.map(move |first| Block { part: number, rows: first..end.min(first.saturating_add(each)) })
    };
    let mut blocks: Vec<Block> = parts.iter().enumerate().flat_map(part_blocks).collect();
    blocks.sort_by_key(|block| (block.rows.start, block.part));
    blocks
}

/// A block as it is stored in the file, and how many of its values were clamped.
struct Packed {
    chunk: Chunk,
    clamped: u64,
}

/// Compresses a block of pixels of a film, starting at pixel number `first`.
fn pack(
    parts: &[ScanLinePart],
    headers: &[Header],
    block: &Block,
    film: &Film,
    first: usize,
) -> exr::error::Result<Packed> {
    let ScanLinePart { columns, header } = &parts[block.part];
    let (width, rows) = (film.width as usize, block.rows.len());
    let mut data = Vec::with_capacity(header.channels.bytes_per_pixel * width * rows);
    let mut clamped = 0;
    for row in 0..rows {
        for column in columns {
            clamped += column.append_bytes(film, first + row * width, width, &mut data);
        }
    }
    let (pixel_position, pixel_size) = (Vec2(0, block.rows.start as usize), Vec2(width, rows));
    let index = BlockIndex { layer: block.part, pixel_position, pixel_size, level: Vec2(0, 0) };
    Ok(Packed { chunk: chunk(headers, UncompressedBlock { index, data })?, clamped })
}

/// Encodes a block as it is stored in the file. Leaves this to the library except for deflate, where the library takes
/// twice as long.
fn chunk(headers: &[Header], block: UncompressedBlock) -> exr::error::Result<Chunk> {
    let header = &headers[block.index.layer];
    let is_deflate = matches!(header.compression, Packing::ZIP1 | Packing::ZIP16);
    if !is_deflate || cfg!(target_endian = "big") {
        return block.compress_to_chunk(headers);
    }
    let y_coordinate = header.own_attributes.layer_position.y() + block.index.pixel_position.y() as i32;
    let compressed_pixels_le = deflate(block.data);
    let compressed_block = CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate, compressed_pixels_le });
    Ok(Chunk { layer_index: block.index.layer, compressed_block })
}

/// Compresses bytes like ZIP of OpenEXR: separates even and odd bytes, replaces each by its difference from the
/// previous one plus 128, and applies zlib. Returns the bytes unchanged if this does not shrink them; readers recognize
/// that by the length (OpenEXR, *File Layout*; Kainz & Bogart, *Technical Introduction to OpenEXR*, "Data
/// Compression").
fn deflate(bytes: Vec<u8>) -> Vec<u8> {
    let mut separated: Vec<u8> = Vec::with_capacity(bytes.len());
    separated.extend(bytes.iter().step_by(2));
    separated.extend(bytes.iter().skip(1).step_by(2));
    let mut previous = separated.first().copied().unwrap_or_default();
    for byte in separated.iter_mut().skip(1) {
        let original = std::mem::replace(byte, byte.wrapping_sub(previous).wrapping_add(128));
        previous = original;
    }
    let mut packed = vec![0; compress_bound(separated.len())];
    let (written, code) = compress_slice(&mut packed, &separated, DeflateConfig::new(DEFLATE_LEVEL));
    let length = written.len();
    if code != ReturnCode::Ok || length >= bytes.len() {
        return bytes;
    }
    packed.truncate(length);
    packed.shrink_to_fit();
    packed
}

#[cfg(test)]
mod tests {
    use super::*;
    use zlib_rs::{InflateConfig, decompress_slice};

    /// Decompresses bytes, following the description of the file layout.
    fn inflate(packed: &[u8], length: usize) -> Vec<u8> {
        let mut separated = vec![0; length];
        let (read, code) = decompress_slice(&mut separated, packed, InflateConfig::default());
        assert_eq!((read.len(), code), (length, ReturnCode::Ok));
        for i in 1..length {
            separated[i] = separated[i - 1].wrapping_add(separated[i]).wrapping_sub(128);
        }
        let (even, odd) = separated.split_at(length.div_ceil(2));
        (0..length).map(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] }).collect()
    }

    #[test]
    fn what_is_packed_comes_back_and_what_would_grow_stays() {
        for length in [2, 3, 100, 101, 70_000] {
            let smooth: Vec<u8> = (0..length).map(|i| (i / 7 % 251) as u8).collect();
            let packed = deflate(smooth.clone());
            assert!(packed.len() < length || (packed == smooth && length < 20), "{length}");
            assert!(packed == smooth || inflate(&packed, length) == smooth, "{length}");
        }
        // Random bytes cannot be compressed.
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        };
        let noise: Vec<u8> = (0..10_000).map(|_| random()).collect();
        assert_eq!(deflate(noise.clone()), noise);
        assert_eq!(deflate(Vec::new()), Vec::<u8>::new());
    }
}
