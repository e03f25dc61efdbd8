//! The texts of a scene, joined into one.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use super::mistake::Mistake;
use super::rows::Rows;
use crate::error::{Diagnostic, Lines};

/// The texts that a scene is made of: its file, the files that it includes and the settings that replace its values.
/// They follow one another, so that a place in any of them is a range of bytes of the whole.
#[derive(Default)]
pub(in crate::scene) struct Texts {
    /// All texts, one after another.
    pub(in crate::scene) whole: String,
    parts: Vec<TextPart>,
    /// How messages name places.
    pub(in crate::scene) located_by: LocatedBy,
    /// Rows of numbers that a program has given beside the texts.
    pub(in crate::scene) rows: Vec<Rows>,
}

/// How messages name a place.
#[derive(Clone, Copy, Default)]
pub(in crate::scene) enum LocatedBy {
    #[default]
    Line,
    /// The path of its key, in a text that a program has written.
    Key,
}

struct TextPart {
    /// Its name in messages.
    path: PathBuf,
    /// The folder that the names of its files are relative to.
    folder: PathBuf,
    span: Range<usize>,
    /// A copy of the text that all its mistakes share.
    own_text: OnceLock<Arc<str>>,
}

impl Texts {
    /// Adds a text, and returns its place.
    pub(in crate::scene) fn add(&mut self, path: &Path, folder: &Path, text: &str) -> Range<usize> {
        if !self.parts.is_empty() {
            // TOML does not allow this character, so the end of a text is not the start of the next one.
            self.whole.push('\0');
        }
        let start = self.whole.len();
        self.whole.push_str(text);
        let span = start..self.whole.len();
        self.parts.push(TextPart {
            path: path.to_owned(),
            folder: folder.to_owned(),
            span: span.clone(),
            own_text: OnceLock::new(),
        });
        span
    }

    /// Adds lines, if there are any, as one text, and returns the place of each.
    pub(in crate::scene) fn add_lines(&mut self, path: &Path, folder: &Path, lines: &[String]) -> Vec<Range<usize>> {
        if lines.is_empty() {
            return Vec::new();
        }
        let mut next = self.add(path, folder, &lines.join("\n")).start;
        let place = |line: &String| {
            let start = next;
            next += line.len() + 1;
            start..start + line.len()
        };
        lines.iter().map(place).collect()
    }

    /// Returns whether a place is in the first text.
    pub(in crate::scene) fn is_in_first(&self, place: usize) -> bool {
        self.parts.first().is_some_and(|part| place <= part.span.end)
    }

    /// Returns the folder that the names of files at a place are relative to.
    pub(in crate::scene) fn folder(&self, place: usize) -> &Path {
        self.part(place).map_or(Path::new(""), |part| &part.folder)
    }

    fn part(&self, place: usize) -> Option<&TextPart> {
        self.parts.iter().rfind(|part| part.span.start <= place)
    }

    /// Returns a place as people name it, such as `at scene.toml:3:7`. A text that a program has written is not a file.
    pub(in crate::scene) fn place_phrase(&self, span: Range<usize>) -> String {
        match self.located_by {
            LocatedBy::Key if self.is_in_first(span.start) => "in the scene itself".into(),
            _ => format!("at {}", self.place_name(span)),
        }
    }

    /// Returns a place as people name it, such as `scene.toml:3:7`.
    pub(in crate::scene) fn place_name(&self, span: Range<usize>) -> String {
        self.place_name_by(&mut Lines::default(), span)
    }

    fn place_name_by(&self, lines: &mut Lines, span: Range<usize>) -> String {
        let found = self.diagnostic(Mistake { span, message: String::new(), help: None }, None);
        let (line, column) = lines.place_of(&found);
        format!("{}:{line}:{column}", found.file.display())
    }

    /// Returns the names of many places, in time that grows with their number plus the length of the text.
    pub(in crate::scene) fn place_names(
        &self,
        places: impl Iterator<Item = Range<usize>>,
    ) -> HashMap<Range<usize>, String> {
        let mut places: Vec<_> = places.collect();
        places.sort_unstable_by_key(|span| (span.start, span.end));
        let mut lines = Lines::default();
        places.into_iter().map(|span| (span.clone(), self.place_name_by(&mut lines, span))).collect()
    }

    /// Returns a mistake with its file.
    pub(in crate::scene) fn diagnostic(&self, mistake: Mistake, key: Option<String>) -> Diagnostic {
        let Mistake { span, message, help } = mistake;
        let Some(part) = self.part(span.start) else {
            return Diagnostic { file: PathBuf::new(), text: "".into(), span: 0..0, key, message, help };
        };
        let local = |at: usize| at.min(part.span.end) - part.span.start;
        let text = part.own_text.get_or_init(|| self.whole[part.span.clone()].into());
        let span = local(span.start)..local(span.end);
        Diagnostic { file: part.path.clone(), text: text.clone(), span, key, message, help }
    }
}
