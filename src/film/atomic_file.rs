//! Writes files atomically: they appear completely or not at all.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Cursor, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::error::{Error, Result};

/// The maximum number of links that are followed, as on Linux.
const MAX_LINKS: u32 = 40;
/// The maximum number of temporary files left behind by earlier runs that died and had the same process ID.
const MAX_LEFTOVERS: u32 = 1000;

/// The destination of a file's bytes. It can seek, because some of the first bytes may be known last.
pub(super) trait Destination: Write + Seek {}

impl<P: Write + Seek> Destination for P {}

/// Writes a file under a temporary name next to the target, then renames it, so that readers never see an incomplete
/// file. Creates missing folders.
///
/// Symbolic links are kept, and their target is replaced. Permissions are kept. Other hard links to the file keep the
/// old content. A target other than a regular file, such as a pipe, is written to directly.
///
/// # Errors
/// If the file cannot be written. An existing file is then untouched, and nothing else is left behind.
pub fn replace_file(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let path = path.as_ref();
    replace_with(path, |place| place.write_all(bytes).map_err(|source| cannot_write(path, source)))
}

/// Replaces a file like [`replace_file`] does, with bytes that `write` produces one after another. For a device, all
/// bytes are collected in memory before the first is written. Returns what `write` returns.
///
/// # Errors
/// The errors of [`replace_file`], and those of `write`.
pub(super) fn replace_with<T>(path: &Path, write: impl FnOnce(&mut dyn Destination) -> Result<T>) -> Result<T> {
    let failed = |source| cannot_write(path, source);
    let target = match Target::of(path).map_err(failed)? {
        Target::Device => {
            let mut bytes = Cursor::new(Vec::new());
            let answer = write(&mut bytes)?;
            let mut device = File::options().write(true).open(path).map_err(failed)?;
            return device.write_all(bytes.get_ref()).map(|()| answer).map_err(failed);
        }
        Target::File(target) => target,
    };
    let created = Temporary::create_near(&target).or_else(|error| match error.kind() {
        // The folder may have been removed while the image was rendered.
        io::ErrorKind::NotFound => make_folder(&target).and_then(|()| Temporary::create_near(&target)),
        _ => Err(error),
    });
    let (mut file, temporary) = created.map_err(failed)?;
    let answer = write(&mut file)?;
    let finish = || {
        if let Ok(before) = fs::metadata(&target) {
            file.set_permissions(before.permissions())?;
        }
        file.sync_all()?;
        temporary.finish(&target)
    };
    finish().map(|()| answer).map_err(failed)
}

/// Returns the error for a file that cannot be written.
pub(super) fn cannot_write(path: &Path, source: io::Error) -> Error {
    Error::Io { doing: "write", path: path.to_owned(), source }
}

/// Returns the error for a file that cannot be read.
pub(super) fn cannot_read(path: &Path, source: io::Error) -> Error {
    Error::Io { doing: "read", path: path.to_owned(), source }
}

/// Checks before a long render whether its image can be written. Creates the folder if it is missing.
///
/// # Errors
/// If the folder cannot be created or written to, if the path is a folder or a circular link, or if the file is
/// write-protected.
pub fn check_writable(path: impl AsRef<Path>) -> Result<()> {
    let path = path.as_ref();
    let attempt = Target::of(path).and_then(|target| match target {
        // Opening and closing a pipe would signal the end of the image to its reader.
        Target::Device if is_pipe(path) => Ok(()),
        Target::Device => File::options().write(true).open(path).map(drop),
        Target::File(target) => {
            make_folder(&target)?;
            Temporary::create_near(&target).map(drop)
        }
    });
    attempt.map_err(|source| cannot_write(path, source))
}

/// Creates the folder of a file, if it is missing.
fn make_folder(file: &Path) -> io::Result<()> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.map_or(Ok(()), fs::create_dir_all)
}

/// What a path refers to.
enum Target {
    /// A regular file, which may not exist yet. Links are resolved.
    File(PathBuf),
    /// Something else that accepts bytes.
    Device,
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        let name = path.file_name().map(OsStr::as_encoded_bytes);
        if !name.is_some_and(|name| path.as_os_str().as_encoded_bytes().ends_with(name)) {
            return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is the name of a folder"));
        }
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => return Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")),
            Ok(found) if !found.is_file() => return Ok(Self::Device),
            Ok(found) if found.permissions().readonly() => return Err(io::ErrorKind::PermissionDenied.into()),
            _ => {}
        }
        let mut target = path.to_owned();
        for _ in 0..MAX_LINKS {
            match fs::read_link(&target) {
                Ok(next) => target = target.parent().unwrap_or(Path::new("")).join(next),
                Err(_) => return Ok(Self::File(target)),
            }
        }
        Err(io::Error::other("it is a link that leads back to itself"))
    }
}

#[cfg(unix)]
fn is_pipe(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|found| found.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_pipe(_: &Path) -> bool {
    false
}

/// A temporary file with a short, unique name, removed unless it is renamed to its target.
struct Temporary(PathBuf);

/// The temporary files that are being written.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished_files() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all unfinished files when the process is about to end. From then on, no file can be begun or finished.
pub fn remove_unfinished() {
    let mut unfinished = unfinished_files();
    unfinished.drain(..).for_each(|path| drop(fs::remove_file(path)));
    // The lock is never released, so nobody begins another file before the process ends.
    std::mem::forget(unfinished);
}

impl Temporary {
    /// Creates a temporary file in the folder of the target.
    fn create_near(target: &Path) -> io::Result<(File, Self)> {
        let mut number = 0;
        loop {
            let path = target.with_file_name(format!(".abbe-{}-{number}", std::process::id()));
            let mut unfinished = unfinished_files();
            match File::create_new(&path) {
                Ok(file) => {
                    unfinished.push(path.clone());
                    return Ok((file, Self(path)));
                }
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists && number < MAX_LEFTOVERS => number += 1,
                Err(error) => return Err(error),
            }
        }
    }

    fn finish(self, target: &Path) -> io::Result<()> {
        let mut unfinished = unfinished_files();
        fs::rename(&self.0, target)?;
        unfinished.retain(|path| *path != self.0);
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let mut unfinished = unfinished_files();
        if let Some(place) = unfinished.iter().position(|path| *path == self.0) {
            unfinished.swap_remove(place);
            // The earlier error is the one to report. Failing to remove the temporary file as well changes nothing.
            let _ = fs::remove_file(&self.0);
        }
    }
}
