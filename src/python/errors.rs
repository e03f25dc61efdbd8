//! Errors as Python exceptions.

use std::fs::create_dir_all;
use std::io::ErrorKind;
use std::path::Path;

use abbe::{Diagnostic, Error, Lines};
use pyo3::exceptions::{PyFileNotFoundError, PyOSError, PyTypeError};
use pyo3::prelude::*;

pyo3::import_exception!(abbe._errors, OptionsError);
pyo3::import_exception!(abbe._errors, RenderError);
pyo3::import_exception!(abbe._errors, SceneError);

/// A mistake as the arguments of `abbe.Mistake`: key, message, help, file, line and column.
type Mistake = (Option<String>, String, Option<String>, String, usize, usize);

/// The system's error number for a missing file.
const ENOENT: i32 = 2;

/// Converts an error to an exception.
pub(super) fn to_exception(error: Error) -> PyErr {
    match error {
        Error::Scene(ref mistakes) => {
            let mut lines = Lines::default();
            let all: Vec<_> = mistakes.iter().map(|found| mistake(found, &mut lines)).collect();
            SceneError::new_err((error.to_string(), all))
        }
        Error::Arguments { message, help } => {
            OptionsError::new_err((for_python(&message), help.map(|help| for_python(&help))))
        }
        Error::Io { doing, path, source } => match source.raw_os_error() {
            Some(number) => {
                let reason = source.to_string().replace(&format!(" (os error {number})"), "");
                PyOSError::new_err((number, reason, path.into_os_string()))
            }
            None => PyOSError::new_err(format!("cannot {doing} {}: {source}", path.display())),
        },
        error => RenderError::new_err((error.to_string(), None::<String>)),
    }
}

/// Converts an error of reading a file, which may not exist, to an exception.
pub(super) fn to_file_exception(path: &Path, error: Error) -> PyErr {
    match error {
        Error::Arguments { message, help } if !path.exists() => {
            let help = help.map_or(String::new(), |help| format!(" ({help})"));
            PyFileNotFoundError::new_err((ENOENT, message + &help, path.as_os_str().to_owned()))
        }
        error => to_exception(error),
    }
}

/// Returns an exception for an argument: what is wrong with it, and what to do.
pub(super) fn refuse<T>(message: impl Into<String>, help: &str) -> PyResult<T> {
    Err(OptionsError::new_err((message.into(), Some(help.to_owned()))))
}

/// Returns an exception for an object that cannot be sent to another process or kept as bytes, with help on what can.
pub(super) fn refuse_pickle<T>(what: &str, help: &str) -> PyResult<T> {
    Err(PyTypeError::new_err(format!("{what} cannot be pickled: {help}")))
}

/// Checks that a file to write has the ending of its kind, and creates its folder if that is missing.
///
/// # Errors
/// If the file has another ending, or its folder cannot be created.
pub(super) fn prepare_output(path: &Path, ending: &str) -> PyResult<()> {
    if !path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending)) {
        let message = match path.as_os_str().is_empty() {
            true => "the file to write has no name".to_owned(),
            false => format!("the file to write ends in .{ending}, not {}", path.display()),
        };
        return refuse(message, &format!("for instance: \"image.{ending}\""));
    }
    let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) else { return Ok(()) };
    match create_dir_all(folder) {
        // A file in place of the folder is reported when the image is written.
        Err(error) if error.kind() != ErrorKind::AlreadyExists => {
            Err(to_exception(Error::Io { doing: "make", path: folder.to_owned(), source: error }))
        }
        _ => Ok(()),
    }
}

/// Returns an exception for something that should never happen.
pub(super) fn bug_error(what: &str) -> PyErr {
    RenderError::new_err((format!("this is a bug in Abbe: {what}"), None::<String>))
}

fn mistake(found: &Diagnostic, lines: &mut Lines) -> Mistake {
    let (line, column) = lines.place_of(found);
    let Diagnostic { file, key, message, help, .. } = found.clone();
    (key, message, help, file.display().to_string(), line, column)
}

/// Removes the dashes of flags from a message, as arguments in Python have the same names. Leaves a whole command as it
/// is.
pub(super) fn for_python(words: &str) -> String {
    if words.contains("render --") { words.to_owned() } else { words.replace("--", "") }
}
