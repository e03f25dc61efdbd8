//! The text of a scene file, and where in it a mistake stands.

use std::cell::OnceCell;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::structure::Mistake;
use super::{Description, Scene, compile, reader, syntax};
use crate::error::{Diagnostic, Error, Result, nearest};

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

    /// What the text says; what is wrong with it is told when it is compiled, together with all that is found then.
    ///
    /// # Errors
    /// If the text is not TOML.
    pub fn parse(&self) -> Result<Description> {
        match DeTable::parse(&self.text) {
            Ok(document) => Ok(reader::read(&self.text, &document)),
            Err(error) => Err(Located::new(self).mistake(syntax::explain(&self.text, &error))),
        }
    }

    /// The folder that file names in the scene are relative to.
    pub fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

impl Scene {
    /// Reads a scene file, and the meshes, images and tables that it names.
    ///
    /// # Errors
    /// [`Error::Scene`] with all mistakes that can be found, each with its line and what to do;
    /// [`Error::Arguments`] if there is no such file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let source = Source::read(path.as_ref())?;
        compile(&source.parse()?, &source)
    }

    /// Reads a scene from a text of the same form as a scene file. Files that it names are looked for in `folder`.
    ///
    /// # Errors
    /// As [`Scene::read`]; the file is called `scene.toml` in messages.
    pub fn parse(text: &str, folder: impl AsRef<Path>) -> Result<Self> {
        let source = Source { path: folder.as_ref().join("scene.toml"), text: text.to_owned() };
        compile(&source.parse()?, &source)
    }

    /// Reads a scene that a program has built: a value that means what a scene file with the same keys means.
    ///
    /// # Errors
    /// As [`Scene::parse`]; lines are those of the value as TOML, which is shown.
    pub fn from_table(table: &toml::Table, folder: impl AsRef<Path>) -> Result<Self> {
        Self::parse(&table.to_string(), folder)
    }
}

/// A scene file and where everything in it stands, which is looked for at the first mistake.
pub(super) struct Located<'a> {
    source: &'a Source,
    document: OnceCell<Option<Spanned<DeTable<'a>>>>,
    text: OnceCell<Arc<str>>,
}

impl<'a> Located<'a> {
    pub(super) fn new(source: &'a Source) -> Self {
        Self { source, document: OnceCell::new(), text: OnceCell::new() }
    }

    pub(super) fn folder(&self) -> &'a Path {
        self.source.folder()
    }

    /// The error of a mistake at a place in the scene.
    pub(super) fn mistake_at(&self, place: &At, message: impl Into<String>, help: Option<String>) -> Error {
        self.mistake((self.span(place), message.into(), help))
    }

    /// The error of a file that the scene names and that is not there.
    pub(super) fn missing_file(&self, place: &At, file: &str) -> Error {
        let near = nearest_file(&self.folder().join(file));
        let near = near.and_then(|near| near.file_name().map(|name| Path::new(file).with_file_name(name)));
        let help = match near {
            Some(near) => format!("did you mean \"{}\"?", near.display()),
            None => "the path starts at the folder of the scene".into(),
        };
        self.mistake_at(place, format!("there is no file {file}"), Some(help))
    }

    pub(super) fn mistake(&self, (span, message, help): Mistake) -> Error {
        // Names in a scene may hold anything, even the end of a line.
        let one_line = |text: String| text.replace(char::is_control, " ");
        let (message, help) = (one_line(message), help.map(one_line));
        let text = self.text.get_or_init(|| self.source.text.as_str().into()).clone();
        Error::Scene(vec![Diagnostic { file: self.source.path.clone(), text, span, message, help }])
    }

    /// The bytes of the value at a place, or of the nearest value around it that is written down.
    pub(super) fn span(&self, place: &At) -> Range<usize> {
        let document = self.document.get_or_init(|| DeTable::parse(&self.source.text).ok());
        let mut span = 0..0;
        let mut table = document.as_ref().map(Spanned::get_ref);
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

impl std::fmt::Display for At<'_> {
    fn fmt(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
        for (number, step) in self.steps().into_iter().enumerate() {
            match step {
                Step::Key(key) if number == 0 => write!(formatter, "{key}")?,
                Step::Key(key) => write!(formatter, ".{key}")?,
                Step::Index(index) => write!(formatter, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// The file beside a missing one that was most likely meant.
fn nearest_file(missing: &Path) -> Option<PathBuf> {
    let folder = missing.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let files = std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<String> = files.collect();
    names.sort();
    let near = nearest(missing.file_name()?.to_str()?, names.iter().map(String::as_str))?;
    Some(missing.with_file_name(near))
}
