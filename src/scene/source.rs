//! Ways to read a scene: from a file, a text, or a table that a program has built.

use std::collections::HashMap;
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::de::DeTable;

use super::Scene;
use super::compile::{SECTIONS, compile};
use super::foreign::{SCENE_HELP, foreign};
use super::text::{
    Document, Fault, IncludedTexts, LocatedBy, MAX_BYTES, Mistake, Rows, Texts, merge_files, parse_toml, set,
    substitute_variables, utf8,
};
use crate::error::{Error, Result, nearest_file};

/// The name that messages use for the text of all settings. Each setting is one line of it.
pub const SETTINGS: &str = "--set";

/// The text of a scene file.
#[derive(Clone, Debug)]
pub struct Source {
    /// Its path as the caller gave it.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Source {
    /// Reads a scene file.
    ///
    /// # Errors
    /// If it cannot be read or is not UTF-8.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let shown = path.display();
        let bytes = match File::open(path).and_then(read_limited) {
            Ok(bytes) => bytes,
            Err(error) => {
                return match error.kind() {
                    ErrorKind::NotFound | ErrorKind::NotADirectory => {
                        let near =
                            nearest_file(path, &["toml"]).map(|near| format!("did you mean {}?", near.display()));
                        Error::refuse(format!("there is no scene file {shown}"), near.unwrap_or(SCENE_HELP.into()))
                    }
                    ErrorKind::IsADirectory => Error::refuse(format!("{shown} is a folder, not a scene"), SCENE_HELP),
                    _ => Err(Error::Io { doing: "read", path: path.to_owned(), source: error }),
                };
            }
        };
        let text = decode_text(bytes, &shown.to_string());
        let is_toml = || text.as_ref().is_ok_and(|text| parse_toml(text, 0).is_ok());
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        match foreign(path, &name).filter(|_| !is_toml()) {
            Some((kind, help)) => Error::refuse(format!("{shown} is {kind}, not a scene in TOML"), help),
            None => Ok(Self { path: path.to_owned(), text: text? }),
        }
    }

    /// Reads a scene from standard input. Files that it names are looked up in the current folder.
    ///
    /// # Errors
    /// If it cannot be read or is not UTF-8.
    pub fn standard_input() -> Result<Self> {
        let path = PathBuf::from("<stdin>");
        match read_limited(std::io::stdin().lock()) {
            Ok(bytes) => Ok(Self { path, text: decode_text(bytes, "the scene on standard input")? }),
            Err(source) => Err(Error::Io { doing: "read", path, source }),
        }
    }

    /// Compiles the scene that the text describes. Reads the files that it includes, and the meshes, images and tables
    /// that they name.
    ///
    /// # Errors
    /// [`Error::Scene`] with all mistakes that can be found, in the order of the file, each with its line and what to
    /// do.
    pub fn compile(&self) -> Result<Scene> {
        self.compile_with(&[])
    }

    /// Compiles the scene with some of its values replaced. Each setting is the path of a key, `=` and a TOML value,
    /// such as `film.width=320` or `object.ball.material="gold"`. A value that is not TOML is taken as a text. List
    /// entries are addressed by their `name`, or by their number, counted from 1. A path of one word sets the variable
    /// of that name.
    ///
    /// ```
    /// let text = "set.width = 8
    /// camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
    /// film = { width = \"$width\", height = 8 }
    /// light = [{ environment = { radiance = 1 } }]";
    /// let source = abbe::scene::Source { path: "scene.toml".into(), text: text.into() };
    /// let scene = source.compile_with(&["width=16".into(), "film.height=4".into()])?;
    /// assert_eq!((scene.film.width, scene.film.height), (16, 4));
    /// # Ok::<(), abbe::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`compile`](Self::compile). A mistake in a setting is reported in a file called `--set`, with one line for
    /// each setting.
    pub fn compile_with(&self, settings: &[String]) -> Result<Scene> {
        self.compile_by(LocatedBy::Line, settings, Vec::new(), true)
    }

    /// Compiles a text that a program has written, with settings as in [`compile_with`](Self::compile_with) and with
    /// rows of numbers given beside the text. Each mistake in it is reported with the path of its key, such as
    /// `object[3].shape.sphere.radius`.
    ///
    /// ```
    /// use abbe::scene::{Numbers, Rows, Source};
    /// let [points, faces] = [0, 1].map(|position| format!("{:?}", Rows::mark(position)).replace(r"\0", r"\u0000"));
    /// let text = format!("camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }}
    /// film = {{ width = 8, height = 8 }}
    /// material.white.diffuse = {{ reflectance = 0.5 }}
    /// object = [{{ shape.mesh = {{ points = {points}, faces = {faces} }}, material = \"white\" }}]");
    /// let source = Source { path: "scene.toml".into(), text };
    /// let corners = Rows { width: 3, numbers: Numbers::Real(vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]) };
    /// let face = Rows { width: 3, numbers: Numbers::Whole(vec![0, 1, 2]) };
    /// assert_eq!(source.compile_written(&[], vec![corners, face])?.objects.len(), 1);
    /// # Ok::<(), abbe::Error>(())
    /// ```
    ///
    /// # Errors
    /// As [`compile_with`](Self::compile_with).
    pub fn compile_written(&self, settings: &[String], rows: Vec<Rows>) -> Result<Scene> {
        self.compile_by(LocatedBy::Key, settings, rows, false)
    }

    fn compile_by(&self, place: LocatedBy, given: &[String], rows: Vec<Rows>, is_file: bool) -> Result<Scene> {
        let IncludedTexts { mut texts, parts, mistakes, mut files, .. } =
            IncludedTexts::of(&self.path, &self.text, is_file);
        (texts.rows, texts.located_by) = (rows, place);
        let settings = texts.add_lines(Path::new(SETTINGS), self.folder(), given);
        let refuse = |mut mistakes: Vec<Mistake>| {
            mistakes.sort_by_key(|mistake| mistake.span.start);
            mistakes.dedup_by(|a, b| (&a.span, &a.message) == (&b.span, &b.message));
            let keys = match place {
                LocatedBy::Line => HashMap::new(),
                LocatedBy::Key => keys(&texts, &parts, &mistakes),
            };
            let diagnostic = |mistake: Mistake| {
                let key = keys.get(&mistake.span).cloned();
                texts.diagnostic(mistake, key)
            };
            Error::Scene(mistakes.into_iter().map(diagnostic).collect())
        };
        if !mistakes.is_empty() {
            let others = merge_files(&texts, &parts).err().into_iter().flatten();
            return Err(refuse(mistakes.into_iter().chain(others).collect()));
        }
        let (root, unused) = merge_texts(&texts, &parts, &settings).map_err(refuse)?;
        let document = Document::new(&texts, &root);
        let mut scene = compile(&document).ok_or_else(|| refuse(document.mistakes()))?;
        scene.settings = given.to_vec();
        files.append(&mut scene.files);
        scene.files = files;
        scene.warnings.extend(unused.into_iter().map(|name| format!("variable {name} is not used")));
        Ok(scene)
    }

    /// Returns the folder that the names of its files are relative to.
    fn folder(&self) -> &Path {
        self.path.parent().unwrap_or(Path::new(""))
    }
}

/// Merges the texts of all files, and puts the values of settings and variables in their places. Also returns the names
/// of variables that are not used.
fn merge_texts<'d>(
    texts: &'d Texts,
    files: &[Range<usize>],
    settings: &[Range<usize>],
) -> std::result::Result<(DeTable<'d>, Vec<String>), Vec<Mistake>> {
    let mut root = merge_files(texts, files)?;
    let text = |span: &Range<usize>| &texts.whole[span.clone()];
    let wrong = settings.iter().filter_map(|span| set(&mut root, text(span), span.start, &SECTIONS).err());
    let wrong: Vec<Mistake> = wrong.collect();
    if !wrong.is_empty() {
        return Err(wrong);
    }
    let unused = substitute_variables(&mut root, &SECTIONS)?;
    Ok((root, unused))
}

/// Returns the paths of the keys at which mistakes in the first file stand.
fn keys(texts: &Texts, files: &[Range<usize>], mistakes: &[Mistake]) -> HashMap<Range<usize>, String> {
    let spans = mistakes.iter().map(|mistake| mistake.span.clone()).filter(|span| texts.is_in_first(span.start));
    let first = files.first().and_then(|file| parse_toml(&texts.whole[file.clone()], file.start).ok());
    first.map(|root| Document::new(texts, &root).paths(spans)).unwrap_or_default()
}

/// Reads all bytes, but stops one byte beyond the limit.
fn read_limited(reader: impl Read) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn decode_text(bytes: Vec<u8>, shown: &str) -> Result<String> {
    if bytes.len() as u64 > MAX_BYTES {
        return Error::refuse(format!("{shown} has more than {MAX_BYTES} bytes"), SCENE_HELP);
    }
    utf8(bytes, shown, SCENE_HELP).map_err(|Fault { message, help }| Error::Arguments { message, help })
}

impl Scene {
    /// Reads a scene file, and the meshes, images and tables that it names.
    ///
    /// # Errors
    /// [`Error::Scene`] with all mistakes that can be found, each with its line and what to do;
    /// [`Error::Arguments`] if there is no such file.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        Source::read(path)?.compile()
    }

    /// Parses a scene from a text in the form of a scene file. Files that it names are looked up in `folder`.
    ///
    /// # Errors
    /// As [`Scene::read`]; the file is called `scene.toml` in messages.
    pub fn parse(text: &str, folder: impl AsRef<Path>) -> Result<Self> {
        let source = Source { path: folder.as_ref().join("scene.toml"), text: text.to_owned() };
        source.compile_by(LocatedBy::Line, &[], Vec::new(), false)
    }

    /// Reads a scene from a table that a program has built. The table means what a scene file with the same keys means.
    ///
    /// # Errors
    /// As [`Scene::parse`], but each mistake is reported with the path of its key, such as
    /// `object[3].shape.sphere.radius`.
    pub fn from_table(table: &toml::Table, folder: impl AsRef<Path>) -> Result<Self> {
        let source = Source { path: folder.as_ref().join("scene.toml"), text: table.to_string() };
        source.compile_written(&[], Vec::new())
    }
}
