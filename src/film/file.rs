//! Files that appear whole or not at all.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::error::{Error, Result};

/// Writes a file under a temporary name beside the target, then renames it: a reader never sees half of it.
///
/// # Errors
/// If it cannot be written; a file that was there before is then untouched, and nothing else is left behind.
pub(super) fn replace_file(path: &Path, bytes: &[u8]) -> Result<()> {
    let temporary = temporary(path);
    let written = File::create(&temporary)
        .and_then(|mut file| file.write_all(bytes).and_then(|()| file.sync_all()))
        .and_then(|()| fs::rename(&temporary, path));
    written.map_err(|source| {
        // The write's error is the one to report; a temporary file that cannot be removed either changes nothing.
        let _ = fs::remove_file(&temporary);
        Error::Io { doing: "write", path: path.to_owned(), source }
    })
}

/// Finds out before a long render whether its image can be written; creates the folder if it is missing.
///
/// # Errors
/// If the folder cannot be made or written to, or the path is a folder.
pub fn check_writable(path: &Path) -> Result<()> {
    let error = |source: io::Error| Error::Io { doing: "write", path: path.to_owned(), source };
    if path.is_dir() {
        return Err(error(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")));
    }
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(error)?;
    }
    let temporary = temporary(path);
    File::create(&temporary).and_then(|_| fs::remove_file(&temporary)).map_err(error)
}

fn temporary(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(format!(".tmp-{}", std::process::id()));
    name.into()
}
