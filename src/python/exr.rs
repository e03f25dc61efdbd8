//! Images in files of any program, and how much they differ.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use abbe::film::{ExrFile, ExrLayer, Part};
use abbe::look::{Difference, Exposure, Noise, Picture, compare};
use abbe::{Error, Result};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::errors::{prepare_output, refuse, refuse_pickle, to_exception, to_file_exception};
use super::image::Image;
use super::options::stops;
use super::plane::Plane;
use super::work;

/// The name of a rendered image, which has no file.
const IMAGE: &str = "the image";

/// An OpenEXR file.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Exr {
    file: Arc<ExrFile>,
    path: PathBuf,
}

#[pymethods]
impl Exr {
    /// Reads a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = path.clone();
        let file = work::run(py, move || ExrFile::read(&read))?.map_err(|error| to_file_exception(&path, error))?;
        Ok(Self { file: Arc::new(file), path })
    }

    /// Converts a rendered image to the file that it would be written to.
    #[staticmethod]
    fn of(py: Python<'_>, image: &Image) -> PyResult<Self> {
        let (image, path) = (image.image.clone(), PathBuf::from(IMAGE));
        let file = move || -> Result<ExrFile> { ExrFile::of_bytes(&image.exr_bytes()?.0, Path::new(IMAGE)) };
        Ok(Self { file: Arc::new(work::run(py, file)?.map_err(to_exception)?), path })
    }

    /// The names of the layers.
    #[getter]
    fn layers(&self) -> Vec<String> {
        self.file.layers().into_iter().map(|layer| layer.name).collect()
    }

    /// The width and height of the first part in pixels.
    #[getter]
    fn size(&self) -> (usize, usize) {
        self.file.parts.first().map_or([0; 2], |part| part.bounds.size).into()
    }

    /// Column and row of the first pixel of the first part.
    #[getter]
    fn corner(&self) -> (i64, i64) {
        self.file.parts.first().map_or([0; 2], |part| part.bounds.corner).into()
    }

    /// The width and height of the format in pixels.
    #[getter]
    fn format(&self) -> (usize, usize) {
        self.file.display.size.into()
    }

    /// The attributes of all parts as pairs of names and values, in the order of the parts.
    #[getter]
    fn attributes(&self) -> Vec<(String, String)> {
        let numbers = |numbers: &[f32]| numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ");
        let part_attributes = |part: &Part| {
            let camera = part.camera.map(|matrix| ("worldToCamera".to_owned(), numbers(&matrix)));
            part.attributes.iter().cloned().chain(camera).collect::<Vec<_>>()
        };
        self.file.parts.iter().flat_map(part_attributes).collect()
    }

    /// Returns a layer, or a channel by its full name.
    fn plane(&self, name: &str) -> PyResult<Plane> {
        match self.file.layer(Some(name), &self.path.display().to_string()) {
            Ok(layer) => Ok(plane(&layer, self.is_matte(&layer.name))),
            Err(Error::Arguments { message, help }) => {
                Err(PyKeyError::new_err(help.map_or(message.clone(), |help| format!("{message}: {help}"))))
            }
            Err(error) => Err(to_exception(error)),
        }
    }

    /// Returns an 8-bit PNG, brightened by 2^`exposure`.
    fn png(&self, py: Python<'_>, exposure: f64) -> PyResult<Vec<u8>> {
        let (file, path, stops) = (self.file.clone(), self.path.clone(), stops(exposure)?);
        work::run(py, move || picture(&file, &path, stops)?.png())?.map_err(to_exception)
    }

    /// Writes an 8-bit PNG, brightened by 2^`exposure`.
    fn write_png(&self, py: Python<'_>, path: PathBuf, exposure: f64) -> PyResult<()> {
        prepare_output(&path, "png")?;
        let (file, source, stops) = (self.file.clone(), self.path.clone(), stops(exposure)?);
        work::run(py, move || picture(&file, &source, stops)?.write_png(&path))?.map_err(to_exception)
    }

    /// Raises `TypeError`, because an image cannot be pickled.
    fn __reduce__(&self) -> PyResult<()> {
        refuse_pickle("an image", "send its arrays, such as image.rgb, or the path of its file")
    }

    /// Returns the same object, because it is immutable.
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}

impl Exr {
    /// Returns whether a layer holds two ranks of a Cryptomatte, where alpha is a share like any other.
    fn is_matte(&self, name: &str) -> bool {
        let attributes = self.file.parts.iter().flat_map(|part| &part.attributes);
        let mut names = attributes.filter(|(key, _)| key.starts_with("cryptomatte/") && key.ends_with("/name"));
        names.any(|(_, matte)| name.strip_prefix(matte.as_str()).is_some_and(|rank| rank.parse::<u32>().is_ok()))
    }
}

/// Returns a picture of the image itself, or of the first layer if there is none.
fn picture(file: &ExrFile, path: &Path, stops: f64) -> Result<Picture> {
    let layer = file.layer(None, &path.display().to_string())?;
    Ok(Picture::of_layer(file, &layer, Exposure { stops, ..Exposure::default() }).0)
}

/// Returns the channels of a layer as interleaved 32-bit numbers, whether the file holds 16 or 32 bits.
fn plane(layer: &ExrLayer, whole: bool) -> Plane {
    let channels = if whole { layer.channels.clone() } else { layer.values() };
    let [width, height] = layer.part.bounds.size;
    let shape = if channels.len() > 1 { vec![height, width, channels.len()] } else { vec![height, width] };
    let numbers = || (0..width * height).flat_map(|pixel| channels.iter().map(move |channel| channel.at(pixel)));
    if channels.iter().all(|channel| channel.kind() == "uint") {
        Plane::owned(numbers().map(|number| number as u32).collect(), shape)
    } else {
        Plane::owned(numbers().map(|number| number as f32).collect(), shape)
    }
}

/// Compares two images, and returns the fields of `abbe.Difference`.
#[pyfunction]
pub(super) fn diff<'py>(
    py: Python<'py>,
    a: &Exr,
    b: &Exr,
    layer: Option<String>,
    tolerance: Option<f64>,
) -> PyResult<Bound<'py, PyDict>> {
    if tolerance.is_some_and(|most| !(most >= 0.0 && most.is_finite())) {
        return refuse("a tolerance is a finite number, 0 or more", "such as tolerance=1e-4");
    }
    let files = [a.file.clone(), b.file.clone()];
    let mut names = [a, b].map(|one| one.path.display().to_string());
    for (name, number) in names.iter_mut().zip(["first", "second"]) {
        if name == IMAGE {
            *name = format!("the {number} image");
        }
    }
    let compared = move || {
        let [a, b] = files.each_ref().map(|file| &**file);
        compare([a, b], layer.as_deref(), names.each_ref().map(String::as_str))
    };
    let found = work::run(py, compared)?.map_err(to_exception)?;
    fields(py, found, tolerance)
}

fn fields(py: Python<'_>, found: Difference, tolerance: Option<f64>) -> PyResult<Bound<'_, PyDict>> {
    let fields = PyDict::new(py);
    fields.set_item("agrees", found.agrees(tolerance))?;
    fields.set_item("is_equal", found.is_equal)?;
    fields.set_item("layers_apart", found.layers_apart)?;
    fields.set_item("is_part", found.is_part)?;
    fields.set_item("channels", found.channels)?;
    fields.set_item("relative_mse", found.relative_mse)?;
    fields.set_item("brightness", found.brightness)?;
    fields.set_item("mean_de2000", found.color.map(|color| color.mean))?;
    fields.set_item("worst_de2000", found.color.map(|color| color.worst))?;
    fields.set_item("worst_pixel", found.worst.as_ref().map(|worst| (worst.position[0], worst.position[1])))?;
    fields.set_item("left_out", found.left_out)?;
    fields.set_item("torn", found.torn)?;
    fields.set_item("worst_z", found.noise.as_ref().map(|noise| noise.worst))?;
    fields.set_item("z_threshold", found.noise.as_ref().map(|noise| noise.threshold))?;
    fields.set_item("z_of_means", found.noise.map(|Noise { means, .. }| means))?;
    let [width, height] = found.bounds.size;
    fields.set_item("absolute", Plane::owned(found.absolute, vec![height, width]).into_pyobject(py)?)?;
    Ok(fields)
}
