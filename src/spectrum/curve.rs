//! Spectra as authors write them.

use super::basis::BAND_WAVELENGTHS_NM;
use super::curve_check::Refusal;
use super::{ImageText, Quantity, Texture, Upsampler, data};

/// A spectrum as it stands in a scene file: a number, a catalog name, or a table with one kind and maybe a `scale`.
///
/// ```toml
/// reflectance = 0.5
/// reflectance = { rgb = [0.7, 0.5, 0.3] }
/// reflectance = "dark skin"
/// reflectance = { file = "paint.csv", column = 2 }
/// reflectance = { image = "wood.png", repeat = 4 }     # encoding = "srgb", channel, wrap = "repeat", filter = "linear", scale
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
    /// CIE Y of an emission, in place of a factor.
    pub luminance: Option<f64>,
}

/// The ways to write a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveKind {
    /// The same at every wavelength; as an emission, that many times the film's white.
    Number(f64),
    /// Linear Rec.709; as an index, its values at 656.27, 546.07 and 486.13 nm.
    Rgb([f64; 3]),
    /// (wavelength in nm, value), ascending; linear between, flat beyond the ends, as an emission 0 there.
    Samples(Vec<[f64; 2]>),
    /// Samples in a text file: wavelengths in the first column, values in another, counted from 1.
    File {
        /// Its path, relative to the scene.
        file: String,
        /// The column of the values.
        column: usize,
    },
    /// A glass, a metal or a reflectance of the catalog.
    Name(String),
    /// n = A + B / wavelength^2, wavelength in um (Cauchy 1836).
    Cauchy([f64; 2]),
    /// n^2 = 1 + sum of B w^2 / (w^2 - C), w = wavelength in um, C in um^2 (Sellmeier 1871).
    Sellmeier {
        /// The strengths B.
        b: Vec<f64>,
        /// The squared resonance wavelengths C, in um^2.
        c: Vec<f64>,
    },
    /// The two-term Cauchy curve through n_d with the Abbe number V_d = (n_d - 1) / (n_F - n_C).
    Abbe {
        /// Index at 587.56 nm.
        nd: f64,
        /// Abbe number.
        vd: f64,
    },
    /// A standard light of the catalog, Y = 1.
    Illuminant(String),
    /// A blackbody's light at a temperature in kelvin, Y = 1.
    Blackbody(f64),
    /// Ideal lines: (wavelength in nm, power).
    Lines(Vec<[f64; 2]>),
    /// An image file.
    Image(ImageText),
    /// An image that was read.
    Texture(Texture),
    /// A checkerboard of two spectra.
    Checker {
        /// What is on its squares, first on the one that begins at (0, 0).
        cells: Box<[Curve; 2]>,
        /// Squares in a unit of u and of v.
        repeat: [f64; 2],
    },
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
    /// The three numbers of a color that is no measured spectrum.
    pub fn rgb(&self) -> Option<[f64; 3]> {
        match self {
            Self::Number(value) => Some([*value; 3]),
            Self::Rgb(rgb) => Some(*rgb),
            _ => None,
        }
    }
}

impl Curve {
    /// The value at any wavelength in nm, with all look-ups done once.
    ///
    /// An `rgb` reflectance or transmittance becomes the smooth spectrum that `upsampler` finds, an absorption a multiple
    /// of one, an index is read linearly between 486.13, 546.07 and 656.27 nm.
    ///
    /// # Panics
    /// If `check` would refuse the curve, or if it is an emission, which [`super::Emission`] reads.
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
            _ => self.plain_reader(quantity),
        }
    }

    /// The value at any wavelength in nm, without a spectrum being made of `rgb`.
    pub(super) fn plain_reader(&self, quantity: Quantity) -> Box<dyn Fn(f64) -> f64 + '_> {
        let scale = self.scale;
        match &self.kind {
            CurveKind::Number(value) => Box::new(move |_| scale * value),
            CurveKind::Rgb([red, green, blue]) => {
                let [r, g, b] = BAND_WAVELENGTHS_NM;
                let samples = [[b, *blue], [g, *green], [r, *red]];
                Box::new(move |nm| scale * interpolate(&samples, nm))
            }
            CurveKind::Samples(samples) => Box::new(move |nm| scale * interpolate(samples, nm)),
            CurveKind::Cauchy([a, b]) => Box::new(move |nm| scale * (a + b / (nm * nm * 1e-6))),
            CurveKind::Sellmeier { b, c } => Box::new(move |nm| scale * sellmeier_squared(b, c, nm * 1e-3).sqrt()),
            CurveKind::Abbe { nd, vd } => {
                let [a, b] = cauchy_through(*nd, *vd);
                Box::new(move |nm| scale * (a + b / (nm * nm * 1e-6)))
            }
            CurveKind::Name(name) => match quantity {
                Quantity::MetalIndex | Quantity::MetalExtinction => {
                    let metal = data::metal(name).expect("the compiler checked the metal's name");
                    let which = usize::from(quantity == Quantity::MetalExtinction);
                    Box::new(move |nm| scale * metal.nk(nm)[which])
                }
                Quantity::Index => {
                    let glass = data::glass(name).expect("the compiler checked the glass's name");
                    Box::new(move |nm| scale * glass.index(nm))
                }
                _ => {
                    let reflectance = data::reflectance(name).expect("the compiler checked the name");
                    Box::new(move |nm| scale * reflectance.at(nm))
                }
            },
            CurveKind::File { .. } => panic!("the compiler reads files into samples"),
            CurveKind::Image(_) => panic!("the compiler reads images into textures"),
            CurveKind::Texture(_) | CurveKind::Checker { .. } => panic!("no single value stands for a surface"),
            CurveKind::Illuminant(_) | CurveKind::Blackbody(_) | CurveKind::Lines(_) => {
                panic!("lights are read by Emission")
            }
        }
    }

    /// Whether the curve is made of wavelengths, so that three numbers cannot hold it.
    pub fn is_measured(&self) -> bool {
        match &self.kind {
            CurveKind::Texture(_) => false,
            CurveKind::Checker { cells, .. } => cells.iter().any(Self::is_measured),
            kind => kind.rgb().is_none(),
        }
    }

    /// Who published the curve, if it is one of the catalog.
    pub fn source(&self) -> Option<&'static str> {
        let CurveKind::Name(name) = &self.kind else { return None };
        data::glass(name).map(|glass| glass.source).or_else(|| data::metal(name).map(|metal| metal.source))
    }

    /// Whether the curve can be this quantity.
    ///
    /// # Errors
    /// What is wrong, where in the curve, and what to do.
    pub fn check(&self, quantity: Quantity) -> Result<(), Refusal> {
        super::curve_check::check(self, quantity)
    }
}

/// Linear between samples, flat beyond the ends.
pub(super) fn interpolate(samples: &[[f64; 2]], x: f64) -> f64 {
    data::interpolate(samples, x)[1]
}

/// The squared index of a Sellmeier curve at a wavelength in um.
pub(super) fn sellmeier_squared(b: &[f64], c: &[f64], um: f64) -> f64 {
    let w2 = um * um;
    1.0 + b.iter().zip(c).map(|(b, c)| b * w2 / (w2 - c)).sum::<f64>()
}

/// Cauchy's A and B (um^2) from n_d and V_d, with the lines C 656.27, d 587.56 and F 486.13 nm.
pub(super) fn cauchy_through(nd: f64, vd: f64) -> [f64; 2] {
    let inverse_square = |nm: f64| 1.0 / (nm * 1e-3 * nm * 1e-3);
    let b = (nd - 1.0) / (vd * (inverse_square(486.13) - inverse_square(656.27)));
    [nd - b * inverse_square(587.56), b]
}
