//! What the numbers of an image stand for, and which values they can have.

use std::path::Path;

use crate::scene::text::Fault;
use crate::spectrum::{Encoding, Matrix, apply, decode_srgb};

/// Largest rounding error of a 16-bit float, relative to its value.
const HALF_ROUNDING: f64 = 1.0 / 2048.0;

/// What the numbers of an image stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Meaning {
    /// Light or the color of a surface, encoded as the scene says or else as the kind of file implies.
    Light(Option<Encoding>),
    /// Shares of a surface, which are not colors, encoded as the scene says or else as the kind of file implies.
    Shares(Option<Encoding>),
    /// Thicknesses, encoded as the scene says.
    Thicknesses(Encoding),
    /// Heights, without an encoding.
    Heights,
    /// Directions. The middle of the range of whole numbers means 0; for other numbers, one half does.
    Directions,
}

impl Meaning {
    /// Returns whether numbers are encoded as sRGB. `implied` says whether the kind of file implies it.
    pub(super) fn is_srgb(self, implied: bool) -> bool {
        match self {
            Self::Light(encoding) | Self::Shares(encoding) => encoding.map_or(implied, |it| it == Encoding::Srgb),
            Self::Thicknesses(encoding) => encoding == Encoding::Srgb,
            Self::Heights | Self::Directions => false,
        }
    }
}

/// The numbers of an image, rows from the top.
pub(super) struct Texels<'p> {
    pub(super) path: &'p Path,
    pub(super) width: usize,
    /// Numbers per texel.
    pub(super) channels: usize,
    pub(super) numbers: Vec<f32>,
}

impl Texels<'_> {
    /// Refuses numbers that neither light nor a surface can have. Negative ones that are only noise become 0.
    pub(super) fn check(&mut self, meaning: Meaning, is_lossy: bool) -> Result<(), Fault> {
        let (allowed, help) = match meaning {
            Meaning::Light(_) => (0.0..=f32::MAX, "light is finite and not negative"),
            Meaning::Shares(_) => (0.0..=f32::MAX, "shares are finite and not negative"),
            Meaning::Thicknesses(_) => (0.0..=f32::MAX, "thicknesses are finite and not negative"),
            Meaning::Heights => (f32::MIN..=f32::MAX, "heights are finite"),
            Meaning::Directions => {
                (0.0..=1.0, "directions are stored as numbers from 0 to 1, where one half stands for 0")
            }
        };
        if *allowed.start() == 0.0 {
            let noise = if is_lossy { f32::MAX } else { self.noise() };
            self.numbers.iter_mut().filter(|x| **x < 0.0 && -**x <= noise).for_each(|x| *x = 0.0);
        }
        let is_wrong = |x: &f32| !allowed.contains(x);
        let Some(at) = self.numbers.chunks_exact(self.channels).position(|texel| texel.iter().any(is_wrong)) else {
            return Ok(());
        };
        let texel = &self.numbers[at * self.channels..(at + 1) * self.channels];
        let (x, y) = (at % self.width, at / self.width);
        let message = format!("{}: pixel ({x}, {y}) is {texel:?}", self.path.display());
        let is_negative = texel.iter().filter(|x| is_wrong(x)).all(|x| x.is_finite() && *x < 0.0);
        let save = if is_negative { ": save the image with its negative values set to 0" } else { "" };
        Err(Fault::new(message, format!("{help}{save}")))
    }

    /// Returns how far below 0 a number counts as noise: if all numbers were off by that much, their mean would be off
    /// by no more than its rounding to 16 bits. Filters, conversions and earlier lossy compressions leave such numbers
    /// behind.
    fn noise(&self) -> f32 {
        let sum: f64 = self.numbers.iter().filter(|x| **x > 0.0).map(|x| f64::from(*x)).sum();
        (HALF_ROUNDING * sum / self.numbers.len() as f64) as f32
    }

    /// Decodes sRGB numbers to linear ones.
    pub(super) fn decode_srgb(&mut self) {
        self.numbers.iter_mut().for_each(|x| *x = decode_srgb(f64::from(*x)) as f32);
    }

    /// Converts colors to linear Rec.709. Returns a warning about those that lie outside of it.
    ///
    /// Negative results become 0. They count as rounding errors, without a warning, if the rounding to halves in the
    /// file could have caused them.
    pub(super) fn convert(&mut self, to_rec709: &Matrix) -> Option<String> {
        let rounding = to_rec709.map(|row| row.map(|x| HALF_ROUNDING * x.abs()));
        let (mut first, mut count) = (0, 0);
        for (at, texel) in self.numbers.as_chunks_mut().0.iter_mut().enumerate() {
            let color = texel.map(f64::from);
            let (found, rounded) = (apply(to_rec709, color), apply(&rounding, color));
            if (0..3).any(|c| found[c] < -rounded[c]) {
                first = if count == 0 { at } else { first };
                count += 1;
            }
            *texel = found.map(|x| x.clamp(0.0, f32::MAX.into()) as f32);
        }
        let [x, y] = [first % self.width, first / self.width];
        let others = match count {
            0 => return None,
            1 => String::new(),
            2 => ", as does 1 other".to_owned(),
            _ => format!(", as do {} others", count - 1),
        };
        let warning = format!("{}: pixel ({x}, {y}) lies outside Rec.709{others}", self.path.display());
        Some(format!("{warning}: negative values there count as 0"))
    }
}
