//! Descriptions of errors in plain words.

use std::io::ErrorKind;

use abbe::Error;

/// Describes in one line what went wrong with a file or a request.
pub fn problem(error: &Error) -> String {
    match error {
        Error::Io { doing, path, source } => format!("cannot {doing} {}: {}", path.display(), reason(doing, source)),
        other => other.to_string(),
    }
}

/// Describes an error of the system, in plain words if its own message is terse.
pub fn reason(doing: &str, error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound if doing == "read" => "there is no such file".into(),
        ErrorKind::NotFound => "its folder does not exist and cannot be made".into(),
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => "there is a file where its folder should be".into(),
        ErrorKind::PermissionDenied => "permission is denied".into(),
        ErrorKind::ReadOnlyFilesystem => "that disk is read-only".into(),
        ErrorKind::StorageFull => "the disk is full".into(),
        ErrorKind::OutOfMemory => "not enough memory is free; --crop and --shard render a part of the image".into(),
        _ => error.to_string(),
    }
}
