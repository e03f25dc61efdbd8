//! A table of a scene's text, read key by key.

use std::ops::Range;

use toml::de::DeTable;

use super::aliases::{outside_of_material, value_help};
use super::document::Document;
use super::include::INCLUDE;
use super::suggest::{TABLE, meant_name, suggested_key, suggestion};
use super::value::Value;
use crate::error::nearest;

/// A table that is being read. It may have exactly the keys that its reader requests.
pub(in crate::scene) struct Fields<'d> {
    document: &'d Document<'d>,
    table: &'d DeTable<'d>,
    span: Range<usize>,
    known: Vec<&'static str>,
    /// Known keys that make no sense in this place, and are not suggested.
    excluded_hints: Vec<&'static str>,
    /// Required keys that are missing, and what to do.
    missing: Vec<(&'static str, Option<String>)>,
    /// Keys that have been reported, but not as unknown ones.
    reported: Vec<&'static str>,
}

impl<'d> Fields<'d> {
    /// Reads a table. Returns none unless it has all the keys that it needs and no others. `read` must request every
    /// possible key before it gives up over one.
    pub(in crate::scene) fn read<T>(value: Value<'d>, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let Some(table) = value.node().as_table() else { return value.expected(TABLE) };
        Self::of(value.document, table, value.span(), read)
    }

    /// Reads a document.
    pub(in crate::scene) fn of_document<T>(
        document: &'d Document<'d>,
        read: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        Self::of(document, document.root, 0..0, read)
    }

    fn of<T>(
        document: &'d Document<'d>,
        table: &'d DeTable<'d>,
        span: Range<usize>,
        read: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let (known, excluded_hints, missing, reported) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut fields = Self { document, table, span, known, excluded_hints, missing, reported };
        let read = read(&mut fields);
        let is_valid = fields.check_keys();
        read.filter(|_| is_valid)
    }

    /// Returns whether the table has only keys that were requested, and all that it needs. Reports the others.
    fn check_keys(&self) -> bool {
        let (unknown, known) = (self.unknown(), self.hints());
        for (span, word) in &unknown {
            let (message, help) = match *word {
                INCLUDE => (
                    "`include` is not a key of a section".into(),
                    "write it before the first section, at the top of the file".into(),
                ),
                word => {
                    let value = self.table.get(word);
                    let known_by_value = value.and_then(|node| value_help(word, node.get_ref(), &known));
                    let help = known_by_value.unwrap_or_else(|| suggested_key(word, &known, self.table));
                    (format!("unknown key `{word}`"), help)
                }
            };
            self.document.report(span.clone(), message, Some(help));
        }
        // A key that makes no sense may stand for the one that is missing.
        let is_obscure =
            !self.reported.is_empty() || unknown.iter().any(|(_, word)| meant_name(word, word, &known).is_none());
        for (key, help) in self.missing.iter().filter(|(key, _)| !is_obscure && !self.is_misspelled(key)) {
            self.document.report(self.span.clone(), format!("`{key}` is missing"), help.clone());
        }
        unknown.is_empty() && self.missing.is_empty() && self.reported.is_empty()
    }

    /// Returns whether an unknown key is most likely a misspelling of this one, which is then not missing.
    pub(in crate::scene) fn is_misspelled(&self, key: &str) -> bool {
        let known = self.hints();
        self.unknown().iter().any(|(_, word)| meant_name(word, word, &known) == Some(key))
    }

    /// Returns the keys that may be suggested in place of another one.
    fn hints(&self) -> Vec<&'static str> {
        self.known.iter().copied().filter(|key| !self.excluded_hints.contains(key)).collect()
    }

    fn unknown(&self) -> Vec<(Range<usize>, &'d str)> {
        let keys = self.table.keys().map(|key| (key.span(), key.get_ref().as_ref()));
        keys.filter(|(_, key)| !self.known.contains(key) && !self.reported.contains(key)).collect()
    }

    /// Returns whether there are keys that nothing has requested so far.
    pub(in crate::scene) fn has_unknown(&self) -> bool {
        !self.reported.is_empty() || !self.unknown().is_empty()
    }

    /// Returns the value of an optional key.
    pub(in crate::scene) fn get(&mut self, key: &'static str) -> Option<Value<'d>> {
        if !self.known.contains(&key) {
            self.known.push(key);
        }
        self.table.get_key_value(key).map(|(key, node)| Value::new(self.document, key, node))
    }

    /// Reads an optional key. Returns none if it is wrong.
    pub(in crate::scene) fn maybe<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(Value<'d>) -> Option<T>,
    ) -> Option<Option<T>> {
        self.get(key).map_or(Some(None), |value| read(value).map(Some))
    }

    /// Reads an optional key with a default. Returns none if it is wrong.
    pub(in crate::scene) fn or<T>(
        &mut self,
        key: &'static str,
        default: T,
        read: impl FnOnce(Value<'d>) -> Option<T>,
    ) -> Option<T> {
        self.get(key).map_or(Some(default), read)
    }

    /// Reads a required key.
    pub(in crate::scene) fn need<T>(
        &mut self,
        key: &'static str,
        read: impl FnOnce(Value<'d>) -> Option<T>,
    ) -> Option<T> {
        match self.get(key) {
            Some(value) => read(value),
            None => self.report_missing(key, None),
        }
    }

    /// Reports that a key is missing, unless it is misspelled. For keys that only some tables of a kind need.
    pub(in crate::scene) fn report_missing<T>(&mut self, key: &'static str, help: Option<&str>) -> Option<T> {
        self.missing.push((key, help.map(str::to_owned)));
        None
    }

    /// Reports that the whole table is wrong.
    pub(in crate::scene) fn refuse<T>(&self, message: impl Into<String>, help: Option<&str>) -> Option<T> {
        self.document.report(self.span.clone(), message, help.map(str::to_owned));
        None
    }

    /// Excludes keys that make no sense in this place from suggestions.
    pub(in crate::scene) fn exclude_hints(&mut self, keys: impl Iterator<Item = &'static str>) {
        self.excluded_hints.extend(keys);
    }

    /// Reports that a key, if it is there, belongs elsewhere.
    pub(in crate::scene) fn refuse_misplaced(&mut self, key: &'static str, message: impl Into<String>, help: String) {
        if let Some((found, _)) = self.table.get_key_value(key) {
            self.document.report(found.span(), message, Some(help));
            self.reported.push(key);
        }
    }
}

/// A table with a single key, which is its kind.
pub(in crate::scene) struct Choice<R: 'static> {
    /// Its name with an article, such as "a shape".
    pub(in crate::scene) name: &'static str,
    /// Its name, such as "shape".
    pub(in crate::scene) word: &'static str,
    pub(in crate::scene) example: &'static str,
    /// What to do about a second kind.
    pub(in crate::scene) second_kind_help: &'static str,
    /// Keys that belong beside the table and not into it.
    pub(in crate::scene) outside_keys: &'static [&'static str],
    /// The kinds, and their readers.
    pub(in crate::scene) kinds: &'static [(&'static str, R)],
}

impl<R: Copy> Choice<R> {
    /// Returns the reader of a value's kind, and the value of that kind.
    pub(in crate::scene) fn of<'d>(&self, value: Value<'d>) -> Option<(R, Value<'d>)> {
        let kind = self.kind(value)?;
        Some((self.reader(kind)?, kind))
    }

    /// Returns the reader of a kind, if it is known.
    pub(in crate::scene) fn reader(&self, kind: Value) -> Option<R> {
        let word = kind.key();
        let known = self.kinds.iter().find(|(known, _)| *known == word).map(|(_, reader)| *reader);
        known.or_else(|| {
            let known: Vec<&str> = self.kinds.iter().map(|kind| kind.0).collect();
            kind.refuse_key(format!("unknown {} `{word}`", self.word), Some(suggestion(word, word, &known)))
        })
    }

    pub(in crate::scene) fn knows(&self, word: &str) -> bool {
        self.kinds.iter().any(|(known, _)| *known == word)
    }

    /// Returns the kind that a key such as `type` names.
    fn tagged_kind<'d>(&self, tag: Value<'d>) -> Option<&'d str> {
        let named = || tag.node().as_str().filter(|word| self.knows(word));
        matches!(tag.key(), "type" | "kind").then(named).flatten()
    }

    /// Returns whether a key belongs beside the table, and reports it if so.
    fn report_if_beside(&self, stray: Value) -> bool {
        let is_beside = self.outside_keys.contains(&stray.key());
        if is_beside {
            let help = format!("write it beside `{0}`: above a line [object.{0}], or outside its braces", self.word);
            stray.refuse_key::<()>(format!("`{}` is not part of {}", stray.key(), self.name), Some(help));
        }
        is_beside
    }

    /// Returns whether a key beside a kind resembles no kind, and reports it if so: it may belong inside the kind.
    fn report_if_part(&self, kind: &str, stray: Value) -> bool {
        let word = stray.key();
        let is_part = !self.knows(word) && nearest(word, self.kinds.iter().map(|kind| kind.0)).is_none();
        if is_part {
            let outside = outside_of_material(kind, word).filter(|_| self.knows("mask")).map(str::to_owned);
            let help = outside
                .unwrap_or_else(|| format!("keys of `{kind}` go inside its braces: {kind} = {{ .., {word} = .. }}"));
            stray.refuse_key::<()>(format!("unknown key `{word}` beside `{kind}`"), Some(help));
        }
        is_part
    }

    /// Returns the value of the first key of a table, known or not. Reports a second one.
    pub(in crate::scene) fn kind<'d>(&self, value: Value<'d>) -> Option<Value<'d>> {
        let example = || format!("such as {}", self.example);
        let Some(table) = value.node().as_table() else {
            return value.advise(format!("{} is a table with one kind", self.name), example());
        };
        let mut kinds: Vec<_> = table.iter().map(|(key, node)| Value::new(value.document, key, node)).collect();
        kinds.sort_by_key(|kind| kind.key_span().start);
        if let Some((tag, kind)) = kinds.iter().find_map(|tag| Some((tag, self.tagged_kind(*tag)?))) {
            let help = format!("write {kind} = {{ .. }}, with its keys inside the braces");
            return tag.refuse_key(format!("the kind of {} is itself a key", self.name), Some(help));
        }
        kinds.retain(|kind| !self.report_if_beside(*kind));
        if let [kind] = kinds.iter().filter(|kind| self.knows(kind.key())).copied().collect::<Vec<_>>()[..] {
            kinds.retain(|other| !self.report_if_part(kind.key(), *other));
        }
        if let [_, second, ..] = kinds.as_slice() {
            second.refuse_key::<()>(format!("{} has exactly one kind", self.name), Some(self.second_kind_help.into()));
        }
        match kinds.first() {
            None => value.advise(format!("{} needs a kind", self.name), example()),
            Some(kind) => Some(*kind),
        }
    }
}
