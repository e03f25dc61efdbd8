//! The document that is read, and the mistakes in it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::mistake::Mistake;
use super::texts::Texts;
use super::tree::Node;

/// The texts of a scene, what they say as TOML, and what is wrong with that so far.
pub(in crate::scene) struct Document<'d> {
    pub(in crate::scene) texts: &'d Texts,
    pub(in crate::scene) root: &'d DeTable<'d>,
    mistakes: RefCell<Vec<Mistake>>,
}

impl<'d> Document<'d> {
    pub(in crate::scene) fn new(texts: &'d Texts, root: &'d DeTable<'d>) -> Self {
        Self { texts, root, mistakes: RefCell::default() }
    }

    /// Keeps a mistake. Reading continues, so that all are reported together.
    pub(in crate::scene) fn tell(&self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        // Names in a scene may hold anything, even the end of a line.
        let one_line = |text: String| text.replace(char::is_control, " ");
        let mistake = Mistake { span, message: one_line(message.into()), help: help.map(one_line) };
        self.mistakes.borrow_mut().push(mistake);
    }

    /// How many mistakes there are so far.
    pub(in crate::scene) fn told(&self) -> usize {
        self.mistakes.borrow().len()
    }

    /// Where the last mistake stands.
    pub(super) fn last(&self) -> Option<Range<usize>> {
        self.mistakes.borrow().last().map(|mistake| mistake.span.clone())
    }

    /// All mistakes, in the order in which they were found.
    pub(in crate::scene) fn mistakes(&self) -> Vec<Mistake> {
        self.mistakes.borrow().clone()
    }

    /// The keys and positions that lead to keys and values, as in `object[3].shape.sphere.radius`; empty where there
    /// are none.
    pub(in crate::scene) fn paths(&self, places: impl Iterator<Item = Range<usize>>) -> HashMap<Range<usize>, String> {
        let mut paths: HashMap<_, _> = places.map(|span| (span, String::new())).collect();
        if !paths.is_empty() {
            look_into(self.root, "", &mut paths);
        }
        paths
    }
}

fn look_into(table: &DeTable, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    for (key, value) in table {
        let dot = if path.is_empty() { "" } else { "." };
        let path = format!("{path}{dot}{}", key.get_ref());
        note(key.span(), &path, paths);
        look_at(value, &path, paths);
    }
}

fn look_at(value: &Node, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    note(value.span(), path, paths);
    match value.get_ref() {
        DeValue::Table(table) => look_into(table, path, paths),
        DeValue::Array(entries) => {
            entries.iter().enumerate().for_each(|(number, entry)| look_at(entry, &format!("{path}[{number}]"), paths));
        }
        _ => {}
    }
}

/// Keeps the first path of a place that is asked for.
fn note(span: Range<usize>, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    paths.entry(span).and_modify(|found| found.push_str(if found.is_empty() { path } else { "" }));
}
