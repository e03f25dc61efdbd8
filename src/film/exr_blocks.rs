//! The pixels of an OpenEXR file, packed block by block on all threads.

use std::io::Cursor;

use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock};
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock, enumerate_ordered_header_block_indices};
use exr::compression::Compression;
use exr::error::Result;
use exr::image::write::layers::{LayersWriter, WritableLayers};
use exr::meta::header::Header;
use exr::prelude::{FlatImage, WritableImage};
use rayon::prelude::{IntoParallelRefIterator, ParallelIterator};
use zlib_rs::{DeflateConfig, ReturnCode, compress_bound, compress_slice};

/// Level of deflate: the bytes of level 4 of the library for EXR, in half of the time (`benches/README.md`).
const LEVEL: i32 = 3;
/// Blocks that each thread packs before all are written: they are all of the file that is in memory twice.
const BLOCKS_AT_A_TIME: usize = 4;

/// The bytes of an image of scan lines. They are the same for any number of threads.
pub(super) fn file(image: &FlatImage) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    let headers = image.write().infer_meta_data();
    let writer = image.layer_data.create_writer(&headers);
    exr::block::write(&mut bytes, headers, true, |meta, chunks| {
        let all: Vec<(usize, BlockIndex)> = enumerate_ordered_header_block_indices(&meta.headers).collect();
        for some in all.chunks(BLOCKS_AT_A_TIME * rayon::current_num_threads()) {
            let pack = |&(number, index): &(usize, BlockIndex)| {
                let data = writer.extract_uncompressed_block(&meta.headers, index);
                Ok((number, chunk(&meta.headers, UncompressedBlock { index, data })?))
            };
            let packed: Vec<Result<(usize, Chunk)>> = some.par_iter().map(pack).collect();
            for each in packed {
                let (number, chunk) = each?;
                chunks.write_chunk(number, chunk)?;
            }
        }
        Ok(())
    })?;
    Ok(bytes.into_inner())
}

/// A block as it stands in the file: the library's own but for deflate, of which its own takes twice as long.
fn chunk(headers: &[Header], block: UncompressedBlock) -> Result<Chunk> {
    let header = &headers[block.index.layer];
    let is_deflate = matches!(header.compression, Compression::ZIP1 | Compression::ZIP16);
    if !is_deflate || cfg!(target_endian = "big") {
        return block.compress_to_chunk(headers);
    }
    let y_coordinate = header.own_attributes.layer_position.y() + block.index.pixel_position.y() as i32;
    let compressed_pixels_le = deflated(block.data);
    let compressed_block = CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate, compressed_pixels_le });
    Ok(Chunk { layer_index: block.index.layer, compressed_block })
}

/// Bytes as ZIP of OpenEXR packs them: every second one apart, each as the difference to the one before plus 128, by
/// zlib; as they are, if that makes them no fewer, by which readers tell the two apart (OpenEXR, *File Layout*; Kainz &
/// Bogart, *Technical Introduction to OpenEXR*, "Data Compression").
fn deflated(bytes: Vec<u8>) -> Vec<u8> {
    let mut apart: Vec<u8> = Vec::with_capacity(bytes.len());
    apart.extend(bytes.iter().step_by(2));
    apart.extend(bytes.iter().skip(1).step_by(2));
    let mut before = apart.first().copied().unwrap_or_default();
    for byte in apart.iter_mut().skip(1) {
        let it = std::mem::replace(byte, byte.wrapping_sub(before).wrapping_add(128));
        before = it;
    }
    let mut packed = vec![0; compress_bound(apart.len())];
    let (written, code) = compress_slice(&mut packed, &apart, DeflateConfig::new(LEVEL));
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

    /// The way back, as the file's description has it.
    fn inflated(packed: &[u8], length: usize) -> Vec<u8> {
        let mut apart = vec![0; length];
        let (read, code) = decompress_slice(&mut apart, packed, InflateConfig::default());
        assert_eq!((read.len(), code), (length, ReturnCode::Ok));
        for i in 1..length {
            apart[i] = apart[i - 1].wrapping_add(apart[i]).wrapping_sub(128);
        }
        let (even, odd) = apart.split_at(length.div_ceil(2));
        (0..length).map(|i| if i % 2 == 0 { even[i / 2] } else { odd[i / 2] }).collect()
    }

    #[test]
    fn what_is_packed_comes_back_and_what_would_grow_stays() {
        for length in [2, 3, 100, 101, 70_000] {
            let smooth: Vec<u8> = (0..length).map(|i| (i / 7 % 251) as u8).collect();
            let packed = deflated(smooth.clone());
            assert!(packed.len() < length || (packed == smooth && length < 20), "{length}");
            assert!(packed == smooth || inflated(&packed, length) == smooth, "{length}");
        }
        // Nothing packs a hash.
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 56) as u8
        };
        let noise: Vec<u8> = (0..10_000).map(|_| random()).collect();
        assert_eq!(deflated(noise.clone()), noise);
        assert_eq!(deflated(Vec::new()), Vec::<u8>::new());
    }
}
