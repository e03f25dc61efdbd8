//! The document that is read, and the mistakes in it.

use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::Range;

use toml::de::{DeTable, DeValue};

use super::mistake::Mistake;
use super::texts::Texts;
use super::tree::Node;

/// The texts of a scene, their content as TOML, and the mistakes found so far.
pub(in crate::scene) struct Document<'d> {
    pub(in crate::scene) texts: &'d Texts,
    pub(in crate::scene) root: &'d DeTable<'d>,
    mistakes: RefCell<Vec<Mistake>>,
}

impl<'d> Document<'d> {
    pub(in crate::scene) fn new(texts: &'d Texts, root: &'d DeTable<'d>) -> Self {
        Self { texts, root, mistakes: RefCell::default() }
    }

    /// Records a mistake. Reading continues, so that all mistakes are reported together.
    pub(in crate::scene) fn report(&self, span: Range<usize>, message: impl Into<String>, help: Option<String>) {
        // Names in a scene may contain anything, even a line break.
        let one_line = |text: String| text.replace(char::is_control, " ");
        let mistake = Mistake { span, message: one_line(message.into()), help: help.map(one_line) };
        self.mistakes.borrow_mut().push(mistake);
    }

    /// Returns the number of mistakes so far.
    pub(in crate::scene) fn reported(&self) -> usize {
        self.mistakes.borrow().len()
    }

    /// Returns the place of the last mistake.
    pub(super) fn last(&self) -> Option<Range<usize>> {
        self.mistakes.borrow().last().map(|mistake| mistake.span.clone())
    }

    /// Returns all mistakes, in the order in which they were found.
    pub(in crate::scene) fn mistakes(&self) -> Vec<Mistake> {
        self.mistakes.borrow().clone()
    }

    /// Returns the paths of the keys and values at these places, as in `object[3].shape.sphere.radius`; empty where
    /// there are none.
    pub(in crate::scene) fn paths(&self, places: impl Iterator<Item = Range<usize>>) -> HashMap<Range<usize>, String> {
        let mut paths: HashMap<_, _> = places.map(|span| (span, String::new())).collect();
        if !paths.is_empty() {
            collect_table_paths(self.root, "", &mut paths);
        }
        paths
    }
}

fn collect_table_paths(table: &DeTable, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    for (key, value) in table {
        let dot = if path.is_empty() { "" } else { "." };
        let path = format!("{path}{dot}{}", key.get_ref());
        record_path(key.span(), &path, paths);
        collect_paths(value, &path, paths);
    }
}

fn collect_paths(value: &Node, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    record_path(value.span(), path, paths);
    match value.get_ref() {
        DeValue::Table(table) => collect_table_paths(table, path, paths),
        DeValue::Array(entries) => {
            entries
                .iter()
                .enumerate()
                .for_each(|(number, entry)| collect_paths(entry, &format!("{path}[{number}]"), paths));
        }
        _ => {}
    }
}

/// Records the first path to a place that is looked for.
fn record_path(span: Range<usize>, path: &str, paths: &mut HashMap<Range<usize>, String>) {
    paths.entry(span).and_modify(|found| found.push_str(if found.is_empty() { path } else { "" }));
}
