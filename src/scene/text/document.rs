//! The document that is read, and the mistakes that were found in it.

use std::cell::RefCell;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// What is wrong with a scene, and where.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Mistake {
    /// The bytes that are wrong.
    pub(in crate::scene) span: Range<usize>,
    pub(in crate::scene) message: String,
    /// What to do.
    pub(in crate::scene) help: Option<String>,
}

/// A text, what it says as TOML, and what is wrong with that so far.
pub(in crate::scene) struct Document<'d> {
    pub(in crate::scene) text: &'d str,
    pub(in crate::scene) root: &'d DeTable<'d>,
    mistakes: RefCell<Vec<Mistake>>,
}

impl<'d> Document<'d> {
    pub(in crate::scene) fn new(text: &'d str, root: &'d DeTable<'d>) -> Self {
        Self { text, root, mistakes: RefCell::default() }
    }

    /// Keeps a mistake. Reading goes on, so that all are told at once.
    pub(in crate::scene) fn tell(&self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        // Names in a scene may hold anything, even the end of a line.
        let one_line = |text: String| text.replace(char::is_control, " ");
        let mistake = Mistake { span, message: one_line(message.into()), help: help.map(one_line) };
        self.mistakes.borrow_mut().push(mistake);
    }

    /// How many mistakes were told.
    pub(in crate::scene) fn told(&self) -> usize {
        self.mistakes.borrow().len()
    }

    /// Where the last mistake stands.
    pub(super) fn last(&self) -> Option<Range<usize>> {
        self.mistakes.borrow().last().map(|mistake| mistake.span.clone())
    }

    /// All mistakes, in the order of the file, none twice.
    pub(in crate::scene) fn mistakes(&self) -> Vec<Mistake> {
        let mut mistakes = self.mistakes.borrow().clone();
        mistakes.sort_by_key(|mistake| mistake.span.start);
        mistakes.dedup_by(|a, b| (&a.span, &a.message) == (&b.span, &b.message));
        mistakes
    }

    /// The keys and positions that lead to a key or a value, as in `object[3].shape.sphere.radius`.
    pub(in crate::scene) fn path(&self, span: &Range<usize>) -> String {
        let mut path = String::new();
        find(self.root, span, &mut path);
        path
    }
}

/// Whether a table holds the key or the value at a place; the way to it is added to `path`.
fn find(table: &DeTable, span: &Range<usize>, path: &mut String) -> bool {
    let before = path.len();
    table.iter().any(|(key, value)| {
        path.push_str(if before == 0 { "" } else { "." });
        path.push_str(key.get_ref());
        let found = key.span() == *span || find_in(value, span, path);
        if !found {
            path.truncate(before);
        }
        found
    })
}

fn find_in(value: &Spanned<DeValue>, span: &Range<usize>, path: &mut String) -> bool {
    let before = path.len();
    match value.get_ref() {
        _ if value.span() == *span => true,
        DeValue::Table(table) => find(table, span, path),
        DeValue::Array(entries) => entries.iter().enumerate().any(|(number, entry)| {
            path.push_str(&format!("[{number}]"));
            let found = find_in(entry, span, path);
            if !found {
                path.truncate(before);
            }
            found
        }),
        _ => false,
    }
}
