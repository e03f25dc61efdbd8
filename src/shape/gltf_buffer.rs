//! The numbers in glTF files: buffers, views of buffers, and accessors, which read from views.

use std::fs;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use serde::Deserialize;

/// Decodes base 64 (RFC 4648, section 4) with or without padding.
const BASE_64: GeneralPurpose = GeneralPurpose::new(
    &STANDARD,
    GeneralPurposeConfig::new()
        .with_decode_padding_mode(DecodePaddingMode::Indifferent)
        .with_decode_allow_trailing_bits(true),
);

/// A block of bytes: in a separate file, in a data URI, or in the binary chunk.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

/// A part of a buffer.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

/// Typed entries of a view.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Sparse>,
}

/// Entries that replace those of the view, or zeros if there is no view (section 3.6.2.3 of the specification).
#[derive(Deserialize)]
struct Sparse {
    count: usize,
    indices: SparsePlace,
    values: SparsePlace,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct SparsePlace {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    #[serde(default)]
    component_type: u32,
}

/// The bytes of all buffers.
pub(super) struct Store {
    buffers: Vec<Vec<u8>>,
    /// The separate files that they were read from.
    pub(super) files: Vec<PathBuf>,
}

impl Store {
    pub(super) fn open(buffers: &[Buffer], folder: &Path, binary: Option<&[u8]>) -> Result<Self, String> {
        let mut store = Self { buffers: Vec::new(), files: Vec::new() };
        for (number, buffer) in buffers.iter().enumerate() {
            let bytes = match (&buffer.uri, binary) {
                (None, Some(binary)) if number == 0 => binary.to_vec(),
                (None, _) => return Err(format!("buffer {number} has no bytes")),
                (Some(uri), _) => match uri.strip_prefix("data:") {
                    Some(data) => {
                        let text = data.split_once(";base64,").map(|(_, text)| text);
                        text.and_then(|text| BASE_64.decode(text).ok())
                            .ok_or_else(|| format!("buffer {number} is not base64 text"))?
                    }
                    None => {
                        let path = folder.join(percent_decoded(uri));
                        if !path.is_file() {
                            return Err(format!("there is no file {uri} beside it"));
                        }
                        let bytes = fs::read(&path).map_err(|error| format!("cannot read {uri}: {error}"))?;
                        store.files.push(path);
                        bytes
                    }
                },
            };
            if bytes.len() < buffer.byte_length {
                let (has, declared) = (bytes.len(), buffer.byte_length);
                return Err(format!("buffer {number} has {has} bytes, not {declared}"));
            }
            store.buffers.push(bytes);
        }
        Ok(store)
    }
}

/// An accessor with the views and buffers that it reads from.
pub(super) struct AccessorData<'a> {
    accessor: &'a Accessor,
    number: usize,
    views: &'a [BufferView],
    store: &'a Store,
}

impl Accessor {
    pub(super) fn data<'a>(&'a self, number: usize, views: &'a [BufferView], store: &'a Store) -> AccessorData<'a> {
        AccessorData { accessor: self, number, views, store }
    }
}

const BYTE: u32 = 5120;
const UNSIGNED_BYTE: u32 = 5121;
const SHORT: u32 = 5122;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Returns the number of bytes of a component.
fn component_size(component_type: u32) -> usize {
    match component_type {
        BYTE | UNSIGNED_BYTE => 1,
        SHORT | UNSIGNED_SHORT => 2,
        _ => 4,
    }
}

impl<'a> AccessorData<'a> {
    /// Reads entries of K numbers. Normalized integers stand for 0 to 1, or for -1 to 1 if they are signed (section
    /// 3.6.2.2 of the specification).
    pub(super) fn floats<const K: usize>(&self) -> Result<Vec<[f32; K]>, String> {
        let Accessor { component_type, normalized, kind, .. } = self.accessor;
        let is_vector = *kind == format!("VEC{K}");
        let read: fn(&[u8]) -> f32 = match (*component_type, normalized) {
            (FLOAT, _) => |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
            (BYTE, true) => |b| (f32::from(b[0] as i8) / 127.0).max(-1.0),
            (BYTE, false) => |b| f32::from(b[0] as i8),
            (UNSIGNED_BYTE, true) => |b| f32::from(b[0]) / 255.0,
            (UNSIGNED_BYTE, false) if is_vector => |b| f32::from(b[0]),
            (SHORT, true) => |b| (f32::from(i16::from_le_bytes([b[0], b[1]])) / 32767.0).max(-1.0),
            (SHORT, false) => |b| f32::from(i16::from_le_bytes([b[0], b[1]])),
            (UNSIGNED_SHORT, true) => |b| f32::from(u16::from_le_bytes([b[0], b[1]])) / 65535.0,
            (UNSIGNED_SHORT, false) if is_vector => |b| f32::from(u16::from_le_bytes([b[0], b[1]])),
            _ => return Err(format!("accessor {} has components of type {component_type}", self.number)),
        };
        if !is_vector {
            return Err(format!("accessor {} is of type {kind:?}, not VEC{K}", self.number));
        }
        let step = component_size(*component_type);
        self.entries(K * step, |entry| std::array::from_fn(|i| read(&entry[i * step..])))
    }

    /// Reads unsigned integers of any width.
    pub(super) fn whole_numbers(&self) -> Result<Vec<u32>, String> {
        let Accessor { component_type, kind, .. } = self.accessor;
        let (true, Some(read)) = (kind == "SCALAR", whole_number(*component_type)) else {
            return Err(format!("accessor {} does not hold whole numbers", self.number));
        };
        self.entries(component_size(*component_type), read)
    }

    fn entries<T>(&self, width: usize, read: impl Fn(&[u8]) -> T) -> Result<Vec<T>, String> {
        let Accessor { buffer_view, byte_offset, count, sparse, .. } = self.accessor;
        let mut entries: Vec<T> = match (buffer_view, sparse) {
            (Some(view), _) => self.view(*view, *byte_offset, *count, width)?.map(&read).collect(),
            // Zeros take no bytes, but the data that they belong to does.
            (None, Some(_)) if *count > self.store.buffers.iter().map(Vec::len).sum() => {
                return Err(format!("accessor {} has more entries than the buffers have bytes", self.number));
            }
            (None, Some(_)) => {
                let zero = vec![0; width];
                (0..*count).map(|_| read(&zero)).collect()
            }
            (None, None) => return Err(format!("accessor {} has no buffer view", self.number)),
        };
        if let Some(Sparse { count, indices, values }) = sparse {
            let index = whole_number(indices.component_type)
                .ok_or_else(|| format!("accessor {} has no integer indices", self.number))?;
            let places =
                self.view(indices.buffer_view, indices.byte_offset, *count, component_size(indices.component_type))?;
            for (place, value) in places.zip(self.view(values.buffer_view, values.byte_offset, *count, width)?) {
                let place = index(place) as usize;
                *entries.get_mut(place).ok_or_else(|| format!("accessor {} has no entry {place}", self.number))? =
                    read(value);
            }
        }
        Ok(entries)
    }

    /// Returns the bytes of each entry of a view, starting at an offset.
    fn view(
        &self,
        number: usize,
        offset: usize,
        count: usize,
        width: usize,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
        let view = self.views.get(number).ok_or_else(|| format!("there is no buffer view {number}"))?;
        let buffer =
            self.store.buffers.get(view.buffer).ok_or_else(|| format!("there is no buffer {}", view.buffer))?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|end| buffer.get(view.byte_offset..end));
        let bytes = bytes.ok_or_else(|| format!("buffer view {number} reaches beyond buffer {}", view.buffer))?;
        let stride = view.byte_stride.unwrap_or(width);
        let last = count.checked_sub(1).map_or(Some(0), |steps| steps.checked_mul(stride)?.checked_add(width));
        let is_within =
            stride > 0 && last.and_then(|last| last.checked_add(offset)).is_some_and(|last| last <= bytes.len());
        if !is_within {
            return Err(format!("accessor {} reaches beyond buffer view {number}", self.number));
        }
        Ok((0..count).map(move |i| &bytes[offset + i * stride..][..width]))
    }
}

fn whole_number(component_type: u32) -> Option<fn(&[u8]) -> u32> {
    match component_type {
        UNSIGNED_BYTE => Some(|b| u32::from(b[0])),
        UNSIGNED_SHORT => Some(|b| u32::from(u16::from_le_bytes([b[0], b[1]]))),
        UNSIGNED_INT => Some(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])),
        _ => None,
    }
}

/// Decodes %20 and the like in an address into the bytes that they stand for (RFC 3986, section 2.1).
fn percent_decoded(uri: &str) -> String {
    let (mut bytes, mut rest) = (Vec::new(), uri.as_bytes());
    while let Some((&first, after)) = rest.split_first() {
        let digits = after.get(..2).filter(|digits| first == b'%' && digits.iter().all(u8::is_ascii_hexdigit));
        let digits = digits.and_then(|digits| std::str::from_utf8(digits).ok());
        let escaped = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        bytes.push(escaped.unwrap_or(first));
        rest = if escaped.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_hexadecimal_digits_behind_a_percent_sign_are_a_byte_and_nothing_else_is() {
        assert_eq!(percent_decoded("a%20b%c3%A4%+5%2%"), "a b\u{e4}%+5%2%");
    }
}
