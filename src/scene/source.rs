//! Scenes that are read: a file, a text, or a table that a program has built.

use std::collections::HashMap;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::de::DeTable;

use super::Scene;
use super::compile::compile;
use super::text::{Document, Mistake, explain};
use crate::error::{Diagnostic, Error, Result, nearest_file};

const A_SCENE: &str = "a scene is a TOML file, such as scenes/prism.toml";

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
        let refuse = |message: String, help: String| Err(Error::Arguments { message, help: Some(help) });
        let shown = path.display();
        let text = match std::fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) => {
                return match error.kind() {
                    ErrorKind::NotFound | ErrorKind::NotADirectory => {
                        let near = nearest_file(path).map(|near| format!("did you mean {}?", near.display()));
                        refuse(format!("there is no scene file {shown}"), near.unwrap_or(A_SCENE.into()))
                    }
                    ErrorKind::IsADirectory => refuse(format!("{shown} is a folder, not a scene"), A_SCENE.into()),
                    ErrorKind::InvalidData => refuse(format!("{shown} is not text in UTF-8"), A_SCENE.into()),
                    _ => Err(Error::Io { doing: "read", path: path.to_owned(), source: error }),
                };
            }
        };
        // A byte order mark would count as a column.
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned();
        Ok(Self { path: path.to_owned(), text })
    }

    /// The scene that the text describes, with the meshes, images and tables that it names.
    ///
    /// # Errors
    /// [`Error::Scene`] with all mistakes that can be found, in the order of the file, each with its line and what to
    /// do.
    pub fn compile(&self) -> Result<Scene> {
        self.compile_by(Place::Line)
    }

    fn compile_by(&self, place: Place) -> Result<Scene> {
        let table = match DeTable::parse(&self.text) {
            Ok(table) => table,
            Err(error) => return Err(self.error(vec![explain(&self.text, &error)], |_| None)),
        };
        let document = Document::new(&self.text, table.get_ref());
        compile(&document, self.path.parent().unwrap_or(Path::new(""))).ok_or_else(|| {
            let mistakes = document.mistakes();
            let paths = match place {
                Place::Line => HashMap::new(),
                Place::Key => document.paths(mistakes.iter().map(|mistake| mistake.span.clone())),
            };
            self.error(mistakes, |span| paths.get(span).cloned())
        })
    }

    fn error(&self, mistakes: Vec<Mistake>, key: impl Fn(&Range<usize>) -> Option<String>) -> Error {
        let text: Arc<str> = self.text.as_str().into();
        let diagnostic = |Mistake { span, message, help }| {
            let (file, text, key) = (self.path.clone(), text.clone(), key(&span));
            Diagnostic { file, text, span, key, message, help }
        };
        Error::Scene(mistakes.into_iter().map(diagnostic).collect())
    }
}

/// By what a mistake is told.
enum Place {
    Line,
    Key,
}

impl Scene {
    /// Reads a scene file, and the meshes, images and tables that it names.
    ///
    /// # Errors
    /// [`Error::Scene`] with all mistakes that can be found, each with its line and what to do;
    /// [`Error::Arguments`] if there is no such file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Source::read(path.as_ref())?.compile()
    }

    /// Reads a scene from a text of the same form as a scene file. Files that it names are looked for in `folder`.
    ///
    /// # Errors
    /// As [`Scene::read`]; the file is called `scene.toml` in messages.
    pub fn parse(text: &str, folder: impl AsRef<Path>) -> Result<Self> {
        Source { path: folder.as_ref().join("scene.toml"), text: text.to_owned() }.compile()
    }

    /// Reads a scene that a program has built: a value that means what a scene file with the same keys means.
    ///
    /// # Errors
    /// As [`Scene::parse`], but each mistake is told with the path of its key, such as `object[3].shape.sphere.radius`.
    pub fn from_table(table: &toml::Table, folder: impl AsRef<Path>) -> Result<Self> {
        let source = Source { path: folder.as_ref().join("scene.toml"), text: table.to_string() };
        source.compile_by(Place::Key)
    }
}
