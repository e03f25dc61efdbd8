//! Checks of what the command is about to write.

use std::cmp::Reverse;
use std::fs;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use abbe::film::check_writable;
use abbe::{Error, Result, Scene};

pub fn has_extension(path: &Path, ending: &str) -> bool {
    path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending))
}

/// Returns whether a path stands for standard input or output.
pub fn is_stdio(path: &Path) -> bool {
    path == Path::new("-")
}

/// Refuses an image on standard output if that is a terminal, or if the image has spectra, which need a second file.
pub fn check_stdout(spectral: bool) -> Result<()> {
    if spectral {
        let message = "spectra are written to a file beside the image, which standard output does not allow";
        return Error::refuse(message, "name the image, as in --exr out/frame.exr");
    }
    if std::io::stdout().is_terminal() {
        return Error::refuse(
            "an EXR is binary, and standard output is a terminal",
            "redirect it: --exr - > frame.exr",
        );
    }
    Ok(())
}

/// Refuses a picture whose name does not end in .png.
pub fn check_png(png: Option<&Path>) -> Result<()> {
    match png.filter(|png| !has_extension(png, "png")) {
        Some(png) => {
            let message = format!("--png writes a file that ends in .png, not {}", png.display());
            Error::refuse(message, "for instance: --png look.png")
        }
        None => Ok(()),
    }
}

/// Refuses a text file, such as `--report frame.json`, if it has the name of an image, which it might replace, or would
/// go to standard output.
pub fn check_text_file(flag: &str, example: &str, file: Option<&Path>) -> Result<()> {
    let refused = |message: String| Error::refuse(message, format!("for instance: {flag} {example}"));
    match file {
        Some(file) if is_stdio(file) => refused(format!("{flag} writes a file, and - is standard output")),
        Some(file) if ["exr", "png"].iter().any(|ending| has_extension(file, ending)) => {
            refused(format!("{flag} does not write an image, but {} has the name of one", file.display()))
        }
        _ => Ok(()),
    }
}

/// Refuses an output that is the input itself, under another name or through a link.
pub fn check_not_input(input: &Path, what: &str, output: &Path) -> Result<()> {
    let real = |path: &Path| fs::canonicalize(path).ok();
    match real(output).filter(|output| real(input).as_ref() == Some(output)) {
        Some(_) => Error::refuse(format!("{} is the {what} itself", output.display()), "name another file"),
        None => Ok(()),
    }
}

/// Refuses an output that is a file of the scene, or the same file as another output, whatever its name.
pub fn check_outputs(scene: &Scene, outputs: &[&Path]) -> Result<()> {
    let [own, others @ ..] = &scene.files[..] else { return Ok(()) };
    let refused = |message: String| Error::refuse(message, "name another file");
    let read: Vec<PathBuf> = others.iter().map(|other| canonical_path(other)).collect();
    let written: Vec<PathBuf> = outputs.iter().map(|output| canonical_path(output)).collect();
    for (number, (output, file)) in outputs.iter().zip(&written).enumerate() {
        check_not_input(own, "scene", output)?;
        let name = output.display();
        if read.contains(file) {
            return refused(format!("{name} is a file that the scene reads"));
        }
        // A device can be written twice.
        let is_file = !output.exists() || output.is_file();
        if is_file && written[..number].contains(file) {
            return refused(format!("{name} would be written twice"));
        }
    }
    Ok(())
}

/// Returns the unique path, without links, of a file that may not exist yet.
fn canonical_path(path: &Path) -> PathBuf {
    let in_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let folder = fs::canonicalize(folder).or_else(|_| std::path::absolute(folder)).ok();
        folder.zip(path.file_name()).map(|(folder, name)| folder.join(name))
    };
    fs::canonicalize(path).ok().or_else(in_folder).unwrap_or_else(|| path.to_owned())
}

/// Refuses an exposure that is not a finite number of stops.
pub fn check_exposure(stops: Option<f64>) -> Result<()> {
    match stops.filter(|stops| !stops.is_finite()) {
        Some(_) => Error::refuse("an exposure is a finite number of stops", "for instance: --exposure 1"),
        None => Ok(()),
    }
}

/// Folders that were created for files and may still be empty.
static CREATED_FOLDERS: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn created_folders() -> MutexGuard<'static, Vec<PathBuf>> {
    CREATED_FOLDERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all created folders that are empty.
pub fn remove_empty_folders() {
    let mut created_folders = created_folders();
    created_folders.sort_by_key(|folder| Reverse(folder.components().count()));
    // A folder that is not empty cannot be removed, and stays.
    created_folders.drain(..).for_each(|folder| drop(fs::remove_dir(folder)));
}

/// Folders that are created for files, and removed in the end if they are empty.
#[must_use]
pub struct Folders(());

impl Folders {
    /// Checks before a long render whether files can be written, and creates the folders that are missing.
    pub fn of_files(files: &[&Path]) -> Result<Self> {
        let all = Self(());
        for file in files {
            let folders = file.ancestors().skip(1).filter(|folder| !folder.as_os_str().is_empty());
            let missing = folders.take_while(|folder| !folder.exists());
            created_folders().extend(missing.map(Path::to_owned));
            check_writable(file)?;
        }
        Ok(all)
    }
}

impl Drop for Folders {
    fn drop(&mut self) {
        remove_empty_folders();
    }
}
