//! Converts the dicts, lists, numbers and texts of a program to the text of a scene, with the same keys and values in
//! the same order.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use abbe::scene::{Numbers, Rows};
use abbe::{Diagnostic, Error};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};

use super::catalog;
use super::errors::to_exception;

/// The maximum depth of nested dicts and lists: more than a scene has, and less than TOML may have.
const MAX_DEPTH: usize = 64;

/// Returns the text of a scene, and the arrays of its meshes beside it.
///
/// # Errors
/// If it contains values that have no place in a scene. All of them are reported with their keys.
pub(super) fn scene(table: &Bound<'_, PyMapping>, file: &Path) -> PyResult<(String, Vec<Rows>)> {
    let mut writer = Writer::default();
    for entry in table.items()? {
        writer.entry(&entry)?;
        writer.text.push('\n');
    }
    writer.finish(file)
}

/// The long lists of a mesh: one of point numbers, and those of coordinates.
const FACES: &str = "faces";
const COORDINATE_LISTS: [&str; 3] = ["points", "normals", "uv"];

/// Returns the text of a single value, as it is written after `KEY=`.
///
/// # Errors
/// If it is not a value that a scene may have. `key` tells where it is.
pub(super) fn value(key: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let mut writer = Writer { path: vec![Step::Key(key.to_owned())], is_alone: true, ..Writer::default() };
    writer.value(value)?;
    writer.finish(Path::new("set")).map(|(text, _)| text)
}

/// A step on the path to a value.
enum Step {
    Key(String),
    Entry(usize),
}

#[derive(Default)]
struct Writer {
    text: String,
    /// The arrays that the text refers to by marks.
    rows: Vec<Rows>,
    /// Whether the text is a single value, which has no arrays beside it.
    is_alone: bool,
    path: Vec<Step>,
    mistakes: Vec<Diagnostic>,
}

impl Writer {
    fn finish(self, file: &Path) -> PyResult<(String, Vec<Rows>)> {
        if self.mistakes.is_empty() {
            return Ok((self.text, self.rows));
        }
        let file = |mistake| Diagnostic { file: file.to_owned(), ..mistake };
        Err(to_exception(Error::Scene(self.mistakes.into_iter().map(file).collect())))
    }

    /// Records a mistake. Writing continues, so that all mistakes are reported together.
    fn refuse<'h>(&mut self, message: impl Into<String>, help: impl Into<Option<&'h str>>) -> PyResult<()> {
        let mut path = String::new();
        for step in &self.path {
            let _ = match step {
                Step::Key(key) if path.is_empty() => write!(path, "{key}"),
                Step::Key(key) => write!(path, ".{key}"),
                Step::Entry(number) => write!(path, "[{number}]"),
            };
        }
        let help = help.into().map(str::to_owned);
        let (file, text) = (PathBuf::new(), "".into());
        self.mistakes.push(Diagnostic { file, text, span: 0..0, key: Some(path), message: message.into(), help });
        Ok(())
    }

    /// Writes a key and its value.
    fn entry(&mut self, entry: &Bound<'_, PyAny>) -> PyResult<()> {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = entry.extract()?;
        let name = key.cast::<PyString>().ok().and_then(|key| key.extract::<String>().ok());
        let Some(name) = name else {
            return self
                .refuse(format!("a key is a string, not {}", short_repr(&key)), "use the names of a scene file");
        };
        self.quoted(&name);
        self.text.push_str(" = ");
        self.path.push(Step::Key(name));
        self.value(&value)?;
        self.path.pop();
        Ok(())
    }

    fn value(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        if self.path.len() > MAX_DEPTH {
            return self
                .refuse(format!("dicts and lists are nested more than {MAX_DEPTH} deep"), "does one contain itself?");
        }
        if let Ok(truth) = value.cast::<PyBool>() {
            self.text.push_str(if truth.is_true() { "true" } else { "false" });
        } else if let Ok(text) = value.cast::<PyString>() {
            match text.extract::<String>() {
                Ok(text) => self.quoted(&text),
                Err(_) => return self.refuse("this string is not valid Unicode", "decode it differently"),
            }
        } else if value.is_instance_of::<PyInt>() {
            return match value.extract::<i128>() {
                Ok(whole) => {
                    self.text.push_str(&whole.to_string());
                    Ok(())
                }
                Err(_) => self.refuse("this number is too large", None),
            };
        } else if let Ok(number) = value.cast::<PyFloat>() {
            self.text.push_str(&abbe::toml::Value::Float(number.value()).to_string());
        } else if let Ok(table) = value.cast::<PyDict>() {
            return self.table(table.as_mapping());
        } else if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
            return self.list(value);
        } else {
            return self.convertible(value);
        }
        Ok(())
    }

    /// Writes a value that is converted first: an array or number of numpy, a path, a time, an entry of the catalog, or
    /// a number or dict of another type.
    fn convertible(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let has_method = |method: &str| value.hasattr(method).unwrap_or(false);
        if has_method("tolist") {
            if is_masked(value) {
                let help = "fill them, as by array.filled(0), or leave them out";
                return self.refuse("a scene cannot hold masked values", help);
            }
            let list = self.list_of_mesh();
            if let Some(rows) = list.map(|list| rows(value, list == FACES)).transpose()?.flatten() {
                self.quoted(&Rows::mark(self.rows.len()));
                self.rows.push(rows);
                return Ok(());
            }
            let plain = value.call_method0("tolist")?;
            return self.converted(&plain);
        }
        if has_method("__fspath__") {
            return self.converted(&value.call_method0("__fspath__")?);
        }
        if has_method("isoformat") {
            let text: String = value.call_method0("isoformat")?.extract()?;
            self.text.push_str(&text);
            return Ok(());
        }
        if let Ok(table) = value.cast::<PyMapping>() {
            return self.table(table);
        }
        if let Some(name) = catalog::name_of(value) {
            self.quoted(name);
            return Ok(());
        }
        if has_method("__index__") {
            return self.converted(&value.call_method0("__index__")?);
        }
        match value.extract::<f64>() {
            Ok(number) => self.value(&PyFloat::new(value.py(), number)),
            Err(_) => self.refuse_type(value),
        }
    }

    /// Returns the name of the list that is being written, if it is a long list of a mesh in the scene itself.
    fn list_of_mesh(&self) -> Option<&str> {
        match self.path.as_slice() {
            _ if self.is_alone => None,
            [Step::Key(first), .., Step::Key(mesh), Step::Key(list)] if first == "object" && mesh == "mesh" => {
                Some(list.as_str()).filter(|list| *list == FACES || COORDINATE_LISTS.contains(list))
            }
            _ => None,
        }
    }

    /// Writes a value that another one was converted to. It is converted again only if it is a number, so that this
    /// ends.
    fn converted(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let is_plain = value.is_instance_of::<PyInt>()
            || value.is_instance_of::<PyFloat>()
            || value.is_instance_of::<PyString>()
            || value.is_instance_of::<PyList>();
        match value.extract::<f64>() {
            _ if is_plain => self.value(value),
            // A number with more digits than a float of Python, such as a long double of numpy.
            Ok(number) => self.value(&PyFloat::new(value.py(), number)),
            Err(_) => self.refuse_type(value),
        }
    }

    fn refuse_type(&mut self, value: &Bound<'_, PyAny>) -> PyResult<()> {
        if value.is_none() {
            return self.refuse("a scene cannot hold None", "leave the key out");
        }
        let kind = value.get_type().name().map_or_else(|_| "object".into(), |name| name.to_string());
        let help = "a scene holds numbers, strings, True and False, dicts, lists and numpy arrays";
        self.refuse(format!("a scene cannot hold a value of the type {kind}"), help)
    }

    fn table(&mut self, table: &Bound<'_, PyMapping>) -> PyResult<()> {
        self.text.push_str("{ ");
        for (number, entry) in table.items()?.iter().enumerate() {
            if number > 0 {
                self.text.push_str(", ");
            }
            self.entry(&entry)?;
        }
        self.text.push_str(" }");
        Ok(())
    }

    fn list(&mut self, entries: &Bound<'_, PyAny>) -> PyResult<()> {
        self.text.push('[');
        for (number, entry) in entries.try_iter()?.enumerate() {
            if number > 0 {
                self.text.push_str(", ");
            }
            self.path.push(Step::Entry(number));
            self.value(&entry?)?;
            self.path.pop();
        }
        self.text.push(']');
        Ok(())
    }

    /// Writes a text in quotes on one line, with the escapes of JSON, which TOML understands. TOML also requires one
    /// for U+007F.
    fn quoted(&mut self, text: &str) {
        let quoted = serde_json::Value::from(text).to_string().replace('\u{7f}', "\\u007F");
        self.text.push_str(&quoted);
    }
}

/// Returns whether an array of numpy hides some of its values.
fn is_masked(array: &Bound<'_, PyAny>) -> bool {
    let any = array.getattr("mask").and_then(|mask| mask.call_method0("any"));
    any.and_then(|any| any.is_truthy()).unwrap_or(false)
}

/// Returns the rows of a two-dimensional array of numpy, or none if its numbers are better written one by one.
///
/// # Errors
/// The exception of numpy if there is too little memory.
fn rows(array: &Bound<'_, PyAny>, is_whole: bool) -> PyResult<Option<Rows>> {
    let shape_and_kind = || -> PyResult<((usize, usize), String)> {
        Ok((array.getattr("shape")?.extract()?, array.getattr("dtype")?.getattr("kind")?.extract()?))
    };
    let Ok(((count, width), kind)) = shape_and_kind() else { return Ok(None) };
    let bytes = |kind: &str| array.call_method1("astype", (kind,))?.call_method0("tobytes");
    let numbers = match kind.as_str() {
        "i" | "u" if is_whole => {
            let whole = decode_each(bytes("<i8")?.extract()?, i64::from_le_bytes);
            whole.into_iter().map(u32::try_from).collect::<Result<_, _>>().ok().map(Numbers::Whole)
        }
        "f" | "i" | "u" if !is_whole => Some(Numbers::Real(decode_each(bytes("<f8")?.extract()?, f64::from_le_bytes))),
        _ => None,
    };
    Ok(numbers.filter(|_| count > 0 && width > 0).map(|numbers| Rows { width, numbers }))
}

/// Converts each eight bytes to a number.
fn decode_each<T>(bytes: &[u8], number: impl Fn([u8; 8]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|eight| number(*eight)).collect()
}

/// Returns a value as Python shows it, if that is short.
pub(super) fn short_repr(value: &Bound<'_, PyAny>) -> String {
    let short_repr = value.repr().map(|text| text.to_string()).unwrap_or_default();
    if short_repr.is_empty() || short_repr.chars().count() > 40 { "another value".into() } else { short_repr }
}
