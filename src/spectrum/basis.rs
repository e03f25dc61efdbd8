use super::{Curve, Response};

/// What a curve describes, which decides how it is read onto the lanes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Share of light that leaves a surface again, 0 to 1.
    Reflectance,
    /// Share of light that crosses a surface, 0 to 1.
    Transmittance,
    /// Radiance, or for a point light intensity; not negative.
    Emission,
    /// Real refractive index of a dielectric; above 1.
    Index,
    /// Absorption coefficient per scene unit, base e; not negative.
    Absorption,
    /// Real part of a metal's refractive index; above 0.
    MetalIndex,
    /// Extinction coefficient of a metal: imaginary part of its index; not negative.
    MetalExtinction,
}

/// A spectrum on the bins of one render's basis: one number per bin, in the unit of its quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Table(Box<[f64]>);

impl Table {
    /// A table of the given bins.
    pub fn new(bins: impl Into<Box<[f64]>>) -> Self {
        Self(bins.into())
    }

    /// The number in each bin.
    pub fn bins(&self) -> &[f64] {
        &self.0
    }

    /// Smallest and largest bin.
    pub fn range(&self) -> (f64, f64) {
        self.0.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
    }

    /// Whether all bins hold the same number: a surface with this index keeps lanes together.
    pub fn is_flat(&self) -> bool {
        self.0.windows(2).all(|pair| pair[0] == pair[1])
    }
}

/// What the lanes of one render stand for: the bins on which all its spectra are tabulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    name: &'static str,
    wavelengths_nm: [f64; 3],
}

/// Where the bands of the `rgb` basis read an index, in nm: the hydrogen C, mercury e and hydrogen F lines.
pub const BAND_WAVELENGTHS_NM: [f64; 3] = [656.27, 546.07, 486.13];

impl Basis {
    /// Three bands: the film's red, green and blue, linear Rec.709.
    pub fn rgb() -> Self {
        Self { name: "rgb", wavelengths_nm: BAND_WAVELENGTHS_NM }
    }

    /// The model's name in a scene file.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// How many bins every table has.
    pub fn len(&self) -> usize {
        self.wavelengths_nm.len()
    }

    /// Never: a basis has at least one bin.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Where an index, an absorption or a metal is read, in nm, one per bin.
    pub fn wavelengths_nm(&self) -> &[f64] {
        &self.wavelengths_nm
    }

    /// A checked curve, read onto the bins.
    pub fn tabulate(&self, quantity: Quantity, curve: &Curve) -> Table {
        Table(self.wavelengths_nm.iter().map(|&nm| curve.at(quantity, nm)).collect())
    }

    /// What the bins are worth to the sensor when a path ends in a light of this emission.
    pub fn response(&self, _emission: &Curve) -> Response {
        Response::identity()
    }
}
