//! The library as an extension module of Python, `abbe._abbe`.
//!
//! People import the package in `src/python/abbe`, which has the documentation, the types and the arrays, and calls
//! this module for the rest. Memory is passed to Python by its address, with the object that owns it. Nothing here is
//! unsafe.

#![deny(unsafe_code)]

mod catalog;
mod errors;
mod exr;
mod image;
mod options;
mod plane;
mod render;
mod scene;
mod text;
mod work;

use abbe::film::Layer;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

#[pymodule]
fn _abbe(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("LAYERS", PyTuple::new(module.py(), Layer::NAMES.map(|(name, _)| name))?)?;
    module.add_class::<catalog::Entry>()?;
    module.add_class::<catalog::Glass>()?;
    module.add_class::<catalog::Metal>()?;
    module.add_class::<catalog::Tabulated>()?;
    module.add_class::<exr::Exr>()?;
    module.add_class::<image::Image>()?;
    module.add_class::<plane::Plane>()?;
    module.add_class::<scene::Scene>()?;
    module.add_function(wrap_pyfunction!(catalog::names, module)?)?;
    module.add_function(wrap_pyfunction!(exr::diff, module)?)?;
    module.add_function(wrap_pyfunction!(render::plan, module)?)?;
    module.add_function(wrap_pyfunction!(render::render, module)?)?;
    Ok(())
}
