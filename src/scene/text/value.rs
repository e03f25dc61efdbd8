//! Values of a scene's text, read as the type that is expected. A value of another type is a mistake.

use std::ops::{Bound, Range, RangeBounds, RangeInclusive};
use std::path::{Path, PathBuf};

use toml::de::{DeInteger, DeValue};

use super::document::Document;
use super::named_file::{Fault, FileKind, missing, read_named};
use super::rows::Rows;
use super::suggest::{remedy, suggestion, with_decimal_points};
use super::tree::{Key, Node};

/// A value, with its place in the text.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Value<'d> {
    pub(super) document: &'d Document<'d>,
    /// The key whose value it is, or whose list it is an entry of.
    key: &'d Key<'d>,
    is_entry: bool,
    node: &'d Node<'d>,
    /// Its name in messages if it should be a list of numbers, and how to write it.
    list: Option<(&'static str, &'static str)>,
}

impl<'d> Value<'d> {
    pub(super) fn new(document: &'d Document<'d>, key: &'d Key<'d>, node: &'d Node<'d>) -> Self {
        Self { document, key, is_entry: false, node, list: None }
    }

    /// Returns the key whose value it is, or whose list it is an entry of.
    pub(in crate::scene) fn key(self) -> &'d str {
        self.key.get_ref()
    }

    pub(super) fn key_span(self) -> Range<usize> {
        self.key.span()
    }

    pub(in crate::scene) fn span(self) -> Range<usize> {
        self.node.span()
    }

    pub(in crate::scene) fn node(self) -> &'d DeValue<'d> {
        self.node.get_ref()
    }

    /// Returns the entry of that number if the value is a list, or else the value itself.
    pub(in crate::scene) fn entry(self, number: usize) -> Self {
        let entry = self.node().as_array().and_then(|entries| entries.get(number));
        entry.map_or(self, |node| Self { is_entry: true, node, list: None, ..self })
    }

    /// Returns the one of two values that stands further down.
    pub(in crate::scene) fn later(self, other: Self) -> Self {
        if other.key.span().start > self.key.span().start { other } else { self }
    }

    /// Returns the value with a name for messages about it as a list of numbers, and with how to write it.
    pub(in crate::scene) fn as_list(self, name: &'static str, help: &'static str) -> Self {
        Self { list: Some((name, help)), ..self }
    }

    /// Reports that it is wrong.
    pub(in crate::scene) fn refuse<T>(self, message: impl Into<String>) -> Option<T> {
        self.report(message, None)
    }

    /// Reports that it is wrong, and what to do.
    pub(in crate::scene) fn advise<T>(self, message: impl Into<String>, help: impl Into<String>) -> Option<T> {
        self.report(message, Some(help.into()))
    }

    pub(in crate::scene) fn report<T>(self, message: impl Into<String>, help: Option<String>) -> Option<T> {
        self.document.report(self.span(), message, help);
        None
    }

    /// Returns the folder that the names of its files are relative to.
    fn folder(self) -> &'d Path {
        self.document.texts.folder(self.span().start)
    }

    /// Returns the path of the file of this name.
    pub(in crate::scene) fn path(self, name: &str) -> PathBuf {
        self.folder().join(name)
    }

    /// Reads the file of this name.
    pub(in crate::scene) fn file(self, name: &str, kind: &FileKind) -> Option<Vec<u8>> {
        self.reported(read_named(self.folder(), name, kind))
    }

    /// Returns the result of a check or of reading a file, or reports what is wrong.
    pub(in crate::scene) fn reported<T>(self, checked: Result<T, impl Into<Fault>>) -> Option<T> {
        checked.map_err(Into::into).map_or_else(|Fault { message, help }| self.report(message, help), Some)
    }

    /// Reports that there is no file of this name, which should have one of these extensions.
    pub(in crate::scene) fn missing<T>(self, name: &str, endings: &[&str]) -> Option<T> {
        self.reported(Err(missing(self.folder(), name, endings)))
    }

    /// Reports that its key is wrong.
    pub(in crate::scene) fn refuse_key<T>(self, message: impl Into<String>, help: Option<String>) -> Option<T> {
        self.document.report(self.key.span(), message, help);
        None
    }

    /// Reports what is expected in its place.
    pub(in crate::scene) fn expected<T>(self, expected: &str) -> Option<T> {
        let written = self.document.texts.whole.get(self.span()).unwrap_or_default();
        let found = match self.node() {
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a table".into(),
            DeValue::Datetime(_) => "a date".into(),
            DeValue::String(_) if written.len() > 40 || written.contains('\n') => "text".into(),
            DeValue::String(_) => format!("the text {written}"),
            _ => written.to_owned(),
        };
        let help = remedy(self.key(), self.node(), expected, written);
        self.report(format!("{} is {expected}, not {found}", self.name()), help)
    }

    fn name(self) -> String {
        if self.is_entry { format!("an entry of `{}`", self.key()) } else { format!("`{}`", self.key()) }
    }

    pub(in crate::scene) fn number(self) -> Option<f64> {
        match self.node() {
            DeValue::Integer(integer) => match parse_integer(integer) {
                Some(whole) if whole <= i128::from(u64::MAX) && whole >= i128::from(i64::MIN) => Some(whole as f64),
                Some(_) => self.expected("a number"),
                None => self.refuse("this number is too large"),
            },
            DeValue::Float(float) => match float.as_str().parse::<f64>() {
                Ok(number) if number.is_finite() || number.is_nan() || float.as_str().contains("inf") => Some(number),
                _ => self.refuse("this number is too large"),
            },
            _ => self.expected("a number"),
        }
    }

    /// Reads a number within a range. `rule` says in the message what the number should be.
    pub(in crate::scene) fn number_within(
        self,
        range: impl RangeBounds<f64>,
        rule: &str,
        help: Option<&str>,
    ) -> Option<f64> {
        match self.number()? {
            number if range.contains(&number) => Some(number),
            number => self.report(format!("{rule}, not {number}"), help.map(str::to_owned)),
        }
    }

    /// Reads a whole number within a range. If the range ends where a type does, the message names only its start.
    pub(in crate::scene) fn whole_number<T: TryFrom<i128>>(self, range: RangeInclusive<u64>) -> Option<T> {
        let (min, max) = range.into_inner();
        let is_open = max >= u64::from(u32::MAX);
        let expected = match is_open {
            true => format!("a whole number of {min} or more"),
            false => format!("a whole number from {min} to {max}"),
        };
        match self.node() {
            DeValue::Integer(integer) => match parse_integer(integer) {
                Some(whole) if whole > i128::from(max) && is_open => self.expected(&format!("at most {max}")),
                Some(whole) if !(i128::from(min)..=i128::from(max)).contains(&whole) => self.expected(&expected),
                Some(whole) => T::try_from(whole).ok(),
                None => self.refuse("this number is too large"),
            },
            _ => self.expected(&expected),
        }
    }

    pub(in crate::scene) fn count(self) -> Option<u32> {
        self.whole_number(0..=u32::MAX.into())
    }

    /// Reads a whole number, which may be negative.
    pub(in crate::scene) fn integer(self) -> Option<i32> {
        let Some(integer) = self.node().as_integer() else { return self.expected("a whole number") };
        let within = parse_integer(integer).and_then(|whole| i32::try_from(whole).ok());
        within.or_else(|| self.expected(&format!("a whole number from {} to {}", i32::MIN, i32::MAX)))
    }

    pub(in crate::scene) fn text(self) -> Option<&'d str> {
        self.node().as_str().or_else(|| self.expected("text in quotes"))
    }

    pub(in crate::scene) fn yes_or_no(self) -> Option<bool> {
        self.node().as_bool().or_else(|| self.expected("true or false"))
    }

    /// Returns what a word stands for.
    pub(in crate::scene) fn word<T: Copy>(self, words: &[(&'static str, T)]) -> Option<T> {
        let Some(word) = self.node().as_str() else {
            if words.len() > MAX_WORDS {
                return self.text().and(None);
            }
            let quoted: Vec<String> = words.iter().map(|(known, _)| format!("\"{known}\"")).collect();
            return self.expected(&one_of(&quoted));
        };
        words.iter().find(|(known, _)| *known == word).map(|(_, meaning)| *meaning).or_else(|| {
            let known: Vec<&str> = words.iter().map(|(known, _)| *known).collect();
            self.unknown(word, &known)
        })
    }

    /// Returns whether there are already so many mistakes that further ones get no suggestion of a name, which would
    /// take a look at all known names.
    pub(in crate::scene) fn has_many_mistakes(self) -> bool {
        self.document.reported() >= MANY_MISTAKES
    }

    /// Reports that it is none of the known words.
    pub(in crate::scene) fn unknown<T>(self, word: &str, known: &[&str]) -> Option<T> {
        self.advise(format!("`{}` cannot be \"{word}\"", self.key()), suggestion(self.key(), word, known))
    }

    /// Returns the values of a table's keys.
    pub(in crate::scene) fn table(self) -> Option<Vec<Self>> {
        let Some(table) = self.node().as_table() else { return self.expected("a table") };
        Some(table.iter().map(|(key, node)| Self::new(self.document, key, node)).collect())
    }

    /// Returns the entries of a list, if it is one.
    fn entries(self) -> Option<impl ExactSizeIterator<Item = Self>> {
        let entries = self.node().as_array()?;
        Some(entries.iter().map(move |node| Self { is_entry: true, node, list: None, ..self }))
    }

    /// Reads all entries of a list. Returns none if any of them is wrong. Stops at a wrong one that is not a table.
    pub(in crate::scene) fn list<T>(self, mut read: impl FnMut(Self) -> Option<T>) -> Option<Vec<T>> {
        let Some(entries) = self.entries() else { return self.expected("a list") };
        let (count, mut all) = (entries.len(), Vec::with_capacity(entries.len()));
        for entry in entries {
            let reported = self.document.reported();
            all.extend(read(entry));
            // A mistake in one entry that is not a table is mostly in all of them.
            let is_wrong = self.document.reported() > reported && self.document.last() == Some(entry.span());
            if is_wrong && !entry.node().is_table() {
                return None;
            }
        }
        Some(all).filter(|all| all.len() == count)
    }

    /// Reads all entries of a list, and reports each one that is wrong. Returns none if any is.
    pub(in crate::scene) fn each<T>(self, read: impl FnMut(Self) -> Option<T>) -> Option<Vec<T>> {
        let Some(entries) = self.entries() else { return self.expected("a list") };
        let all: Vec<Option<T>> = entries.map(read).collect();
        all.into_iter().collect()
    }

    /// Returns the rows of numbers that a program has given for it, if there are any.
    pub(in crate::scene) fn rows(self) -> Option<&'d Rows> {
        let position = self.node().as_str().and_then(Rows::marked_position)?;
        self.document.texts.rows.get(position)
    }

    /// Reads the entries of a list of a given length.
    pub(in crate::scene) fn array<T, const N: usize>(self, read: impl FnMut(Self) -> Option<T>) -> Option<[T; N]> {
        match self.entries().map(|entries| entries.len()) {
            None => self.expected(&format!("a list of {N} numbers")),
            Some(count) if count != N => {
                let name = self.list.map(|list| list.0).filter(|name| !name.is_empty());
                let name = name.map_or_else(|| self.name(), str::to_owned);
                let help = self.list.map(|list| list.1.to_owned()).filter(|help| !help.is_empty());
                let written = self.document.texts.whole.get(self.span()).unwrap_or_default();
                let help = with_decimal_points(written, N).filter(|_| count > N).or(help);
                self.report(format!("{name} is a list of {N} numbers, not {count}"), help)
            }
            Some(_) => self.list(read)?.try_into().ok(),
        }
    }

    pub(in crate::scene) fn numbers<const N: usize>(self) -> Option<[f64; N]> {
        self.array(Self::number)
    }

    /// Reads a number for all axes, or a list with one for each. `form` shows such a list in messages.
    pub(in crate::scene) fn one_or<const N: usize>(self, form: &str) -> Option<[f64; N]> {
        match self.node() {
            DeValue::Integer(_) | DeValue::Float(_) => self.number().map(|number| [number; N]),
            DeValue::Array(_) => self.numbers(),
            _ => self.expected(&format!("a number or {form}")),
        }
    }
}

/// The content of a value, and its place.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Spanned<'d, T> {
    pub(in crate::scene) place: Value<'d>,
    pub(in crate::scene) value: T,
}

/// Wraps a reader so that it also returns the place of the value.
pub(in crate::scene) fn spanned<'d, T>(
    mut read: impl FnMut(Value<'d>) -> Option<T>,
) -> impl FnMut(Value<'d>) -> Option<Spanned<'d, T>> {
    move |place| read(place).map(|value| Spanned { place, value })
}

/// Returns a list as an array if it has the right length. Otherwise, `other` reports its length.
pub(in crate::scene) fn exactly<T, const N: usize>(
    all: Vec<T>,
    other: impl FnOnce(usize) -> Option<[T; N]>,
) -> Option<[T; N]> {
    let count = all.len();
    all.try_into().map_or_else(|_| other(count), Some)
}

/// Returns the range of the numbers above 0, up to a maximum.
pub(in crate::scene) fn above_0_to(max: f64) -> (Bound<f64>, Bound<f64>) {
    (Bound::Excluded(0.0), Bound::Included(max))
}

/// Number of mistakes in a scene that a person still reads one by one.
pub(super) const MANY_MISTAKES: usize = 100;

/// Maximum number of known words that are all listed in a mistake.
const MAX_WORDS: usize = 10;

/// Lists words as `a, b or c`.
fn one_of(words: &[String]) -> String {
    match words {
        [] => String::new(),
        [word] => word.clone(),
        [words @ .., last] => format!("{} or {last}", words.join(", ")),
    }
}

/// Parses an integer of at most 128 bits.
fn parse_integer(integer: &DeInteger) -> Option<i128> {
    i128::from_str_radix(integer.as_str(), integer.radix()).ok()
}
