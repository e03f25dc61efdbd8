//! The headers of an OpenEXR file. The same attributes always give the same bytes.

use std::io::Cursor;
use std::ops::Range;

use exr::error::{Error, Result};
use exr::meta::header::Header;

/// The bytes of the magic number and version, before the first attribute.
const HEADER_START: usize = 8;
/// The bit for multipart files, in the second byte of the version.
const MULTIPART_BIT: u8 = 0x10;

/// Encodes everything up to the table of block offsets, with the attributes of each part in alphabetical order.
///
/// The library keeps attributes in a hash map, whose order changes from run to run.
///
/// # Errors
/// If the library finds that not every program could read the file.
pub(super) fn encode(headers: &[Header]) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    // The library writes the headers, and then requests the blocks.
    match exr::block::write(&mut bytes, headers.iter().cloned().collect(), true, |_, _| Err(Error::Aborted)) {
        Ok(()) | Err(Error::Aborted) => {}
        Err(error) => return Err(error),
    }
    let mut bytes = bytes.into_inner();
    let parts = attributes(&bytes);
    for entries in &parts.by_part {
        let mut sorted: Vec<Vec<u8>> = entries.iter().map(|entry| bytes[entry.clone()].to_vec()).collect();
        sorted.sort();
        if let Some(first) = entries.first() {
            let sorted = sorted.concat();
            bytes[first.start..first.start + sorted.len()].copy_from_slice(&sorted);
        }
    }
    bytes.truncate(parts.end);
    Ok(bytes)
}

/// Sets an int attribute of the first part, if it exists. Counts beyond 2^31 - 1 are clamped to that.
pub(super) fn set_count(head: &mut [u8], name: &str, count: u64) {
    let prefix = [name.as_bytes(), b"\0int\0"].concat();
    let by_part = attributes(head).by_part;
    let found =
        by_part.first().and_then(|entries| entries.iter().find(|entry| head[(*entry).clone()].starts_with(&prefix)));
    if let Some(entry) = found {
        let count = i32::try_from(count).unwrap_or(i32::MAX);
        head[entry.end - size_of::<i32>()..entry.end].copy_from_slice(&count.to_le_bytes());
    }
}

/// The positions of the attributes.
struct Attributes {
    /// The byte range of each attribute, part by part.
    by_part: Vec<Vec<Range<usize>>>,
    /// The end of the last part's header.
    end: usize,
}

fn attributes(file: &[u8]) -> Attributes {
    let text_end = |start: usize| start + file[start..].iter().position(|&byte| byte == 0).unwrap_or(0) + 1;
    let is_multipart = file[5] & MULTIPART_BIT != 0;
    let (mut position, mut by_part) = (HEADER_START, Vec::new());
    loop {
        let mut entries = Vec::new();
        while file[position] != 0 {
            let size_at = text_end(text_end(position));
            let size = u32::from_le_bytes([file[size_at], file[size_at + 1], file[size_at + 2], file[size_at + 3]]);
            let end = size_at + 4 + size as usize;
            entries.push(position..end);
            position = end;
        }
        position += 1;
        // The list of headers of a multipart file ends with an empty header.
        if is_multipart && entries.is_empty() {
            return Attributes { by_part, end: position };
        }
        by_part.push(entries);
        if !is_multipart {
            return Attributes { by_part, end: position };
        }
    }
}
