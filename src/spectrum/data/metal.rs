//! Metals, alloys and semiconductors, which are opaque.

use std::sync::LazyLock;

use super::rows::{Row, Rows, fields, has_alias, key_of, names, samples};
use crate::math::interpolate;

static ROWS: LazyLock<Rows> = LazyLock::new(|| Rows::new(include_str!("metals.txt")));

/// A metal: its index n + ik at the measured wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Metal {
    /// Its name in a scene.
    pub name: &'static str,
    /// Other names of the same data.
    pub aliases: Vec<&'static str>,
    /// Who published the measurement.
    pub source: &'static str,
    /// (wavelength in nm, n, k), ascending.
    pub samples: Vec<[f64; 3]>,
}

impl Metal {
    fn read(row: Row) -> Self {
        let mut rest = fields(row);
        let mut field = || rest.next().unwrap_or_default();
        Self { name: field(), aliases: names(field()).collect(), samples: samples(field()), source: field() }
    }

    /// Returns n and k at a wavelength in nm; linear between samples, constant beyond the ends.
    pub fn nk(&self, nm: f64) -> [f64; 2] {
        let [_, n, k] = interpolate(&self.samples, nm);
        [n, k]
    }
}

/// Returns the metal of that name or alias, ignoring case.
pub fn metal(name: &str) -> Option<Metal> {
    ROWS.find(name).or_else(|| ROWS.all().find(|row| has_alias(row, name))).map(Metal::read)
}

/// Returns every metal, in the order of the names.
pub fn metals() -> impl Iterator<Item = Metal> {
    ROWS.all().map(Metal::read)
}

/// Returns the names of all metals.
pub fn metal_names() -> impl Iterator<Item = &'static str> {
    ROWS.all().map(key_of)
}
