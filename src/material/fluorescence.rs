use crate::spectrum::{Curve, Dye, Quantity};

/// A dye in a matte surface. It absorbs light and emits part of it at other wavelengths, equally in all directions and
/// unpolarized.
///
/// ```toml
/// [material.highlighter.diffuse]
/// reflectance = 0.1
/// fluorescence.absorption = { samples = [[400, 0.2], [450, 0.9], [500, 0]] }
/// fluorescence.emission = { samples = [[490, 0], [520, 1], [580, 0]] }
/// fluorescence.quantum_yield = 0.9
/// ```
#[derive(Clone, Debug)]
pub struct Fluorescence<S> {
    /// Share of the light that it absorbs, 0 to 1; at most what the surface's reflectance leaves.
    pub absorption: S,
    /// Emission spectrum, in power per nm on any scale.
    pub emission: S,
    /// Mean number of photons emitted per absorbed photon, 0 to 1.
    pub quantum_yield: f64,
}

impl<S> Fluorescence<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Fluorescence<T> {
        Fluorescence {
            absorption: convert(Quantity::Excitation, &self.absorption),
            emission: convert(Quantity::Fluorescence, &self.emission),
            quantum_yield: self.quantum_yield,
        }
    }
}

impl Fluorescence<Curve> {
    /// Returns the dye's spectra and its quantum yield.
    pub fn dye(&self) -> Dye {
        let Self { absorption, emission, quantum_yield } = self.clone();
        Dye { absorption, emission, quantum_yield }
    }
}
