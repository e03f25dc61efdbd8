//! Scenes.

use std::path::PathBuf;
use std::sync::Arc;

use abbe::scene::{self, SETTINGS, Source};
use abbe::{Diagnostic, Error};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use super::errors::{for_python, refuse, refuse_pickle, to_exception, to_file_exception};
use super::{text, work};

/// Identifies mistakes in settings by their keys. Each line of the text `SETTINGS` is a setting.
fn with_setting_keys(error: Error, keys: &[String]) -> Error {
    let Error::Scene(mut mistakes) = error else { return error };
    let is_of_setting = |mistake: &&mut Diagnostic| mistake.file.as_os_str() == SETTINGS;
    for mistake in mistakes.iter_mut().filter(is_of_setting) {
        mistake.key = keys.get(mistake.line_and_column().0 - 1).cloned();
    }
    Error::Scene(mistakes)
}

/// A scene that was read and checked.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Scene(pub(super) Arc<scene::Scene>);

#[pymethods]
impl Scene {
    /// Reads a scene file or a dict, and checks it. Looks in `folder` for the files that a dict names.
    #[staticmethod]
    fn compile(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        folder: PathBuf,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let (mut given, mut keys) = (Vec::new(), Vec::<String>::new());
        for (key, value) in settings.into_iter().flatten() {
            let key: String = key.extract()?;
            if key.is_empty() || key.chars().any(|letter| letter == '=' || letter.is_control()) {
                return refuse(
                    format!("{key:?} is not the path of a key"),
                    "such as \"film.width\" or \"object.ball.material\"",
                );
            }
            given.push(format!("{key}={}", text::value(&key, &value)?));
            keys.push(key);
        }
        let to_exception = |error| to_exception(with_setting_keys(error, &keys));
        let scene = match source.cast::<PyMapping>() {
            Ok(table) => {
                let path = folder.join("scene.toml");
                let (text, rows) = text::scene(table, &path)?;
                let source = Source { text, path };
                work::run(py, move || source.compile_written(&given, rows))?.map_err(to_exception)
            }
            Err(_) => {
                let Ok(path) = source.extract::<PathBuf>() else {
                    let kind = source.get_type().name()?;
                    let message = format!("a scene is a dict, the path of a file or an abbe.Scene, not {kind}");
                    return Err(PyTypeError::new_err(message));
                };
                let read = path.clone();
                work::run(py, move || Source::read(&read)?.compile_with(&given))?
                    .map_err(|error| to_file_exception(&path, with_setting_keys(error, &keys)))
            }
        };
        Ok(Self(Arc::new(scene?)))
    }

    /// The number of objects.
    #[getter]
    fn objects(&self) -> usize {
        self.0.objects.len()
    }

    /// Warnings about the scene, in sentences.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.iter().map(|warning| for_python(warning)).collect()
    }

    /// The width and height of the format in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.0.film.width, self.0.film.height)
    }

    /// Raises `TypeError`, because a scene cannot be pickled.
    fn __reduce__(&self) -> PyResult<()> {
        refuse_pickle("a scene", "send the path or the dict that it is made from")
    }

    /// Returns the same object, because it is immutable.
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}
