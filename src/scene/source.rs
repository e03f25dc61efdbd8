//! The text of a scene file, and where in it a mistake stands.

use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::Description;
use crate::error::{Diagnostic, Error, Result, nearest};

/// A scene file that was read.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its path as it was named.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Source {
    /// Reads a scene file.
    ///
    /// # Errors
    /// If it cannot be read or is not UTF-8.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|source| match source.kind() {
            std::io::ErrorKind::NotFound | std::io::ErrorKind::IsADirectory => Error::Arguments {
                message: format!("there is no scene file {}", path.display()),
                help: Some("a scene is a TOML file, such as scenes/prism.toml".into()),
            },
            std::io::ErrorKind::InvalidData => Error::Arguments {
                message: format!("{} is not text in UTF-8", path.display()),
                help: Some("a scene is a TOML file, such as scenes/prism.toml".into()),
            },
            _ => Error::Io { doing: "read", path: path.to_owned(), source },
        })?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// The description the text gives.
    ///
    /// # Errors
    /// If the text is not TOML or holds a key or value that no scene has.
    pub fn parse(&self) -> Result<Description> {
        toml::from_str(&self.text).map_err(|error| {
            let message = error.message().lines().next().unwrap_or("this is not TOML").to_owned();
            let help = suggestion(&message);
            self.mistake(error.span().unwrap_or(0..0), message, help)
        })
    }

    /// The folder that file names in the scene are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }

    /// The error of a mistake at a place in the scene.
    pub(super) fn mistake_at(&self, place: &At, message: impl Into<String>, help: Option<String>) -> Error {
        self.mistake(self.span(place), message.into(), help)
    }

    fn mistake(&self, span: Range<usize>, message: String, help: Option<String>) -> Error {
        Error::Scene(Diagnostic { file: self.path.clone(), text: self.text.clone(), span, message, help })
    }

    /// The bytes of the value at a place, or of the nearest value around it that is written down.
    fn span(&self, place: &At) -> Range<usize> {
        let Ok(document) = DeTable::parse(&self.text) else { return 0..0 };
        let mut span = 0..0;
        let mut table = Some(document.get_ref());
        let mut value: Option<&DeValue> = None;
        for step in place.steps() {
            let next = match (step, table, value) {
                (Step::Key(key), Some(table), _) => table.get(*key),
                (Step::Index(index), _, Some(DeValue::Array(array))) => array.get(*index),
                _ => None,
            };
            let Some(next) = next else { break };
            span = next.span();
            value = Some(next.get_ref());
            table = if let DeValue::Table(inner) = next.get_ref() { Some(inner) } else { None };
        }
        span
    }
}

/// A place in the scene, as keys and positions from the top.
#[derive(Clone, Copy, Debug)]
pub(super) struct At<'a> {
    parent: Option<&'a At<'a>>,
    step: Step<'a>,
}

#[derive(Clone, Copy, Debug)]
enum Step<'a> {
    Key(&'a str),
    Index(usize),
}

impl<'a> At<'a> {
    pub(super) fn top(key: &'a str) -> Self {
        Self { parent: None, step: Step::Key(key) }
    }

    pub(super) fn key(&'a self, key: &'a str) -> At<'a> {
        At { parent: Some(self), step: Step::Key(key) }
    }

    pub(super) fn index(&'a self, index: usize) -> At<'a> {
        At { parent: Some(self), step: Step::Index(index) }
    }

    fn steps(&self) -> Vec<&Step<'a>> {
        let mut steps = self.parent.map_or_else(Vec::new, |parent| parent.steps());
        steps.push(&self.step);
        steps
    }
}

/// "did you mean" for a message of the form: unknown field `x`, expected one of `a`, `b`.
fn suggestion(message: &str) -> Option<String> {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let (word, known) = quoted.split_first()?;
    if !message.starts_with("unknown ") {
        return None;
    }
    nearest(word, known.iter().copied()).map(|near| format!("did you mean `{near}`?"))
}
