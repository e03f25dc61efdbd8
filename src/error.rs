//! The one error type: what went wrong, where, and what to do.

use std::fmt;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A failure, worded for the person who ran the command.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene cannot be rendered as written. Lists its mistakes in the order of the file.
    #[error("{}", join_mistakes(.0))]
    Scene(Vec<Diagnostic>),
    /// Something impossible was requested, for example on the command line.
    #[error("{message}")]
    Arguments {
        /// What is wrong.
        message: String,
        /// What to do instead.
        help: Option<String>,
    },
    /// A file could not be read or written.
    #[error("cannot {doing} {}: {source}", .path.display())]
    Io {
        /// "read", "write" or a similar verb.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file is not the image that was expected.
    #[error("cannot read {}: {message}", .path.display())]
    Decode {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        message: String,
    },
    /// An image could not be encoded.
    #[error("cannot write {}: {message}", .path.display())]
    Encode {
        /// The file.
        path: PathBuf,
        /// The message of the encoder.
        message: String,
    },
}

/// `Result` with Abbe's error.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Refuses a request, with advice on what to do instead.
    ///
    /// # Errors
    /// Always returns [`Error::Arguments`].
    pub fn refuse<T>(message: impl Into<String>, help: impl Into<String>) -> Result<T> {
        Err(Self::Arguments { message: message.into(), help: Some(help.into()) })
    }

    /// Returns the exit code of the process: 2 for a bad scene or bad arguments, 1 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Scene(_) | Self::Arguments { .. } => 2,
            Self::Io { .. } | Self::Decode { .. } | Self::Encode { .. } => 1,
        }
    }
}

/// What a program prints if its `main` returns this error, or a test that unwraps it: the message and the help.
impl fmt::Debug for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Arguments { message, help: Some(help) } => write!(formatter, "{message} ({help})"),
            other => write!(formatter, "{other}"),
        }
    }
}

impl From<rayon::ThreadPoolBuildError> for Error {
    fn from(error: rayon::ThreadPoolBuildError) -> Self {
        Self::Arguments { message: format!("cannot start threads: {error}"), help: None }
    }
}

/// A mistake in a scene file, with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// The path of the scene file, as it was given.
    pub file: PathBuf,
    /// The text of the scene file.
    pub text: Arc<str>,
    /// The byte range of the text that is wrong.
    pub span: Range<usize>,
    /// The key that is wrong, such as `object[3].shape.sphere.radius`, if the scene was built by a program and so has
    /// no lines.
    pub key: Option<String>,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl Diagnostic {
    /// Returns the line and column of the mistake, both counted from 1, the column in characters. For many mistakes,
    /// [`Lines`] is faster.
    pub fn line_and_column(&self) -> (usize, usize) {
        Lines::default().place_of(self)
    }

    fn describe(&self, lines: &mut Lines) -> String {
        let summary = match &self.key {
            Some(key) if key.is_empty() => self.message.clone(),
            Some(key) => format!("{key}: {}", self.message),
            None => {
                let (line, column) = lines.place_of(self);
                format!("{}:{line}:{column}: {}", self.file.display(), self.message)
            }
        };
        self.help.iter().fold(summary, |summary, help| format!("{summary} ({help})"))
    }
}

impl std::error::Error for Diagnostic {}

impl fmt::Display for Diagnostic {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(&self.describe(&mut Lines::default()))
    }
}

/// Joins all mistakes, one per line.
fn join_mistakes(mistakes: &[Diagnostic]) -> String {
    let mut lines = Lines::default();
    mistakes.iter().map(|mistake| mistake.describe(&mut lines)).collect::<Vec<_>>().join("\n")
}

/// Finds the line and column of one mistake after another. If they come in text order, the text is scanned only once.
#[derive(Clone, Debug)]
pub struct Lines {
    text: Arc<str>,
    /// The number of bytes scanned so far, and the line and column behind them.
    read: usize,
    line: usize,
    column: usize,
}

impl Default for Lines {
    fn default() -> Self {
        Self { text: "".into(), read: 0, line: 1, column: 1 }
    }
}

impl Lines {
    /// Returns the line and column of a mistake, both counted from 1, the column in characters.
    pub fn place_of(&mut self, mistake: &Diagnostic) -> (usize, usize) {
        let at = mistake.span.start.min(mistake.text.len());
        if !Arc::ptr_eq(&self.text, &mistake.text) || at < self.read {
            *self = Self { text: mistake.text.clone(), ..Self::default() };
        }
        let passed = &self.text[self.read..at];
        let line_start = passed.rfind('\n').map(|newline| newline + 1);
        self.line += passed.matches('\n').count();
        self.column = line_start.map_or(self.column, |_| 1) + passed[line_start.unwrap_or(0)..].chars().count();
        self.read = at;
        (self.line, self.column)
    }
}

/// Returns the candidate that a misspelled word most likely meant, if one is close enough.
///
/// A candidate is close enough if at most a third of its letters differ, where a swap of neighbors counts as one
/// change. One change is always allowed if one of the two words has at least two letters and the other at least three.
/// Among equally close candidates, the one that shares the most letters wins. A candidate that contains the whole word
/// after a hyphen, as `N-BK7` contains `BK7`, is closer than one with a letter changed.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    let length = lower.chars().count();
    let distance = |candidate: &str| {
        let candidate = candidate.to_lowercase();
        let has_word = length > 1 && candidate.split('-').skip(1).any(|part| part == lower);
        let other = candidate.chars().count();
        let max_changes = (other / 3).max(usize::from(length.min(other) >= 2 && length.max(other) >= 3));
        // The edit distance is at least the difference in length.
        if !has_word && length.abs_diff(other) > max_changes {
            return None;
        }
        let changes = strsim::osa_distance(&lower, &candidate);
        (has_word || changes <= max_changes)
            .then(|| (changes > 0, !has_word, changes, unshared_letters(&lower, &candidate)))
    };
    let near = candidates.into_iter().filter_map(|candidate| Some((distance(candidate)?, candidate)));
    near.min_by_key(|(distance, _)| *distance).map(|(_, candidate)| candidate)
}

/// Returns whether the file name has one of the given extensions.
pub(crate) fn has_extension(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    endings.iter().any(|known| known.eq_ignore_ascii_case(ending))
}

/// Returns the file next to a missing one that was most likely meant, among those with one of the given extensions, or
/// among all files if no extensions are given.
pub(crate) fn nearest_file(missing: &Path, endings: &[&str]) -> Option<PathBuf> {
    let folder = missing.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let has_ending = |path: &Path| endings.is_empty() || has_extension(path, endings);
    let paths = fs::read_dir(folder).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let files = paths.filter(|path| has_ending(path) && path.is_file());
    let mut names: Vec<String> = files.filter_map(|path| path.file_name()?.to_str().map(str::to_owned)).collect();
    names.sort();
    // An extension that both share must not make a short name look closer to another.
    let stem = |name: &str| Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or_default().to_owned();
    let missing_name = missing.file_name()?.to_str()?;
    let stems: Vec<String> = names.iter().map(|name| stem(name)).collect();
    let near = nearest(&stem(missing_name), stems.iter().map(String::as_str))?;
    let same_stem = || names.iter().zip(&stems).filter(|(_, stem)| *stem == near).map(|(name, _)| name.as_str());
    Some(missing.with_file_name(nearest(missing_name, same_stem()).or_else(|| same_stem().next())?))
}

/// Counts the letters that only one of two words has.
fn unshared_letters(a: &str, b: &str) -> usize {
    let mut rest: Vec<char> = b.chars().collect();
    let missing = a.chars().filter(|letter| {
        let at = rest.iter().position(|other| other == letter);
        at.map(|at| rest.swap_remove(at)).is_none()
    });
    missing.count() + rest.len()
}
