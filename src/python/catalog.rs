//! Glasses, metals, illuminants and reflectances by name.

use abbe::nearest;
use abbe::spectrum::data;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use super::plane::Plane;

/// The name, the source and the wavelength range of an entry of the catalog.
#[derive(Clone)]
#[pyclass(frozen, get_all, module = "abbe._abbe")]
pub(super) struct Entry {
    name: &'static str,
    source: &'static str,
    range_nm: (f64, f64),
}

/// A clear material.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Glass {
    #[pyo3(get)]
    entry: Entry,
    glass: data::Glass,
}

/// A metal.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Metal {
    #[pyo3(get)]
    entry: Entry,
    metal: data::Metal,
}

/// An illuminant or a reflectance.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Tabulated {
    #[pyo3(get)]
    entry: Entry,
    grid: data::Grid,
}

/// Returns a value for each wavelength in nm, given as the bytes of an array of 64-bit floats.
fn map_wavelengths(bytes: &[u8], value: impl Fn(f64) -> f64) -> Plane {
    let values: Vec<f64> = bytes.as_chunks().0.iter().map(|nm| value(f64::from_ne_bytes(*nm))).collect();
    let shape = vec![values.len()];
    Plane::owned(values, shape)
}

#[pymethods]
impl Glass {
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        let glass = data::glass(name).ok_or_else(|| unknown_name("glass", name))?;
        let entry = Entry { name: glass.key, source: glass.source, range_nm: glass.range_nm };
        Ok(Self { entry, glass })
    }

    #[getter]
    fn n_d(&self) -> f64 {
        self.glass.n_d()
    }

    /// The Abbe number. NaN if the index is not known at its lines.
    #[getter]
    fn v_d(&self) -> f64 {
        self.glass.v_d().unwrap_or(f64::NAN)
    }

    fn index(&self, nm: &[u8]) -> Plane {
        map_wavelengths(nm, |nm| self.glass.index(nm))
    }

    /// Returns the extinction coefficient at each wavelength. NaN if it is not known.
    fn extinction(&self, nm: &[u8]) -> Plane {
        map_wavelengths(nm, |nm| self.glass.extinction(nm).unwrap_or(f64::NAN))
    }
}

#[pymethods]
impl Metal {
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        let metal = data::metal(name).ok_or_else(|| unknown_name("metal", name))?;
        let [first, last] = [metal.samples.first(), metal.samples.last()].map(|end| end.map_or(0.0, |end| end[0]));
        let entry = Entry { name: metal.name, source: metal.source, range_nm: (first, last) };
        Ok(Self { entry, metal })
    }

    fn n(&self, nm: &[u8]) -> Plane {
        map_wavelengths(nm, |nm| self.metal.nk(nm)[0])
    }

    fn k(&self, nm: &[u8]) -> Plane {
        map_wavelengths(nm, |nm| self.metal.nk(nm)[1])
    }
}

#[pymethods]
impl Tabulated {
    /// Finds an illuminant or a reflectance by its name.
    #[new]
    fn new(kind: &str, name: &str) -> PyResult<Self> {
        let grid = match kind {
            "illuminant" => data::illuminant(name),
            _ => data::reflectance(name),
        };
        let grid = grid.ok_or_else(|| unknown_name(kind, name))?;
        let entry = Entry { name: grid.name, source: grid.source, range_nm: grid.range_nm().into() };
        Ok(Self { entry, grid })
    }

    fn at(&self, nm: &[u8]) -> Plane {
        map_wavelengths(nm, |nm| self.grid.at(nm))
    }
}

/// Returns the full names of all entries of a kind.
#[pyfunction]
pub(super) fn names(kind: &str) -> Vec<&'static str> {
    match kind {
        "glass" => data::glass_names().collect(),
        "metal" => data::metal_names().collect(),
        "illuminant" => data::illuminants().map(|light| light.name).collect(),
        "reflectance" => data::reflectances().map(|patch| patch.name).collect(),
        _ => Vec::new(),
    }
}

/// Returns the name of an entry of the catalog, or none for anything else.
pub(super) fn name_of(value: &Bound<'_, PyAny>) -> Option<&'static str> {
    let entry = value.getattr("_core").ok()?.getattr("entry").ok()?;
    entry.cast::<Entry>().ok().map(|entry| entry.get().name)
}

fn unknown_name(kind: &str, name: &str) -> PyErr {
    let full = names(kind);
    let bare = full.iter().map(|name| data::bare(name));
    let near = match kind {
        "glass" => nearest(name, data::known_as()),
        _ => nearest(name, bare.chain(full.iter().copied())),
    };
    let help = near.map_or(String::new(), |near| format!(": did you mean {near:?}?"));
    PyKeyError::new_err(format!("there is no {kind} named {name:?}{help}"))
}
