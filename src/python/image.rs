//! Rendered images.

use std::path::PathBuf;
use std::sync::Arc;

use abbe::film::{BEAUTY, Film, Layer, Pixel};
use abbe::nearest;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;

use super::errors::{output, raised};
use super::options::stops;
use super::plane::{Place, Plane};
use super::work;

/// A rendered image.
#[pyclass(frozen, module = "abbe._abbe")]
pub(super) struct Image {
    pub(super) image: Arc<abbe::Image>,
    /// All that is known of it, as JSON.
    pub(super) account: String,
}

/// The layers that every image has.
const ALWAYS: [&str; 3] = [BEAUTY, "A", "Z"];

#[pymethods]
impl Image {
    /// Columns and rows.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.image.width(), self.image.height())
    }

    /// Column and row of the first pixel, counted from the top left of the format.
    #[getter]
    fn corner(&self) -> (i32, i32) {
        self.image.film().corner.into()
    }

    /// The names of its layers.
    #[getter]
    fn layers(&self) -> Vec<String> {
        let names = ALWAYS.iter().map(|name| (*name).to_owned());
        names.chain(self.image.film().layers.iter().map(|layer| layer.name.clone())).collect()
    }

    #[getter]
    fn account(&self) -> &str {
        &self.account
    }

    /// A layer, or a channel by its name in the file.
    fn plane(&self, name: &str) -> PyResult<Plane> {
        let film = self.image.film();
        match of_pixels(film, name).or_else(|| of_layers(film, name)) {
            Some(Found::Pixels(place)) => Ok(Plane::of::<Pixel, f32>(self.image.clone(), place)),
            Some(Found::Numbers(place)) => Ok(Plane::of::<f32, f32>(self.image.clone(), place)),
            None => Err(self.missing(name)),
        }
    }

    /// The centers of the spectral bands in nm, and the radiance of all pixels in them.
    fn spectra(&self) -> Option<(Vec<f64>, Plane)> {
        let film = self.image.film();
        let spectral = film.spectral.as_ref()?;
        let bands = spectral.bands.count();
        let mut place = packed(film, &spectral.values, spectral.numbers(), 0..bands);
        // A single band is one still.
        if bands == 1 {
            place.shape.push(1);
            place.strides.push(size_of::<f32>());
        }
        Some((spectral.bands.centers_nm().collect(), Plane::of::<f32, f32>(self.image.clone(), place)))
    }

    /// Writes the linear image; answers how many values were too large for 16 bits.
    fn write_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<u64> {
        output(&path, "exr")?;
        let image = self.image.clone();
        work::run(py, move || image.write_exr(path))?.map_err(raised)
    }

    /// Writes the spectra.
    fn write_spectral_exr(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        output(&path, "exr")?;
        let image = self.image.clone();
        work::run(py, move || image.write_spectral_exr(path))?.map_err(raised)
    }

    /// The bytes of a picture.
    fn png(&self, py: Python<'_>, exposure: f64) -> PyResult<Vec<u8>> {
        let (image, stops) = (self.image.clone(), stops(exposure)?);
        work::run(py, move || image.png_bytes(stops))?.map_err(raised)
    }

    /// Writes a picture.
    fn write_png(&self, py: Python<'_>, path: PathBuf, exposure: f64) -> PyResult<()> {
        output(&path, "png")?;
        let (image, stops) = (self.image.clone(), stops(exposure)?);
        work::run(py, move || image.write_png(path, stops))?.map_err(raised)
    }
}

impl Image {
    /// What is said of a layer that is not there.
    fn missing(&self, name: &str) -> PyErr {
        let layers = self.layers();
        let layer = name.split_once('.').map_or(name, |(layer, _)| layer);
        let known = layers.iter().map(String::as_str).chain(Layer::NAMES.map(|(name, _)| name));
        // Ranks of a Cryptomatte have a number after its name.
        let rank = layers.iter().find(|rank| rank.starts_with(layer)).map(String::as_str);
        let help = match rank.or_else(|| nearest(layer, known)) {
            Some(near) if layers.iter().any(|layer| layer == near) => format!("did you mean {near:?}? "),
            Some(near) => format!("layers=[{near:?}] asks for it; "),
            None => String::new(),
        };
        PyKeyError::new_err(format!("the image has no layer {name:?}: {help}it has {}", layers.join(", ")))
    }
}

/// Where a layer lies: among the pixels, or by itself.
enum Found<'a> {
    Pixels(Place<'a, Pixel>),
    Numbers(Place<'a, f32>),
}

/// What each pixel has.
fn of_pixels<'f>(film: &'f Film, name: &str) -> Option<Found<'f>> {
    let first = film.pixels.first()?;
    let (number, deep) = match name {
        BEAUTY => (&first.rgb[0], true),
        "R" => (&first.rgb[0], false),
        "G" => (&first.rgb[1], false),
        "B" => (&first.rgb[2], false),
        "A" => (&first.alpha, false),
        "Z" => (&first.depth, false),
        _ => return None,
    };
    let start = std::ptr::from_ref(number).addr() - film.pixels.as_ptr().addr();
    let (mut shape, step) = (vec![film.height as usize, film.width as usize], size_of::<Pixel>());
    let mut strides = vec![film.width as usize * step, step];
    if deep {
        shape.push(first.rgb.len());
        strides.push(size_of::<f32>());
    }
    Some(Found::Pixels(Place { whole: &film.pixels, start, shape, strides }))
}

/// What was asked for beside that.
fn of_layers<'f>(film: &'f Film, name: &str) -> Option<Found<'f>> {
    let layer = |name: &str| film.layers.iter().find(|layer| layer.name == name);
    let (found, channels) = match layer(name) {
        Some(found) => (found, 0..found.layer.channels().len()),
        None => {
            let (name, channel) = name.rsplit_once('.')?;
            let found = layer(name)?;
            let number = found.layer.channels().iter().position(|known| *known == channel)?;
            (found, number..number + 1)
        }
    };
    Some(Found::Numbers(packed(film, &found.values, found.layer.channels().len(), channels)))
}

/// Some of the numbers of each pixel, of which each has so many.
fn packed<'f>(film: &Film, values: &'f [f32], each: usize, some: std::ops::Range<usize>) -> Place<'f, f32> {
    let size = size_of::<f32>();
    let (mut shape, mut strides) =
        (vec![film.height as usize, film.width as usize], vec![film.width as usize * each * size, each * size]);
    if some.len() > 1 {
        shape.push(some.len());
        strides.push(size);
    }
    Place { whole: values, start: some.start * size, shape, strides }
}
