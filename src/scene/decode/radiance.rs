//! Radiance pictures (.hdr): four bytes of a texel, of red, green, blue and the exponent that they share.
//!
//! G. Ward, "Real Pixels", Graphics Gems II (1991); "Radiance File Formats", Lawrence Berkeley National Laboratory.

use super::texels::{Floats, Unreadable};
use crate::film::fits;
use crate::spectrum::IDENTITY;

const SIGNATURE: &[u8] = b"#?RADIANCE";
const FORMAT: &str = "32-bit_rle_rgbe";
/// Texels of a row that can be packed in the newer way.
const PACKED: std::ops::Range<usize> = 8..1 << 15;

/// Reads a picture of RGBE, packed in the newer way, the older one or not at all. Its exposure is not undone.
///
/// # Errors
/// If it is none, is damaged, or claims a size that it cannot have.
pub(in crate::scene) fn decode(bytes: &[u8]) -> Result<Floats, Unreadable> {
    let rest = bytes.strip_prefix(SIGNATURE).ok_or(Unreadable::Signature)?;
    let mut reader = Reader { rest, row: 0 };
    let [width, height] = reader.size()?;
    let length = 12_u64.saturating_mul(width as u64).saturating_mul(height as u64);
    fits(width, height, length, bytes).map_err(Unreadable::Unfit)?;
    // Colors are whole multiples of 2^(exponent - 136); an exponent of 0 is black.
    let unit = |exponent: usize| if exponent == 0 { 0.0 } else { libm::ldexp(1.0, exponent as i32 - 136) as f32 };
    let units: [f32; 256] = std::array::from_fn(unit);
    let mut texels = vec![[0; 4]; width];
    let mut numbers = Vec::with_capacity(3 * width * height);
    for row in 0..height {
        reader.row = row;
        reader.fill(&mut texels)?;
        numbers.extend(texels.iter().flat_map(|&[r, g, b, e]| [r, g, b].map(|c| f32::from(c) * units[usize::from(e)])));
    }
    Ok(Floats { width, channels: 3, has_alpha: false, is_lossy: false, to_rec709: Ok(IDENTITY), numbers })
}

/// What is not read yet, and the row that is.
struct Reader<'b> {
    rest: &'b [u8],
    row: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N], Unreadable> {
        let (first, rest) = self.rest.split_first_chunk().ok_or(Unreadable::Short)?;
        self.rest = rest;
        Ok(*first)
    }

    fn line(&mut self) -> Result<String, Unreadable> {
        let end = self.rest.iter().position(|&byte| byte == b'\n').ok_or(Unreadable::Short)?;
        let line = String::from_utf8_lossy(&self.rest[..end]).into_owned();
        self.rest = &self.rest[end + 1..];
        Ok(line)
    }

    /// Width and height, at the end of the header.
    fn size(&mut self) -> Result<[usize; 2], Unreadable> {
        self.line()?;
        loop {
            let line = self.line()?;
            match line.split_once('=') {
                Some((key, format)) if key.trim() == "FORMAT" && format.trim() != FORMAT => {
                    return Err(Unreadable::Format(beginning(format.trim())));
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
        size.map(|(width, height)| [width, height]).ok_or_else(|| Unreadable::Size(beginning(&line)))
    }

    fn fill(&mut self, texels: &mut [[u8; 4]]) -> Result<(), Unreadable> {
        match *self.rest {
            [2, 2, high @ 0..128, low, ref rest @ ..] if PACKED.contains(&texels.len()) => {
                self.rest = rest;
                if texels.len() != usize::from(u16::from_be_bytes([high, low])) {
                    return Err(Unreadable::Row(self.row));
                }
                (0..4).try_for_each(|channel| self.fill_channel(texels, channel))
            }
            _ => self.fill_texels(texels),
        }
    }

    /// The newer way: the bytes of one channel, runs of one byte among them.
    fn fill_channel(&mut self, texels: &mut [[u8; 4]], channel: usize) -> Result<(), Unreadable> {
        let mut rest = texels;
        while !rest.is_empty() {
            let [count] = self.take()?;
            let length = usize::from(if count > 128 { count - 128 } else { count });
            let (some, others) = rest.split_at_mut_checked(length).ok_or(Unreadable::Row(self.row))?;
            if count > 128 {
                let [byte] = self.take()?;
                some.iter_mut().for_each(|texel| texel[channel] = byte);
            } else {
                some.iter_mut().try_for_each(|texel| self.take().map(|[byte]| texel[channel] = byte))?;
            }
            rest = others;
        }
        Ok(())
    }

    /// The older way: texels one by one, and runs of the last one, each written as a texel of three ones and a count.
    /// Runs that follow each other are the digits of one length to base 256, the lowest first.
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

/// As much of a line as a message can hold.
fn beginning(line: &str) -> String {
    line.chars().take(40).collect()
}
