//! Rendered images.

use std::mem::offset_of;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

use abbe::film::{BEAUTY, Film, Layer, Pixel};
use abbe::nearest;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use super::errors::{prepare_output, refuse_pickle, to_exception};
use super::options::stops;
use super::plane::{Place, Plane};
use super::work;

/// A rendered image.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Image {
    pub(super) image: Arc<abbe::Image>,
    /// The report, the plan and the warnings of its render, as JSON.
    pub(super) account: String,
}

/// The layers that every image has.
const STANDARD_LAYERS: [&str; 3] = [BEAUTY, "A", "Z"];

#[pymethods]
impl Image {
    /// The width and height in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.image.width(), self.image.height())
    }

    /// Column and row of the first pixel, relative to the top left of the format.
    #[getter]
    fn corner(&self) -> (i32, i32) {
        self.image.film().corner.into()
    }

    /// The names of the layers.
    #[getter]
    fn layers(&self) -> Vec<String> {
        let names = STANDARD_LAYERS.iter().map(|name| (*name).to_owned());
        names.chain(self.image.film().layers.iter().map(|layer| layer.name.clone())).collect()
    }

    #[getter]
    fn account(&self) -> &str {
        &self.account
    }

    /// Returns a layer, or a channel by its name in the file.
    fn plane(&self, name: &str) -> PyResult<Plane> {
        let film = self.image.film();
        let place = standard_layer(film, name)
            .or_else(|| requested_layer(film, name))
            .ok_or_else(|| self.unknown_layer(name))?;
        Ok(Plane::new(self.image.clone(), place))
    }

    /// Returns the centers of the spectral bands in nm, and the radiance of all pixels in each band.
    fn spectra(&self) -> Option<(Vec<f64>, Plane)> {
        let film = self.image.film();
        let spectral = film.spectral.as_ref()?;
        let bands = spectral.bands.count();
        let mut place = packed(film, &spectral.values, spectral.numbers(), 0..bands);
        // A single band still gets an axis.
        if bands == 1 {
            place.shape.push(1);
            place.strides.push(size_of::<f32>());
        }
        Some((spectral.bands.centers_nm().collect(), Plane::new(self.image.clone(), place)))
    }

    /// Returns S1, S2 and S3 of all pixels in each spectral band.
    fn stokes_spectra(&self) -> Option<Plane> {
        let film = self.image.film();
        let spectral = film.spectral.as_ref().filter(|spectral| spectral.has_stokes)?;
        let (bands, numbers, size) = (spectral.bands.count(), spectral.numbers(), size_of::<f32>());
        let mut place = packed(film, &spectral.values, numbers, bands..numbers);
        place.shape.truncate(2);
        place.strides.truncate(2);
        place.shape.extend([spectral.components() - 1, bands]);
        place.strides.extend([bands * size, size]);
        Some(Plane::new(self.image.clone(), place))
    }

    /// Writes the linear image. Returns the number of values that were too large for 16 bits.
    fn write_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<u64> {
        prepare_output(&path, "exr")?;
        let image = self.image.clone();
        work::run(py, move || image.write_exr(path))?.map_err(to_exception)
    }

    /// Writes the spectra of all pixels.
    fn write_spectral_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        prepare_output(&path, "exr")?;
        let image = self.image.clone();
        work::run(py, move || image.write_spectral_exr(path))?.map_err(to_exception)
    }

    /// Returns an 8-bit PNG, brightened by 2^`exposure`.
    fn png(&self, py: Python<'_>, exposure: f64) -> PyResult<Vec<u8>> {
        let (image, stops) = (self.image.clone(), stops(exposure)?);
        work::run(py, move || image.png_bytes(stops))?.map_err(to_exception)
    }

    /// Writes an 8-bit PNG, brightened by 2^`exposure`.
    fn write_png(&self, py: Python<'_>, path: PathBuf, exposure: f64) -> PyResult<()> {
        prepare_output(&path, "png")?;
        let (image, stops) = (self.image.clone(), stops(exposure)?);
        work::run(py, move || image.write_png(path, stops))?.map_err(to_exception)
    }

    /// Raises `TypeError`, because an image cannot be pickled.
    fn __reduce__(&self) -> PyResult<()> {
        refuse_pickle("an image", "send its arrays, such as image.rgb, or write it to a file")
    }

    /// Returns the same object, because it is immutable.
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}

impl Image {
    /// Returns the exception for a layer that does not exist.
    fn unknown_layer(&self, name: &str) -> PyErr {
        let layers = self.layers();
        let layer = name.split_once('.').map_or(name, |(layer, _)| layer);
        let candidates = layers.iter().map(String::as_str).chain(Layer::NAMES.map(|(name, _)| name));
        // Ranks of a Cryptomatte have a number after its name.
        let rank = layers.iter().find(|rank| rank.starts_with(layer)).map(String::as_str);
        let help = match rank.or_else(|| nearest(layer, candidates)) {
            Some(near) if layers.iter().any(|layer| layer == near) => format!("did you mean {near:?}? "),
            Some(near) => format!("ask for it with layers=[{near:?}]; "),
            None => String::new(),
        };
        PyKeyError::new_err(format!("the image has no layer {name:?}: {help}it has {}", layers.join(", ")))
    }
}

/// Finds a layer or channel that every image has.
fn standard_layer(film: &Film, name: &str) -> Option<Place> {
    let rgb = offset_of!(Pixel, rgb);
    let (start, channels) = match name {
        BEAUTY => (rgb, 3),
        "R" => (rgb, 1),
        "G" => (rgb + size_of::<f32>(), 1),
        "B" => (rgb + 2 * size_of::<f32>(), 1),
        "A" => (offset_of!(Pixel, alpha), 1),
        "Z" => (offset_of!(Pixel, depth), 1),
        _ => return None,
    };
    Some(strided(film, &film.pixels, size_of::<Pixel>(), start, channels))
}

/// Finds a requested layer, or one of its channels.
fn requested_layer(film: &Film, name: &str) -> Option<Place> {
    let layer = |name: &str| film.layers.iter().find(|layer| layer.name == name);
    let (found, channels) = match layer(name) {
        Some(found) => (found, 0..found.layer.channels().len()),
        None => {
            let (name, channel) = name.rsplit_once('.')?;
            let found = layer(name)?;
            let number = found.layer.channels().iter().position(|candidates| *candidates == channel)?;
            (found, number..number + 1)
        }
    };
    Some(packed(film, &found.values, found.layer.channels().len(), channels))
}

/// Returns the place of the numbers `range` of each pixel, which has `per_pixel` of them.
fn packed(film: &Film, values: &[f32], per_pixel: usize, range: Range<usize>) -> Place {
    let size = size_of::<f32>();
    strided(film, values, per_pixel * size, range.start * size, range.len())
}

/// Returns the place of `channels` consecutive numbers of each pixel, which begin at `start` of the `step` bytes of the
/// pixel.
fn strided<T>(film: &Film, whole: &[T], step: usize, start: usize, channels: usize) -> Place {
    let (mut shape, mut strides) =
        (vec![film.height as usize, film.width as usize], vec![film.width as usize * step, step]);
    if channels > 1 {
        shape.push(channels);
        strides.push(size_of::<f32>());
    }
    Place { address: whole.as_ptr().expose_provenance() + start, shape, strides }
}
