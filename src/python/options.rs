//! Options of a render besides its scene.

use std::time::Duration;

use abbe::Options;
use abbe::film::{Layer, Overscan, Window};
use abbe::scene::duration;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyString};

use super::errors::refuse;
use super::text::short_repr;

/// Converts the arguments of a render to the options of the library. None leaves an option to the scene.
///
/// # Errors
/// If an argument has a value that is not allowed.
pub(super) fn options(given: &Bound<'_, PyDict>) -> PyResult<Options> {
    let threads: Option<usize> = number(given, "threads", "a whole number of 1 or more")?;
    let max = Options::MAX_THREADS;
    if threads.is_some_and(|threads| !(1..=usize::from(max)).contains(&threads)) {
        return refuse(format!("a render has 1 to {max} threads"), "leave threads out to use all processors");
    }
    Ok(Options {
        samples: number(given, "samples", "a whole number from 1 to 2**32 - 1")?,
        error: number(given, "error", "a number")?,
        time: optional(given, "time", |value| time("time", value))?,
        seed: number(given, "seed", "a whole number from 0 to 2**64 - 1")?,
        overscan: optional(given, "overscan", overscan)?,
        crop: optional(given, "crop", crop)?,
        layers: optional(given, "layers", layers)?,
        spectral: get(given, "spectral", "True or False")?.unwrap_or_default(),
        threads,
        stamp: get(given, "stamp", "True or False")?.unwrap_or_default(),
        ..Options::default()
    })
}

/// Reads an argument with `read`. Returns none if the argument is None or missing.
fn optional<'py, T>(
    given: &Bound<'py, PyDict>,
    name: &str,
    read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
) -> PyResult<Option<T>> {
    given.get_item(name)?.filter(|value| !value.is_none()).as_ref().map(read).transpose()
}

/// Converts an argument. `wanted` describes the values that are allowed.
fn get<'py, T: FromPyObjectOwned<'py>>(given: &Bound<'py, PyDict>, name: &str, wanted: &str) -> PyResult<Option<T>> {
    optional(given, name, |value| value.extract().or_else(|_| refuse_value(name, wanted, value)))
}

/// Converts an argument to a number. Refuses True and False, which Python counts as numbers.
fn number<'py, T: FromPyObjectOwned<'py>>(given: &Bound<'py, PyDict>, name: &str, wanted: &str) -> PyResult<Option<T>> {
    match given.get_item(name)?.filter(is_bool) {
        Some(truth) => refuse_value(name, wanted, &truth),
        None => get(given, name, wanted),
    }
}

/// Returns whether a value is True or False, of Python or numpy.
fn is_bool(value: &Bound<'_, PyAny>) -> bool {
    value.is_instance_of::<PyBool>() || value.get_type().name().is_ok_and(|name| name == "bool_" || name == "bool")
}

fn refuse_value<T>(name: &str, wanted: &str, value: &Bound<'_, PyAny>) -> PyResult<T> {
    refuse(format!("{name} is {wanted}, not {}", short_repr(value)), "help(abbe.render) lists all arguments")
}

/// Checks an exposure in stops.
///
/// # Errors
/// If the exposure is not finite.
pub(super) fn stops(exposure: f64) -> PyResult<f64> {
    match exposure.is_finite() {
        true => Ok(exposure),
        false => refuse("an exposure is a finite number of stops", "such as exposure=1"),
    }
}

/// Converts the argument `name`, which is a number of seconds or a text such as `"10m"`.
///
/// # Errors
/// If it is neither, or not above 0.
pub(super) fn time(name: &str, value: &Bound<'_, PyAny>) -> PyResult<Duration> {
    let found = match value.cast::<PyString>() {
        Ok(text) => duration(&text.to_cow()?),
        Err(_) if is_bool(value) => None,
        Err(_) => value
            .extract()
            .ok()
            .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
            .filter(|time| !time.is_zero()),
    };
    match found {
        Some(time) => Ok(time),
        None => refuse(
            format!("{name} is a number of seconds above 0 or a string such as \"10m\", not {}", short_repr(value)),
            "units are ms, s, m and h",
        ),
    }
}

fn overscan(value: &Bound<'_, PyAny>) -> PyResult<Overscan> {
    if let (Ok(pixels), false) = (value.extract::<u32>(), is_bool(value)) {
        return Ok(Overscan::even(pixels));
    }
    match four_numbers::<u32>(value) {
        Some([left, top, right, bottom]) => Ok(Overscan { left, top, right, bottom }),
        None => refuse("overscan is one or four whole numbers of pixels", "such as 16 or (16, 8, 16, 8)"),
    }
}

/// Converts a value to four whole numbers. True and False do not count as numbers.
fn four_numbers<'py, T: FromPyObjectOwned<'py>>(value: &Bound<'py, PyAny>) -> Option<[T; 4]> {
    let numbers = value.extract().ok()?;
    let has_bool = value.try_iter().ok()?.flatten().any(|number| is_bool(&number));
    (!has_bool).then_some(numbers)
}

fn crop(value: &Bound<'_, PyAny>) -> PyResult<Window> {
    let Some([left, top, width, height]) = four_numbers::<i64>(value) else {
        return refuse_value("crop", "four whole numbers: first column, first row, width and height", value);
    };
    let read = || {
        let ([left, top], [width, height]) = ([left, top].map(i32::try_from), [width, height].map(u32::try_from));
        Some(Window { left: left.ok()?, top: top.ok()?, width: width.ok()?, height: height.ok()? })
    };
    match read() {
        Some(crop) => Ok(crop),
        None => refuse("a crop is first column, first row, width and height", "such as (100, 50, 320, 180)"),
    }
}

/// Converts a list of names, or the word for all layers.
fn layers(value: &Bound<'_, PyAny>) -> PyResult<Vec<Layer>> {
    if let Ok(word) = value.cast::<PyString>() {
        let word = word.to_cow()?;
        return match word == Layer::ALL {
            true => Ok(Layer::all()),
            false => {
                let names = word.split(',').map(str::trim).filter(|name| !name.is_empty());
                let names: Vec<String> = names.map(|name| format!("{name:?}")).collect();
                let help = format!("write layers=[{}], or \"{}\"", names.join(", "), Layer::ALL);
                refuse("layers is a list of names", &help)
            }
        };
    }
    match value.extract::<Vec<String>>() {
        Ok(names) => {
            Layer::of_names(names.iter().map(String::as_str)).or_else(|said| refuse(said, "abbe.LAYERS lists them all"))
        }
        Err(_) => {
            refuse(format!("layers is a list of names, not {}", short_repr(value)), "such as [\"albedo\", \"N\"]")
        }
    }
}
