//! Files that a scene includes. Their content counts as if it were written in the scene.

use std::ops::Range;
use std::path::{Path, PathBuf};

use toml::de::{DeTable, DeValue};

use super::mistake::Mistake;
use super::named_file::{Fault, FileKind, read_named};
use super::texts::Texts;
use super::tree::{Node, key_text, parse_toml};
use super::utf8::utf8;
use crate::scene::foreign::foreign;

/// The key that lists such files.
pub(in crate::scene) const INCLUDE: &str = "include";
/// Maximum number of bytes of a scene, and of a file that it includes. A device may never end.
pub(in crate::scene) const MAX_BYTES: u64 = 1 << 30;
const SCENE_FILE: FileKind =
    FileKind { empty_name_message: "a file to include needs a name", max_bytes: MAX_BYTES, endings: &["toml"] };
/// Maximum depth of files within one another: far less than would exhaust the stack.
const MAX_DEPTH: usize = 64;

/// The texts of a scene, and the mistakes found in them so far.
#[derive(Default)]
pub(in crate::scene) struct IncludedTexts {
    pub(in crate::scene) texts: Texts,
    /// The place of each file in the texts.
    pub(in crate::scene) parts: Vec<Range<usize>>,
    pub(in crate::scene) mistakes: Vec<Mistake>,
    /// All files, each under one name only.
    pub(in crate::scene) files: Vec<PathBuf>,
    /// The files that are being read, the outermost first.
    open_files: Vec<PathBuf>,
}

impl IncludedTexts {
    /// Collects a text and those of all files that it includes, each once, in the order in which they are first named.
    /// A text that is not a file still has a path, which the names of files are relative to.
    pub(in crate::scene) fn of(path: &Path, text: &str, is_file: bool) -> Self {
        let file: Vec<PathBuf> = is_file.then(|| canonical(path)).into_iter().collect();
        let mut found = Self { files: file.clone(), open_files: file, ..Self::default() };
        found.add(path, text);
        found
    }

    fn add(&mut self, path: &Path, text: &str) {
        let folder = path.parent().unwrap_or(Path::new(""));
        let span = self.texts.add(path, folder, text);
        self.parts.push(span.clone());
        // Most texts include nothing, and are parsed only once. A key may be written with escapes.
        if text.contains(INCLUDE) || text.contains('\\') {
            match parse_toml(text, span.start) {
                Ok(table) => table.get(INCLUDE).into_iter().for_each(|names| self.add_all(names, folder)),
                Err(mistake) => self.mistakes.push(mistake),
            }
        }
    }

    /// Adds the files of a list of names.
    fn add_all(&mut self, names: &Node, folder: &Path) {
        let refuse = |span| {
            let help = Some("such as include = [\"materials.toml\"]".into());
            Mistake { span, message: "`include` is a list of files".into(), help }
        };
        let Some(entries) = names.get_ref().as_array() else { return self.mistakes.push(refuse(names.span())) };
        for entry in entries.iter() {
            let added = match entry.get_ref().as_str() {
                None => Err(refuse(entry.span())),
                Some(name) => self.add_named(name, folder).map_err(|Fault { message, help }| Mistake {
                    span: entry.span(),
                    message,
                    help,
                }),
            };
            self.mistakes.extend(added.err());
        }
    }

    fn add_named(&mut self, name: &str, folder: &Path) -> Result<(), Fault> {
        let path = folder.join(name);
        let file = canonical(&path);
        if self.open_files.contains(&file) {
            let message = format!("{name} includes itself via this file");
            return Err(Fault::new(message, "put what both need in a file of its own"));
        }
        if self.files.contains(&file) {
            return Ok(());
        }
        if self.open_files.len() >= MAX_DEPTH {
            return Err(Fault { message: format!("included files are nested more than {MAX_DEPTH} deep"), help: None });
        }
        let text = utf8(read_named(folder, name, &SCENE_FILE)?, name, "an included file is TOML, like a scene");
        let is_toml = || text.as_ref().is_ok_and(|text| parse_toml(text, 0).is_ok());
        if let Some((kind, help)) = foreign(&path, name).filter(|_| !is_toml()) {
            return Err(Fault::new(format!("{name} is {kind}, not a part of a scene in TOML"), help));
        }
        let text = text?;
        self.files.push(file.clone());
        self.open_files.push(file);
        self.add(&path, &text);
        self.open_files.pop();
        Ok(())
    }
}

/// Returns the canonical name of a file, without links.
fn canonical(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or(path.to_owned())
}

/// Merges the content of all files: joins their lists, and combines the keys of their tables.
pub(in crate::scene) fn merge_files<'d>(texts: &'d Texts, files: &[Range<usize>]) -> Result<DeTable<'d>, Vec<Mistake>> {
    let (mut whole, mut mistakes) = (DeTable::new(), Vec::new());
    for part in files {
        match parse_toml(&texts.whole[part.clone()], part.start) {
            Ok(mut table) => {
                table.remove(INCLUDE);
                merge(&mut whole, table, texts, &mut mistakes);
            }
            Err(mistake) => mistakes.push(mistake),
        }
    }
    if mistakes.is_empty() { Ok(whole) } else { Err(mistakes) }
}

fn merge<'d>(whole: &mut DeTable<'d>, table: DeTable<'d>, texts: &Texts, mistakes: &mut Vec<Mistake>) {
    for (section, value) in table {
        let name: &str = key_text(&section);
        let Some((first, found)) = whole.remove_entry(name) else {
            whole.insert(section, value);
            continue;
        };
        let span = found.span();
        let both = match (found.into_inner(), value.into_inner()) {
            (DeValue::Array(entries), DeValue::Array(more)) => {
                DeValue::Array(entries.into_iter().chain(more).collect())
            }
            (DeValue::Table(mut keys), DeValue::Table(more)) => {
                for (key, value) in more {
                    match keys.get_key_value(key_text(&key)) {
                        Some((known, _)) => {
                            let message = format!("`{name}.{}` is given twice", key_text(&key));
                            let help =
                                format!("it is also given {}: keep one of them", texts.place_phrase(known.span()));
                            mistakes.push(Mistake { span: key.span(), message, help: Some(help) });
                        }
                        None => drop(keys.insert(key, value)),
                    }
                }
                DeValue::Table(keys)
            }
            (found, _) => {
                let message = format!("`{name}` is given twice");
                let help = format!("it is also given {}, in another form", texts.place_phrase(first.span()));
                mistakes.push(Mistake { span: section.span(), message, help: Some(help) });
                found
            }
        };
        whole.insert(first, toml::Spanned::new(span, both));
    }
}
