use std::io::Cursor;

use exr::block::UncompressedBlock;
use exr::block::reader::ChunksReader;
use exr::meta::header::Header;
use exr::prelude::{AttributeValue, Compression, SampleType, Vec2, f16};

use super::exr_channels::ChosenChannels;
use super::texels::{FloatImage, Unreadable, fits};
use crate::film::{check_claimed_sizes, exr_primaries, exr_text};
use crate::spectrum::{Matrix, file_to_rec709};

/// Reads the colors or the gray of an OpenEXR file, and alpha if requested. An alpha that is missing is 1.
///
/// The image is the display window. It is black and transparent where the data window does not reach, and data outside
/// of it is dropped.
///
/// # Errors
/// If the file is not an OpenEXR file, is damaged, claims an impossible size, or has no channels that make an image.
pub(in crate::scene) fn decode(bytes: &[u8], alpha: bool) -> Result<FloatImage, Unreadable> {
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(unreadable)?;
    let check_size = |size: Vec2<usize>, channels: usize| {
        let length = (size.width() as u64 * size.height() as u64).saturating_mul(4 * channels as u64);
        fits(size.width(), size.height(), length, bytes)
    };
    reader.headers().iter().try_for_each(|header| check_size(header.layer_size, if alpha { 4 } else { 3 }))?;
    check_claimed_sizes(bytes)?;
    let chosen = ChosenChannels::of(reader.headers(), alpha)?;
    let header = reader.headers()[chosen.part].clone();
    let (size, channels) = (header.shared_attributes.display_window.size, chosen.channels());
    check_size(size, channels)?;
    let mut floats = FloatImage {
        width: size.width(),
        channels,
        has_alpha: alpha,
        is_lossy: is_lossy(&header, &chosen),
        to_rec709: to_rec709(&header),
        // Black and transparent.
        numbers: vec![0.0; channels * size.width() * size.height()],
    };
    let chunks = reader
        .filter_chunks(false, |_, tile, block| block.layer == chosen.part && tile.is_largest_resolution_level())?;
    let result = chunks.decompress_sequential(false, |_, block| {
        store_block(&mut floats, &block, &header, &chosen);
        Ok(())
    });
    result.map_err(unreadable)?;
    Ok(floats)
}

/// Separates files that other programs may be able to read from files that are not OpenEXR.
fn unreadable(error: exr::error::Error) -> Unreadable {
    match error {
        exr::error::Error::NotSupported(feature) if feature.contains("subsampling") => Unreadable::Sparse,
        exr::error::Error::NotSupported(feature) if feature.contains("deep") => Unreadable::Deep,
        exr::error::Error::NotSupported(feature) if feature.contains("compression method") => Unreadable::Compression,
        other => other.into(),
    }
}

/// Returns whether a compression preserves the look of an image rather than its numbers. PXR24 does not count: it only
/// rounds numbers and never changes their sign.
fn is_lossy(header: &Header, chosen: &ChosenChannels) -> bool {
    let is_half = |channel: &usize| header.channels.list[*channel].sample_type == SampleType::F16;
    match header.compression {
        Compression::DWAA(_) | Compression::DWAB(_) => true,
        Compression::B44 | Compression::B44A => chosen.numbers.iter().flatten().any(is_half),
        _ => false,
    }
}

/// Returns the matrix from the colors of a part to linear Rec.709, or why it is not known.
fn to_rec709(header: &Header) -> Result<Matrix, String> {
    let own = header.own_attributes.other.iter().chain(&header.shared_attributes.other);
    let id = own.into_iter().find_map(|(key, value)| match value {
        AttributeValue::Text(id) if key == "colorInteropID" => Some(exr_text(id)),
        _ => None,
    });
    file_to_rec709(id.as_deref(), header.shared_attributes.chromaticities.map(exr_primaries))
}

/// Stores the chosen numbers of a block at their places in the display window.
fn store_block(floats: &mut FloatImage, block: &UncompressedBlock, header: &Header, chosen: &ChosenChannels) {
    let (data, display) = (header.own_attributes.layer_position, header.shared_attributes.display_window.position);
    let shift = [i64::from(data.x()) - i64::from(display.x()), i64::from(data.y()) - i64::from(display.y())];
    let mut put = |x: usize, y: usize, number: usize, value: f32| {
        let [column, row] = [x as i64 + shift[0], y as i64 + shift[1]].map(usize::try_from);
        if let (Ok(column), Ok(row)) = (column, row) {
            floats.set(column, row, number, value);
        }
    };
    for line in block.lines(&header.channels) {
        let Some(number) = chosen.numbers.iter().position(|channel| *channel == Some(line.location.channel)) else {
            continue;
        };
        let [left, y] = [line.location.position.x(), line.location.position.y()];
        let mut put = |x: usize, value: f32| put(left + x, y, number, value);
        let (words, longs) = (line.value.as_chunks().0.iter(), line.value.as_chunks().0.iter());
        match header.channels.list[line.location.channel].sample_type {
            SampleType::F16 => words.enumerate().for_each(|(x, word)| put(x, f16::from_ne_bytes(*word).to_f32())),
            SampleType::F32 => longs.enumerate().for_each(|(x, long)| put(x, f32::from_ne_bytes(*long))),
            SampleType::U32 => longs.enumerate().for_each(|(x, long)| put(x, u32::from_ne_bytes(*long) as f32)),
        }
    }
    let size = block.index.pixel_size;
    let [left, top] = [block.index.pixel_position.x(), block.index.pixel_position.y()];
    for number in (0..chosen.channels()).filter(|number| chosen.numbers[*number].is_none()) {
        for y in top..top + size.height() {
            (left..left + size.width()).for_each(|x| put(x, y, number, 1.0));
        }
    }
}
