//! Spectra whose value is known at every wavelength.

use std::borrow::Cow;
use std::sync::Arc;

use super::data::{self, Glass, Grid, Metal};
use super::texture::checker_cell;
use super::{Quantity, Texture, Upsampler};

/// Where the bands of the `rgb` basis read an index, in nm: the hydrogen C, mercury e and hydrogen F lines.
pub(super) const BAND_WAVELENGTHS_NM: [f64; 3] = [656.27, 546.07, 486.13];

/// A spectrum as a scene file gives it, with names looked up and files read. In a scene it is a number, a name of the
/// catalog, or a table with one kind and an optional `scale`.
///
/// ```toml
/// reflectance = 0.5
/// reflectance = { rgb = [0.7, 0.5, 0.3] }
/// reflectance = "dark skin"
/// reflectance = { file = "paint.csv", column = 2 }
/// reflectance = { image = "wood.png", repeat = 4 }
/// # encoding = "srgb", channel, wrap = "repeat", filter = "linear", scale
/// reflectance = { checker = [0.1, "dark skin"], repeat = [8, 8] }
/// index = "N-SF11"
/// index = { rgb = [1.513, 1.517, 1.523] }
/// index = { samples = [[486.1, 1.522], [656.3, 1.514]] }
/// index = { cauchy = [1.5046, 0.0042] }
/// index = { sellmeier = { b = [1.0396, 0.2318, 1.0105], c = [0.0060, 0.0200, 103.56] } }
/// index = { abbe = { nd = 1.5168, vd = 64.17 } }
/// radiance = { rgb = [1, 0.9, 0.8], scale = 10 }
/// radiance = { illuminant = "D65" }
/// radiance = { blackbody = 5600, luminance = 3 }
/// radiance = { lines = [[589.0, 2], [589.6, 1]] }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The spectrum before scaling.
    pub kind: CurveKind,
    /// A factor on every value.
    pub scale: f64,
    /// CIE Y of an emission, instead of a factor.
    pub luminance: Option<f64>,
}

/// The kinds of spectra.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CurveKind {
    /// The same value at every wavelength; as an emission, that multiple of the film's white.
    Number(f64),
    /// Linear Rec.709; as an index, its values at 656.27, 546.07 and 486.13 nm.
    Rgb([f64; 3]),
    /// (wavelength in nm, value), ascending, at least one. Linear in between and constant beyond the ends, where an
    /// emission is 0.
    Samples(Vec<[f64; 2]>),
    /// n = A + B / wavelength^2, wavelength in um (Cauchy 1836).
    Cauchy([f64; 2]),
    /// n^2 = 1 + sum of B w^2 / (w^2 - C), w = wavelength in um, C in um^2 (Sellmeier 1871).
    Sellmeier {
        /// The strengths B.
        b: Vec<f64>,
        /// The squared resonance wavelengths C, in um^2.
        c: Vec<f64>,
    },
    /// The index of a catalog glass.
    Glass(CatalogEntry<Glass>),
    /// The index n or the extinction k of a catalog metal.
    Metal(CatalogEntry<Metal>),
    /// A measured reflectance from the catalog.
    Reflectance(CatalogEntry<Grid>),
    /// A standard light from the catalog, Y = 1.
    Illuminant(Arc<Grid>),
    /// A blackbody's light at a temperature in kelvin, Y = 1.
    Blackbody(f64),
    /// Ideal lines: (wavelength in nm, power).
    Lines(Vec<[f64; 2]>),
    /// An image.
    Texture(Texture),
    /// A checkerboard of two spectra.
    Checker {
        /// The spectra of its squares. The first one is on the square that begins at (0, 0).
        cells: Box<[Curve; 2]>,
        /// Number of squares per unit of u and of v.
        repeat: [f64; 2],
    },
}

/// An entry of the catalog.
#[derive(Clone, Debug, PartialEq)]
pub struct CatalogEntry<T> {
    /// The name by which it was looked up. Several entries may share it.
    pub name: String,
    /// The entry.
    pub entry: Arc<T>,
}

impl<T> CatalogEntry<T> {
    /// Creates the entry that a name stands for.
    pub fn new(name: &str, entry: T) -> Self {
        Self { name: name.to_owned(), entry: Arc::new(entry) }
    }
}

impl From<f64> for Curve {
    fn from(value: f64) -> Self {
        CurveKind::Number(value).into()
    }
}

impl From<CurveKind> for Curve {
    fn from(kind: CurveKind) -> Self {
        Self { kind, scale: 1.0, luminance: None }
    }
}

impl CurveKind {
    /// Returns the index of the catalog glass of that name, if there is one.
    pub fn glass(name: &str) -> Option<Self> {
        data::glass(name).map(|glass| Self::Glass(CatalogEntry::new(name, glass)))
    }

    /// Returns n and k of the catalog metal of that name, if there is one.
    pub fn metal(name: &str) -> Option<Self> {
        data::metal(name).map(|metal| Self::Metal(CatalogEntry::new(name, metal)))
    }

    /// Returns the measured reflectance of that name from the catalog, if there is one.
    pub fn reflectance(name: &str) -> Option<Self> {
        data::reflectance(name).map(|reflectance| Self::Reflectance(CatalogEntry::new(name, reflectance)))
    }

    /// Returns the standard light of that name from the catalog, if there is one.
    pub fn illuminant(name: &str) -> Option<Self> {
        data::illuminant(name).map(|light| Self::Illuminant(Arc::new(light)))
    }

    /// Returns the value at any wavelength in nm before scaling, without upsampling `rgb` to a spectrum. For a light
    /// this is the power, and ideal lines have none between them. For a curve that varies over a surface, it is the
    /// value that its image or pattern multiplies.
    pub fn values(&self, quantity: Quantity) -> Box<dyn Fn(f64) -> f64 + '_> {
        match self {
            Self::Number(value) => Box::new(move |_| *value),
            Self::Rgb([red, green, blue]) => {
                let [r, g, b] = BAND_WAVELENGTHS_NM;
                let samples = [[b, *blue], [g, *green], [r, *red]];
                Box::new(move |nm| interpolate(&samples, nm))
            }
            Self::Samples(samples) => Box::new(move |nm| interpolate(samples, nm)),
            Self::Cauchy([a, b]) => Box::new(move |nm| a + b / (nm * nm * 1e-6)),
            Self::Sellmeier { b, c } => Box::new(move |nm| sellmeier_squared(b, c, nm * 1e-3).sqrt()),
            Self::Glass(glass) => Box::new(move |nm| glass.entry.index(nm)),
            Self::Metal(metal) => {
                let which = usize::from(quantity == Quantity::MetalExtinction);
                Box::new(move |nm| metal.entry.nk(nm)[which])
            }
            Self::Reflectance(reflectance) => Box::new(move |nm| reflectance.entry.at(nm)),
            Self::Illuminant(light) => Box::new(move |nm| light.at(nm)),
            Self::Blackbody(kelvin) => Box::new(move |nm| planck(*kelvin, nm)),
            Self::Lines(_) => Box::new(|_| 0.0),
            Self::Texture(_) | Self::Checker { .. } => Box::new(|_| 1.0),
        }
    }

    /// Returns the three numbers of a color, if it is not a measured spectrum.
    pub fn rgb(&self) -> Option<[f64; 3]> {
        match self {
            Self::Number(value) => Some([*value; 3]),
            Self::Rgb(rgb) => Some(*rgb),
            _ => None,
        }
    }

    /// Returns the mean of red, green and blue at a place of the surface or, if the curve does not vary, everywhere.
    pub fn brightness_at(&self, uv: [f64; 2]) -> f64 {
        match self {
            Self::Texture(texture) => texture.color(uv).iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0,
            Self::Checker { cells, repeat } => {
                let cell = &cells[checker_cell(*repeat, uv)];
                cell.scale * cell.kind.mean()
            }
            _ => self.mean(),
        }
    }

    /// Returns the number of texels or squares per unit of u and of v; `None` if it does not vary over a surface.
    pub fn resolution(&self) -> Option<[f64; 2]> {
        match self {
            Self::Texture(Texture { image, placement }) => {
                let [across, up] = placement.repeat;
                Some([across * image.width() as f64, up * image.height() as f64])
            }
            Self::Checker { repeat, .. } => Some(*repeat),
            _ => None,
        }
    }

    /// Returns the mean of red, green and blue over the surface.
    pub(super) fn mean(&self) -> f64 {
        match self {
            Self::Texture(texture) => texture.image.mean().iter().sum::<f64>() / 3.0,
            Self::Checker { cells, .. } => 0.5 * cells.iter().map(|cell| cell.scale * cell.kind.mean()).sum::<f64>(),
            _ => self.rgb().map_or(1.0, |rgb| rgb.iter().sum::<f64>() / 3.0),
        }
    }
}

impl Curve {
    /// Returns the value at any wavelength in nm.
    ///
    /// An `rgb` reflectance or transmittance becomes the smooth spectrum that `upsampler` finds, and an absorption
    /// becomes a multiple of one. An index is interpolated linearly between 486.13, 546.07 and 656.27 nm.
    pub fn reader(&self, quantity: Quantity, upsampler: &Upsampler) -> Box<dyn Fn(f64) -> f64 + '_> {
        let scale = self.scale;
        match (&self.kind, quantity) {
            (CurveKind::Rgb(rgb), Quantity::Reflectance | Quantity::Transmittance | Quantity::Share) => {
                let sigmoid = upsampler.fit(rgb.map(|x| x * scale));
                Box::new(move |nm| sigmoid.at(nm))
            }
            (CurveKind::Rgb(rgb), Quantity::Absorption) => {
                let twice = 2.0 * rgb.iter().fold(f64::MIN_POSITIVE, |most: f64, &x| most.max(x));
                let sigmoid = upsampler.fit(rgb.map(|x| x / twice));
                Box::new(move |nm| scale * twice * sigmoid.at(nm))
            }
            _ => self.values(quantity),
        }
    }

    /// Returns the value at any wavelength in nm, without upsampling `rgb` to a spectrum.
    pub fn values(&self, quantity: Quantity) -> Box<dyn Fn(f64) -> f64 + '_> {
        let (scale, values) = (self.scale, self.kind.values(quantity));
        Box::new(move |nm| scale * values(nm))
    }

    /// Returns whether the curve is defined by wavelength, so that three numbers cannot hold it.
    pub fn is_measured(&self) -> bool {
        match &self.kind {
            CurveKind::Texture(_) => false,
            CurveKind::Checker { cells, .. } => cells.iter().any(Self::is_measured),
            kind => kind.rgb().is_none(),
        }
    }

    /// Returns whether it varies over a surface.
    pub fn varies(&self) -> bool {
        matches!(self.kind, CurveKind::Texture(_) | CurveKind::Checker { .. })
    }

    /// Returns whether it is 0 everywhere, as an emission.
    pub fn is_dark(&self) -> bool {
        let dark = match &self.kind {
            CurveKind::Number(value) => *value == 0.0,
            CurveKind::Rgb(rgb) => rgb.iter().all(|x| *x == 0.0),
            CurveKind::Samples(pairs) | CurveKind::Lines(pairs) => pairs.iter().all(|pair| pair[1] == 0.0),
            kind => self.varies() && kind.mean() == 0.0,
        };
        dark || self.scale == 0.0 || self.luminance == Some(0.0)
    }

    /// Returns the emission that an image or a checkerboard filters: white. Any other curve is returned as it is.
    pub fn level(&self) -> Cow<'_, Self> {
        match self.varies() {
            true => Cow::Owned(Self { scale: self.scale, ..1.0.into() }),
            false => Cow::Borrowed(self),
        }
    }

    /// Returns spectra that represent all those on the surface: the curve itself if it does not vary, the curves of a
    /// checkerboard, or the mean and the most colorful texel of an image.
    pub fn representatives(&self) -> Vec<Cow<'_, Self>> {
        match &self.kind {
            CurveKind::Texture(Texture { image, .. }) => {
                let of = |rgb: [f64; 3]| Cow::Owned(Self { kind: CurveKind::Rgb(rgb), ..self.clone() });
                vec![of(image.mean()), of(image.most_colorful().map(f64::from))]
            }
            CurveKind::Checker { cells, .. } => cells.iter().flat_map(Self::representatives).collect(),
            _ => vec![Cow::Borrowed(self)],
        }
    }

    /// Returns the lightest texel of each image on the surface, as a curve.
    pub fn lightest(&self) -> Vec<Cow<'_, Self>> {
        match &self.kind {
            CurveKind::Texture(Texture { image, .. }) => {
                vec![Cow::Owned(Self { kind: CurveKind::Rgb(image.lightest().map(f64::from)), ..self.clone() })]
            }
            CurveKind::Checker { cells, .. } => cells.iter().flat_map(Self::lightest).collect(),
            _ => Vec::new(),
        }
    }
}

/// Interpolates linearly between samples; constant beyond the ends.
pub(super) fn interpolate(samples: &[[f64; 2]], x: f64) -> f64 {
    crate::math::interpolate(samples, x)[1]
}

/// Returns the squared index of a Sellmeier curve at a wavelength in um.
pub fn sellmeier_squared(b: &[f64], c: &[f64], um: f64) -> f64 {
    let w2 = um * um;
    1.0 + b.iter().zip(c).map(|(b, c)| b * w2 / (w2 - c)).sum::<f64>()
}

/// Returns Cauchy's A and B (um^2) for n_d and V_d, with the lines C 656.27, d 587.56 and F 486.13 nm.
pub fn cauchy_from_abbe(nd: f64, vd: f64) -> [f64; 2] {
    let inverse_square = |nm: f64| 1.0 / (nm * 1e-3 * nm * 1e-3);
    let b = (nd - 1.0) / (vd * (inverse_square(486.13) - inverse_square(656.27)));
    [nd - b * inverse_square(587.56), b]
}

/// Returns the radiance of a blackbody per wavelength, relative to that at 560 nm (Planck 1901). The constant c2 is
/// 1.438776877e-2 m K (CODATA 2018).
fn planck(kelvin: f64, wavelength_nm: f64) -> f64 {
    const SECOND_RADIATION_CONSTANT: f64 = 1.438_776_877e7; // nm K
    const REFERENCE_NM: f64 = 560.0;
    let exponent = |nm: f64| SECOND_RADIATION_CONSTANT / (nm * kelvin);
    let ratio = libm::expm1(exponent(REFERENCE_NM)) / libm::expm1(exponent(wavelength_nm));
    libm::pow(REFERENCE_NM / wavelength_nm, 5.0) * ratio
}
