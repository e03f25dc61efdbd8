//! Radiance pictures (.hdr): four bytes per texel, for red, green, blue and their common exponent.
//!
//! G. Ward, "Real Pixels", Graphics Gems II (1991); "Radiance File Formats", Lawrence Berkeley National Laboratory.

use super::texels::{FloatImage, Unreadable, fits};
use crate::spectrum::{Matrix, Primaries, file_to_rec709};

/// Signatures of files from Radiance itself, and from other programs.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];
const FORMAT: &str = "32-bit_rle_rgbe";
/// Row lengths, in texels, that the newer packing supports.
const PACKED_WIDTHS: std::ops::Range<usize> = 8..1 << 15;

/// Reads an RGBE picture in the newer packing, the older one or none. Divides out the factors that the light was
/// multiplied by.
///
/// # Errors
/// If the file is not such a picture, is damaged, or claims an impossible size.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<FloatImage, Unreadable> {
    let rest = SIGNATURES.iter().find_map(|signature| bytes.strip_prefix(*signature)).ok_or(Unreadable::Signature)?;
    let mut reader = RadianceReader { rest, row: 0 };
    let Header { size: [width, height], factors, to_rec709 } = reader.header()?;
    let length = 12_u64.saturating_mul(width as u64).saturating_mul(height as u64);
    fits(width, height, length, bytes)?;
    // Colors are integer multiples of 2^(exponent - 136); an exponent of 0 is black.
    let unit = |exponent: usize| if exponent == 0 { 0.0 } else { libm::ldexp(1.0, exponent as i32 - 136) };
    let units: [f64; 256] = std::array::from_fn(unit);
    let mut texels = vec![[0; 4]; width];
    let mut numbers = Vec::with_capacity(3 * width * height);
    for row in 0..height {
        reader.row = row;
        reader.fill(&mut texels)?;
        numbers.extend(texels.iter().flat_map(|&[r, g, b, e]| {
            let color = [r, g, b].map(|c| f64::from(c) * units[usize::from(e)]);
            [0, 1, 2].map(|c| (color[c] / factors[c]) as f32)
        }));
    }
    Ok(FloatImage { width, channels: 3, has_alpha: false, is_lossy: false, to_rec709, numbers })
}

/// What precedes the texels.
struct Header {
    /// Width and height.
    size: [usize; 2],
    /// Factors that the red, green and blue light was multiplied by.
    factors: [f64; 3],
    /// The matrix from its primaries to linear Rec.709, or why it is not known.
    to_rec709: Result<Matrix, String>,
}

/// The bytes that are still to be read, and the current row.
struct RadianceReader<'b> {
    rest: &'b [u8],
    row: usize,
}

impl RadianceReader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let (first, rest) = self.rest.split_first_chunk().ok_or(Unreadable::Short)?;
        self.rest = rest;
        Ok(*first)
    }

    fn line(&mut self) -> Result<String, Unreadable> {
        let end = self.rest.iter().position(|&byte| byte == b'\n').ok_or(Unreadable::Short)?;
        let line = &self.rest[..end];
        let line = String::from_utf8_lossy(line.strip_suffix(b"\r").unwrap_or(line)).into_owned();
        self.rest = &self.rest[end + 1..];
        Ok(line)
    }

    /// Reads the header up to the size, which ends it. Each program that changes a picture appends its factors, so all
    /// of them have been applied.
    fn header(&mut self) -> Result<Header, Unreadable> {
        self.line()?;
        let (mut factors, mut to_rec709) = ([1.0; 3], file_to_rec709(None, None));
        loop {
            let line = self.line()?;
            match line.split_once('=') {
                Some((key, format)) if key.trim() == "FORMAT" && format.trim() != FORMAT => {
                    return Err(Unreadable::Format(beginning(format.trim())));
                }
                Some((key @ ("EXPOSURE" | "COLORCORR"), words)) => {
                    let bad = || Unreadable::Factors(key.to_owned(), beginning(words.trim()));
                    let found = numbers(words, key == "EXPOSURE").ok_or_else(bad)?;
                    factors = [0, 1, 2].map(|c| factors[c] * found[c]);
                    if !factors.iter().all(|factor| factor.is_normal()) {
                        return Err(bad());
                    }
                }
                Some(("PRIMARIES", words)) => {
                    to_rec709 = primaries(words)
                        .map_or(Err("its primaries are not known".into()), |found| file_to_rec709(None, Some(found)));
                }
                _ if line.is_empty() => break,
                _ => (),
            }
        }
        let line = self.line()?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let size = match words[..] {
            ["-Y", height, "+X", width] => width.parse().ok().zip(height.parse().ok()),
            _ => None,
        };
        let (width, height) = size.ok_or_else(|| Unreadable::Size(beginning(&line)))?;
        Ok(Header { size: [width, height], factors, to_rec709 })
    }

    fn fill(&mut self, texels: &mut [[u8; 4]]) -> Result<(), Unreadable> {
        match *self.rest {
            [2, 2, high @ 0..128, low, ref rest @ ..] if PACKED_WIDTHS.contains(&texels.len()) => {
                self.rest = rest;
                if texels.len() != usize::from(u16::from_be_bytes([high, low])) {
                    return Err(Unreadable::Row(self.row));
                }
                (0..4).try_for_each(|channel| self.fill_channel(texels, channel))
            }
            _ => self.fill_texels(texels),
        }
    }

    /// Reads one channel of a row in the newer packing: bytes, and runs of one byte among them.
    fn fill_channel(&mut self, texels: &mut [[u8; 4]], channel: usize) -> Result<(), Unreadable> {
        let mut rest = texels;
        while !rest.is_empty() {
            let [count] = self.take()?;
            let length = usize::from(if count > 128 { count - 128 } else { count });
            let (run, others) = rest.split_at_mut_checked(length).ok_or(Unreadable::Row(self.row))?;
            if count > 128 {
                let [byte] = self.take()?;
                run.iter_mut().for_each(|texel| texel[channel] = byte);
            } else {
                run.iter_mut().try_for_each(|texel| self.take().map(|[byte]| texel[channel] = byte))?;
            }
            rest = others;
        }
        Ok(())
    }

    /// Reads a row in the older packing: single texels, and runs of the last texel, each written as a texel of three
    /// ones and a count. Consecutive runs are the digits of one length to base 256, the lowest first.
    fn fill_texels(&mut self, texels: &mut [[u8; 4]]) -> Result<(), Unreadable> {
        let (mut x, mut shift) = (0, 0);
        while x < texels.len() {
            let texel = self.take()?;
            let [1, 1, 1, count] = texel else {
                texels[x] = texel;
                (x, shift) = (x + 1, 0);
                continue;
            };
            let bad = Unreadable::Row(self.row);
            let Some(length) = usize::from(count).checked_shl(shift) else { return Err(bad) };
            let (before, after) = texels.split_at_mut(x);
            let (Some(last), Some(run)) = (before.last(), after.get_mut(..length)) else { return Err(bad) };
            run.fill(*last);
            (x, shift) = (x + length, shift + 8);
        }
        Ok(())
    }
}

/// Parses x and y of red, green, blue and white.
fn primaries(words: &str) -> Option<Primaries> {
    let numbers = every_number(words)?;
    let [red, green, blue, white] = numbers.as_chunks().0.try_into().ok()?;
    (numbers.len() == 8).then_some(Primaries { red, green, blue, white })
}

fn every_number(words: &str) -> Option<Vec<f64>> {
    words.split_whitespace().map(|word| word.parse().ok()).collect()
}

/// Parses one number above 0 for all colors, or one for each.
fn numbers(words: &str, is_one: bool) -> Option<[f64; 3]> {
    let numbers = match every_number(words)?[..] {
        [all] if is_one => [all; 3],
        [red, green, blue] if !is_one => [red, green, blue],
        _ => return None,
    };
    numbers.iter().all(|number| *number > 0.0).then_some(numbers)
}

/// Returns the part of a line that fits into a message.
fn beginning(line: &str) -> String {
    line.chars().take(40).collect()
}
