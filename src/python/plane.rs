//! Numbers that numpy reads in place.

use std::any::Any;
use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// A read-only array of numbers in memory that another object owns. Numpy reads it by its array interface, without a
/// copy.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Plane {
    /// The owner of the memory, kept alive as long as numpy uses it.
    _owner: Arc<dyn Any + Send + Sync>,
    address: usize,
    shape: Vec<usize>,
    /// In bytes.
    strides: Vec<usize>,
    kind: &'static str,
}

/// A type of numbers that numpy supports.
pub(super) trait Number: Copy + Send + Sync + 'static {
    /// The name of the type in the array interface.
    const KIND: &'static str;
}

impl Number for f32 {
    const KIND: &'static str = if cfg!(target_endian = "big") { ">f4" } else { "<f4" };
}

impl Number for f64 {
    const KIND: &'static str = if cfg!(target_endian = "big") { ">f8" } else { "<f8" };
}

impl Number for u32 {
    const KIND: &'static str = if cfg!(target_endian = "big") { ">u4" } else { "<u4" };
}

/// The place of 32-bit numbers in memory that something else owns.
pub(super) struct Place {
    /// The address of the first number.
    pub(super) address: usize,
    pub(super) shape: Vec<usize>,
    /// The strides in bytes.
    pub(super) strides: Vec<usize>,
}

impl Plane {
    /// Creates a plane of numbers in memory that `owner` keeps unchanged.
    pub(super) fn new(owner: Arc<dyn Any + Send + Sync>, place: Place) -> Self {
        let Place { address, shape, strides } = place;
        Self { _owner: owner, address, shape, strides, kind: f32::KIND }
    }

    /// Creates a plane that owns its contiguous numbers.
    pub(super) fn owned<N: Number>(numbers: Vec<N>, shape: Vec<usize>) -> Self {
        let numbers = Arc::new(numbers);
        let step = |axis: usize| shape[axis + 1..].iter().product::<usize>();
        let strides = (0..shape.len()).map(|axis| step(axis) * size_of::<N>()).collect();
        let address = numbers.as_ptr().expose_provenance();
        Self { _owner: numbers, address, shape, strides, kind: N::KIND }
    }
}

#[pymethods]
impl Plane {
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("typestr", self.kind)?;
        interface.set_item("data", (self.address, true))?;
        interface.set_item("shape", PyTuple::new(py, &self.shape)?)?;
        interface.set_item("strides", PyTuple::new(py, &self.strides)?)?;
        Ok(interface)
    }
}
