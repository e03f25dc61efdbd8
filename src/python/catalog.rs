//! Glasses, metals, illuminants and reflectances by name.

use abbe::nearest;
use abbe::spectrum::data;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use super::plane::Plane;

/// A clear material.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Glass(data::Glass);

/// A metal.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Metal(data::Metal);

/// An illuminant or a reflectance.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Tabulated(data::Grid);

/// A value for each wavelength in nm, given as the bytes of an array of 64-bit floats.
fn each(bytes: &[u8], value: impl Fn(f64) -> f64) -> Plane {
    let values: Vec<f64> = bytes.as_chunks().0.iter().map(|nm| value(f64::from_ne_bytes(*nm))).collect();
    let shape = vec![values.len()];
    Plane::owned(values, shape)
}

#[pymethods]
impl Glass {
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        data::glass(name).map(Self).ok_or_else(|| unknown("glass", name))
    }

    #[getter]
    fn name(&self) -> &'static str {
        self.0.key
    }

    #[getter]
    fn source(&self) -> &'static str {
        self.0.source
    }

    #[getter]
    fn range_nm(&self) -> (f64, f64) {
        self.0.range_nm
    }

    #[getter]
    fn n_d(&self) -> f64 {
        self.0.n_d()
    }

    /// Not a number where it is not known.
    #[getter]
    fn v_d(&self) -> f64 {
        self.0.v_d().unwrap_or(f64::NAN)
    }

    fn index(&self, nm: &[u8]) -> Plane {
        each(nm, |nm| self.0.index(nm))
    }

    /// Not a number where it is not known.
    fn extinction(&self, nm: &[u8]) -> Plane {
        each(nm, |nm| self.0.extinction(nm).unwrap_or(f64::NAN))
    }
}

#[pymethods]
impl Metal {
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        data::metal(name).map(Self).ok_or_else(|| unknown("metal", name))
    }

    #[getter]
    fn name(&self) -> &'static str {
        self.0.name
    }

    #[getter]
    fn source(&self) -> &'static str {
        self.0.source
    }

    #[getter]
    fn range_nm(&self) -> (f64, f64) {
        let samples = &self.0.samples;
        (samples.first().map_or(0.0, |first| first[0]), samples.last().map_or(0.0, |last| last[0]))
    }

    fn n(&self, nm: &[u8]) -> Plane {
        each(nm, |nm| self.0.nk(nm)[0])
    }

    fn k(&self, nm: &[u8]) -> Plane {
        each(nm, |nm| self.0.nk(nm)[1])
    }
}

#[pymethods]
impl Tabulated {
    #[getter]
    fn name(&self) -> &'static str {
        self.0.name
    }

    #[getter]
    fn source(&self) -> &'static str {
        self.0.source
    }

    #[getter]
    fn range_nm(&self) -> (f64, f64) {
        self.0.range_nm().into()
    }

    fn at(&self, nm: &[u8]) -> Plane {
        each(nm, |nm| self.0.at(nm))
    }
}

/// The illuminant of a name.
#[pyfunction]
pub(super) fn illuminant(name: &str) -> PyResult<Tabulated> {
    data::illuminant(name).map(Tabulated).ok_or_else(|| unknown("illuminant", name))
}

/// The reflectance of a name.
#[pyfunction]
pub(super) fn reflectance(name: &str) -> PyResult<Tabulated> {
    data::reflectance(name).map(Tabulated).ok_or_else(|| unknown("reflectance", name))
}

/// The full names of all entries of a kind.
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

/// The name of an entry of the catalog; none of anything else.
pub(super) fn name_of(value: &Bound<'_, PyAny>) -> Option<&'static str> {
    let core = value.getattr("_core").ok()?;
    let glass = || core.cast::<Glass>().ok().map(|glass| glass.get().name());
    let metal = || core.cast::<Metal>().ok().map(|metal| metal.get().name());
    let tabulated = || core.cast::<Tabulated>().ok().map(|tabulated| tabulated.get().name());
    glass().or_else(metal).or_else(tabulated)
}

fn unknown(kind: &str, name: &str) -> PyErr {
    let full = names(kind);
    let bare = full.iter().map(|name| data::bare(name));
    let near = match kind {
        "glass" => nearest(name, data::known_as()),
        _ => nearest(name, bare.chain(full.iter().copied())),
    };
    let help = near.map_or(String::new(), |near| format!(": did you mean {near:?}?"));
    PyKeyError::new_err(format!("there is no {kind} named {name:?}{help}"))
}
