//! Spectra as authors write them.

use std::fmt;

use serde::Deserialize;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserializer, Error as _, MapAccess, Visitor};

use super::Quantity;
use super::basis::BAND_WAVELENGTHS_NM;
use super::curve_check::Refusal;
use super::data;

/// A spectrum as it stands in a scene file: a number, a catalog name, or a table with one kind and maybe a `scale`.
///
/// ```toml
/// reflectance = 0.5
/// reflectance = { rgb = [0.7, 0.5, 0.3] }
/// index = "N-SF11"
/// index = { rgb = [1.513, 1.517, 1.523] }
/// index = { samples = [[486.1, 1.522], [656.3, 1.514]] }
/// index = { cauchy = [1.5046, 0.0042] }
/// index = { sellmeier = { b = [1.0396, 0.2318, 1.0105], c = [0.0060, 0.0200, 103.56] } }
/// index = { abbe = { nd = 1.5168, vd = 64.17 } }
/// radiance = { rgb = [1, 0.9, 0.8], scale = 10 }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The spectrum before scaling.
    pub kind: CurveKind,
    /// A factor on every value.
    pub scale: f64,
}

/// The ways to write a spectrum.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveKind {
    /// The same at every wavelength; as an emission, that many times the film's white.
    Number(f64),
    /// Linear Rec.709; as an index, its values at 656.27, 546.07 and 486.13 nm.
    Rgb([f64; 3]),
    /// (wavelength in nm, value), ascending; linear between, flat beyond the ends.
    Samples(Vec<[f64; 2]>),
    /// A glass or metal of the catalog.
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
}

impl From<f64> for Curve {
    fn from(value: f64) -> Self {
        CurveKind::Number(value).into()
    }
}

impl From<CurveKind> for Curve {
    fn from(kind: CurveKind) -> Self {
        Self { kind, scale: 1.0 }
    }
}

impl Curve {
    /// The value at a wavelength. `rgb` is read at the three band wavelengths, linear between and flat outside.
    ///
    /// # Panics
    /// If the curve is a name that `check` would refuse.
    pub fn at(&self, quantity: Quantity, wavelength_nm: f64) -> f64 {
        let um = wavelength_nm * 1e-3;
        self.scale
            * match &self.kind {
                CurveKind::Number(value) => *value,
                CurveKind::Rgb([red, green, blue]) => {
                    let [r, g, b] = BAND_WAVELENGTHS_NM;
                    interpolate(&[[b, *blue], [g, *green], [r, *red]], wavelength_nm)
                }
                CurveKind::Samples(samples) => interpolate(samples, wavelength_nm),
                CurveKind::Cauchy([a, b]) => a + b / (um * um),
                CurveKind::Sellmeier { b, c } => sellmeier_squared(b, c, um).sqrt(),
                CurveKind::Abbe { nd, vd } => {
                    let [a, b] = cauchy_through(*nd, *vd);
                    a + b / (um * um)
                }
                CurveKind::Name(name) => match quantity {
                    Quantity::MetalIndex | Quantity::MetalExtinction => {
                        let metal = data::metal(name).expect("the compiler checked the metal's name");
                        metal.nk(wavelength_nm)[usize::from(quantity == Quantity::MetalExtinction)]
                    }
                    _ => data::glass(name).expect("the compiler checked the glass's name").index(wavelength_nm),
                },
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
fn interpolate(samples: &[[f64; 2]], x: f64) -> f64 {
    let after = samples.partition_point(|s| s[0] < x);
    if after == 0 {
        return samples[0][1];
    }
    let Some([x1, y1]) = samples.get(after) else {
        return samples[samples.len() - 1][1];
    };
    let [x0, y0] = samples[after - 1];
    y0 + (y1 - y0) * ((x - x0) / (x1 - x0))
}

/// The squared index of a Sellmeier curve at a wavelength in um.
pub(super) fn sellmeier_squared(b: &[f64], c: &[f64], um: f64) -> f64 {
    let w2 = um * um;
    1.0 + b.iter().zip(c).map(|(b, c)| b * w2 / (w2 - c)).sum::<f64>()
}

/// Cauchy's A and B (um^2) from n_d and V_d, with the lines C 656.27, d 587.56 and F 486.13 nm.
fn cauchy_through(nd: f64, vd: f64) -> [f64; 2] {
    let inverse_square = |nm: f64| 1.0 / (nm * 1e-3 * nm * 1e-3);
    let b = (nd - 1.0) / (vd * (inverse_square(486.13) - inverse_square(656.27)));
    [nd - b * inverse_square(587.56), b]
}

const EXPECTED: &str = "a number, a catalog name in quotes, or a table such as { rgb = [r, g, b] }";

impl<'de> Deserialize<'de> for Curve {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(CurveVisitor)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveTable {
    rgb: Option<[f64; 3]>,
    samples: Option<Vec<[f64; 2]>>,
    cauchy: Option<[f64; 2]>,
    sellmeier: Option<Sellmeier>,
    abbe: Option<Abbe>,
    scale: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sellmeier {
    b: Vec<f64>,
    c: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Abbe {
    nd: f64,
    vd: f64,
}

struct CurveVisitor;

impl<'de> Visitor<'de> for CurveVisitor {
    type Value = Curve;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(EXPECTED)
    }

    fn visit_f64<E>(self, value: f64) -> Result<Curve, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Curve, E> {
        Ok((value as f64).into())
    }

    fn visit_str<E>(self, name: &str) -> Result<Curve, E> {
        Ok(CurveKind::Name(name.to_owned()).into())
    }

    fn visit_map<M: MapAccess<'de>>(self, map: M) -> Result<Curve, M::Error> {
        let table = CurveTable::deserialize(MapAccessDeserializer::new(map))?;
        let mut kinds = [
            table.rgb.map(CurveKind::Rgb),
            table.samples.map(CurveKind::Samples),
            table.cauchy.map(CurveKind::Cauchy),
            table.sellmeier.map(|s| CurveKind::Sellmeier { b: s.b, c: s.c }),
            table.abbe.map(|a| CurveKind::Abbe { nd: a.nd, vd: a.vd }),
        ]
        .into_iter()
        .flatten();
        let Some(kind) = kinds.next() else {
            return Err(M::Error::custom("a spectrum needs one of `rgb`, `samples`, `cauchy`, `sellmeier`, `abbe`"));
        };
        if kinds.next().is_some() {
            return Err(M::Error::custom("a spectrum has exactly one kind"));
        }
        Ok(Curve { kind, scale: table.scale.unwrap_or(1.0) })
    }
}
