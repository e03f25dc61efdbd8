//! Tables that vary over a surface.

use std::borrow::Cow;

use super::palette::Palette;
use super::texture::square;
use super::{Basis, Curve, CurveKind, Draw, Lanes, Quantity, Table, Texture};

/// How a table varies over a surface: a factor on its numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pattern {
    kind: PatternKind,
    /// What rounding keeps the product below: 1 of a reflectance or a transmittance.
    most: f32,
    /// The mean brightness of the factor over the image, a third of red, green and blue.
    mean: f64,
}

#[derive(Clone, Debug, PartialEq)]
enum PatternKind {
    /// With the palette of its colors, unless red, green and blue are the lanes.
    Image(Texture, Option<Palette>),
    Checker {
        cells: [Table; 2],
        repeat: [f64; 2],
    },
}

impl<const N: usize> Draw<N> {
    /// A weight at a place of a surface; the place counts only where the table varies.
    #[inline]
    pub fn read_at(&self, table: &Table, uv: [f64; 2]) -> Lanes<N> {
        match table.pattern() {
            None => self.read(table),
            Some(pattern) => self.read_pattern(table, pattern, uv),
        }
    }

    /// A color, of numbers as large as they may be, as a factor on white light; the table is that of an image. What has no
    /// colors tints nothing.
    pub fn tint(&self, table: &Table, color: [f32; 3]) -> Lanes<N> {
        match table.pattern().map(|pattern| &pattern.kind) {
            Some(PatternKind::Image(_, palette)) => self.tint_by(palette.as_ref(), color, false),
            _ => Lanes::ONE,
        }
    }

    #[inline]
    fn tint_by(&self, palette: Option<&Palette>, color: [f32; 3], bounded: bool) -> Lanes<N> {
        match palette {
            Some(palette) => palette.filter(self, color, bounded),
            None => Lanes::from_fn(|i| color[i.min(2)]),
        }
    }

    #[inline(never)]
    fn read_pattern(&self, table: &Table, pattern: &Pattern, uv: [f64; 2]) -> Lanes<N> {
        let filter = match &pattern.kind {
            PatternKind::Image(texture, palette) => {
                self.tint_by(palette.as_ref(), texture.color(uv), pattern.most == 1.0)
            }
            PatternKind::Checker { cells, repeat } => self.read_at(&cells[square(*repeat, uv)], uv),
        };
        let product = self.read(table) * filter;
        Lanes::from_fn(|i| product[i].min(pattern.most))
    }
}

impl Table {
    /// The brightest number; of a table that varies the mean of what it is brought to.
    pub fn brightness(&self) -> f64 {
        let brightest = self.range().1.max(0.0);
        self.pattern().map_or(brightest, |pattern| brightest * pattern.mean)
    }
}

impl Basis {
    /// A curve that varies over a surface, read onto the bins; none if it is the same all over.
    pub(super) fn patterned(&self, quantity: Quantity, curve: &Curve) -> Option<Table> {
        let of_filter = |curve: &Curve| self.tabulate(Quantity::Transmittance, curve);
        let kind = match &curve.kind {
            CurveKind::Texture(texture) => {
                let palette = (!self.has_rgb_lanes()).then(|| Palette::new(self));
                PatternKind::Image(texture.clone(), palette)
            }
            CurveKind::Checker { cells, repeat } => {
                PatternKind::Checker { cells: cells.each_ref().map(of_filter), repeat: *repeat }
            }
            _ => return None,
        };
        let shines = quantity == Quantity::Emission;
        let level = match shines {
            true => self.tabulate(quantity, &curve.level()),
            false => self.even(curve.scale),
        };
        let most = if shines { f32::INFINITY } else { 1.0 };
        Some(level.varied(Pattern { kind, most, mean: curve.kind.mean() }))
    }
}

impl CurveKind {
    /// The mean of its red, green and blue over the surface.
    fn mean(&self) -> f64 {
        match self {
            Self::Texture(texture) => texture.image.mean().iter().sum::<f64>() / 3.0,
            Self::Checker { cells, .. } => 0.5 * cells.iter().map(|cell| cell.scale * cell.kind.mean()).sum::<f64>(),
            _ => self.rgb().map_or(1.0, |rgb| rgb.iter().sum::<f64>() / 3.0),
        }
    }
}

impl Curve {
    /// Whether it is different at different places of a surface.
    pub fn varies(&self) -> bool {
        matches!(self.kind, CurveKind::Texture(_) | CurveKind::Checker { .. })
    }

    /// Whether it is 0 everywhere, as an emission.
    pub fn is_dark(&self) -> bool {
        let dark = match &self.kind {
            CurveKind::Number(value) => *value == 0.0,
            CurveKind::Rgb(rgb) => rgb.iter().all(|x| *x == 0.0),
            kind => self.varies() && kind.mean() == 0.0,
        };
        dark || self.scale == 0.0 || self.luminance == Some(0.0)
    }

    /// What an image or a checkerboard filters, as an emission: white; any other curve is itself.
    pub fn level(&self) -> Cow<'_, Self> {
        match self.varies() {
            true => Cow::Owned(Self { scale: self.scale, ..1.0.into() }),
            false => Cow::Borrowed(self),
        }
    }

    /// Spectra that stand for all that are on the surface: the curve itself if it is the same everywhere, the curves of a
    /// checkerboard, the mean and the most colorful texel of an image.
    pub fn shades(&self) -> Vec<Cow<'_, Self>> {
        match &self.kind {
            CurveKind::Texture(Texture { image, .. }) => {
                let of = |rgb: [f64; 3]| Cow::Owned(Self { kind: CurveKind::Rgb(rgb), ..self.clone() });
                vec![of(image.mean()), of(image.most_colorful().map(f64::from))]
            }
            CurveKind::Checker { cells, .. } => cells.iter().flat_map(Self::shades).collect(),
            _ => vec![Cow::Borrowed(self)],
        }
    }
}
