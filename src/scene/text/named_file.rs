//! Files that a scene names.

use std::io::ErrorKind;
use std::path::Path;

use crate::error::nearest_file;

/// Extensions of image files, and of tables.
pub(in crate::scene) const IMAGES: &[&str] = &["png", "jpg", "jpeg", "exr", "hdr"];
pub(in crate::scene) const TABLES: &[&str] = &["csv", "txt", "tsv", "dat"];

/// A kind of file that a scene names.
pub(in crate::scene) struct FileKind {
    /// The message about an empty name.
    pub(in crate::scene) empty_name_message: &'static str,
    pub(in crate::scene) max_bytes: u64,
    /// Extensions that its name may have; any if there are none.
    pub(in crate::scene) endings: &'static [&'static str],
}

/// What is wrong with a value or with the file that it names.
pub(in crate::scene) struct Fault {
    pub(in crate::scene) message: String,
    /// What to do.
    pub(in crate::scene) help: Option<String>,
}

impl Fault {
    pub(in crate::scene) fn new(message: String, help: impl Into<String>) -> Self {
        Self { message, help: Some(help.into()) }
    }
}

/// Reads a file whose name is relative to a folder.
pub(super) fn read_named(folder: &Path, file: &str, kind: &FileKind) -> Result<Vec<u8>, Fault> {
    let refuse = |message: String| Err(Fault { message, help: None });
    let path = folder.join(file);
    match std::fs::metadata(&path) {
        Ok(found) if found.is_file() && found.len() > kind.max_bytes => {
            return refuse(format!("{file} has {} bytes, more than {}", found.len(), kind.max_bytes));
        }
        // Reading a device may never end.
        Ok(found) if !found.is_file() && !found.is_dir() => return refuse(format!("{file} is a device, not a file")),
        _ => {}
    }
    match std::fs::read(&path) {
        Ok(bytes) => Ok(bytes),
        Err(_) if file.is_empty() => refuse(kind.empty_name_message.into()),
        Err(_) if path.is_dir() => refuse(format!("{file} is a folder")),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            Err(missing(folder, file, kind.endings))
        }
        Err(error) => refuse(format!("cannot read {file}: {error}")),
    }
}

/// Returns the mistake of naming a file that does not exist, with the nearest name that has one of the extensions.
pub(super) fn missing(folder: &Path, file: &str, endings: &[&str]) -> Fault {
    let near = nearest_file(&folder.join(file), endings);
    let near = near.and_then(|near| near.file_name().map(|name| Path::new(file).with_file_name(name)));
    let help = match near {
        _ if file.contains(['\\', '\t', '\n', '\r', '\u{8}', '\u{c}', '\u{1b}']) => {
            "write / between folders, not \\".into()
        }
        Some(near) => format!("did you mean \"{}\"?", near.display()),
        None if folder.as_os_str().is_empty() => "relative paths start at the current folder".into(),
        None => format!("relative paths start at {}", folder.display()),
    };
    Fault::new(format!("there is no file {file}"), help)
}
