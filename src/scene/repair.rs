//! A section of a scene in which every mistake that was told is replaced by something right, so that the next one shows.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::suggest::meant;
use super::wording::quoted;

/// Where no text is: the place of what was put in.
pub(super) const STAND_IN: Range<usize> = usize::MAX - 1..usize::MAX;

/// Values of each type that a scene knows, tried one after the other.
const STAND_INS: [&str; 8] = [
    "1",
    "'x'",
    "[1, 1, 1]",
    "[1, 1]",
    "[1, 1, 1, 1]",
    "[]",
    "{ scale = 1 }",
    "{ sphere = { center = [0, 0, 0], radius = 1 } }",
];

/// A section, more and more of which is replaced.
pub(super) struct Repair<'t> {
    pub(super) value: Spanned<DeValue<'t>>,
    /// Where the last stand-in is, and which of them it is.
    last: (Vec<Step>, usize),
    /// The tables that lack a key because nothing could stand in for its value.
    lacking: Vec<Range<usize>>,
    /// The tables with an unknown key, and which key that was taken for.
    unknown: Vec<(Range<usize>, Option<String>)>,
}

#[derive(Clone)]
enum Step {
    Key(String),
    Index(usize),
}

impl<'t> Repair<'t> {
    pub(super) fn of(value: Spanned<DeValue<'t>>) -> Self {
        Self { value, last: (Vec::new(), 0), lacking: Vec::new(), unknown: Vec::new() }
    }

    /// Whether an error only follows from a mistake that was told: a key is missing that was misspelt, or whose value was
    /// taken out.
    pub(super) fn follows(&self, span: &Range<usize>, said: &str) -> bool {
        let misspelt = |meant: &Option<String>| match said.strip_prefix("missing field ") {
            Some(key) => meant.as_ref().is_none_or(|meant| key.trim_matches('`') == meant),
            None => false,
        };
        // Some checks tell of a table by the one around it.
        if said.contains(" needs ") && !self.unknown.is_empty() {
            return true;
        }
        self.lacking.contains(span) || self.unknown.iter().any(|(table, meant)| table == span && misspelt(meant))
    }

    /// Replaces what the reader of sections refused; says whether that was possible.
    pub(super) fn mend(&mut self, span: &Range<usize>, said: &str) -> bool {
        if *span == STAND_IN {
            return self.put(self.last.1 + 1);
        }
        let mut path = Vec::new();
        let Some(is_key) = find(&self.value, span, &mut path) else { return false };
        if said.starts_with("missing field ") {
            path.extend(quoted(said).first().map(|key| Step::Key((*key).to_owned())));
        } else if said.starts_with("unknown field ") {
            let words = quoted(said);
            let meant = words.split_first().and_then(|(word, known)| meant("", word, known));
            let owner = self.take(&path);
            self.unknown.extend(owner.map(|owner| (owner, meant.map(str::to_owned))));
            return true;
        } else if said.starts_with("unknown variant ") && is_key {
            path.pop();
        } else if said.starts_with("unknown variant ") {
            return self.leave_out(&path);
        } else if let Some(Step::Index(_)) = path.last() {
            // What is wrong with one entry of a list is mostly wrong with all.
            path.pop();
        }
        self.last.0 = path;
        self.put(0)
    }

    /// Replaces a value, or takes out a key, of which a mistake was told; says whether that was possible.
    pub(super) fn clear(&mut self, span: &Range<usize>) -> bool {
        let mut path = Vec::new();
        match find(&self.value, span, &mut path) {
            Some(true) => self.leave_out(&path),
            Some(false) => {
                let is_table = at(&mut self.value, &path).is_some_and(|value| value.get_ref().is_table());
                if !is_table && matches!(path.last(), Some(Step::Index(_))) {
                    path.pop();
                }
                self.last.0 = path;
                self.put(0)
            }
            None => true,
        }
    }

    /// Puts a stand-in where the last one was; once there is none left, takes the key out.
    fn put(&mut self, number: usize) -> bool {
        self.last.1 = number;
        let path = self.last.0.clone();
        let Some((end, owner)) = path.split_last() else { return false };
        let Some(value) = STAND_INS.get(number).and_then(|text| DeValue::parse(text).ok()) else {
            return self.leave_out(&path);
        };
        let (value, owner) = (unplaced(value), at(&mut self.value, owner));
        match (end, owner.map(Spanned::get_mut)) {
            (Step::Key(key), Some(DeValue::Table(table))) => {
                table.insert(Spanned::new(STAND_IN, key.clone().into()), value);
                true
            }
            (Step::Index(index), Some(DeValue::Array(entries))) => {
                entries.get_mut(*index).map(|entry| *entry = value).is_some()
            }
            _ => false,
        }
    }

    fn leave_out(&mut self, path: &[Step]) -> bool {
        let owner = self.take(path);
        let taken = owner.is_some();
        self.lacking.extend(owner);
        taken
    }

    /// Takes a key out of its table; where that table stands.
    fn take(&mut self, path: &[Step]) -> Option<Range<usize>> {
        let (Step::Key(key), owner) = path.split_last()? else { return None };
        let owner = at(&mut self.value, owner)?;
        let span = owner.span();
        let DeValue::Table(table) = owner.get_mut() else { return None };
        table.remove(key.as_str());
        Some(span)
    }
}

/// The way to the key or value that stands at a place, and whether it is a key.
fn find(value: &Spanned<DeValue>, span: &Range<usize>, path: &mut Vec<Step>) -> Option<bool> {
    if value.span() == *span {
        return Some(false);
    }
    let mut below = |step: Step, is_key: bool, value: &Spanned<DeValue>| {
        path.push(step);
        let found = if is_key { Some(true) } else { find(value, span, path) };
        if found.is_none() {
            path.pop();
        }
        found
    };
    match value.get_ref() {
        DeValue::Table(table) => table
            .iter()
            .find_map(|(key, value)| below(Step::Key(key.get_ref().to_string()), key.span() == *span, value)),
        DeValue::Array(entries) => {
            entries.iter().enumerate().find_map(|(index, value)| below(Step::Index(index), false, value))
        }
        _ => None,
    }
}

fn at<'v, 't>(value: &'v mut Spanned<DeValue<'t>>, path: &[Step]) -> Option<&'v mut Spanned<DeValue<'t>>> {
    path.iter().try_fold(value, |value, step| match (step, value.get_mut()) {
        (Step::Key(key), DeValue::Table(table)) => table.get_mut(key.as_str()),
        (Step::Index(index), DeValue::Array(entries)) => entries.get_mut(*index),
        _ => None,
    })
}

/// A value whose parts all stand where no text is.
fn unplaced(value: Spanned<DeValue<'static>>) -> Spanned<DeValue<'static>> {
    let inner = match value.into_inner() {
        DeValue::Array(entries) => DeValue::Array(entries.into_iter().map(unplaced).collect()),
        DeValue::Table(table) => {
            let keys =
                table.into_iter().map(|(key, value)| (Spanned::new(STAND_IN, key.into_inner()), unplaced(value)));
            DeValue::Table(keys.collect::<DeTable>())
        }
        other => other,
    };
    Spanned::new(STAND_IN, inner)
}
