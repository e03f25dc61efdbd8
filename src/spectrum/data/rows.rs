//! Tables as text: one line per entry, sorted by keys in lower case, with fields separated by `|`.

use std::cmp::Ordering;

/// The lines of a table.
pub struct Rows(Vec<Row>);

/// A line of a table.
pub type Row = &'static str;

impl Rows {
    /// Creates a table from text, whose first line says where it comes from.
    pub fn new(text: &'static str) -> Self {
        Self(text.lines().skip(1).collect())
    }

    /// Returns every line, in order.
    pub fn all(&self) -> impl Iterator<Item = Row> {
        self.0.iter().copied()
    }

    /// Returns the line of that key, ignoring case.
    pub fn find(&self, key: &str) -> Option<Row> {
        self.from(key).first().copied().filter(|line| key_of(line).eq_ignore_ascii_case(key))
    }

    /// Returns the lines whose keys begin with these characters, ignoring case.
    pub fn starting_with(&self, start: &str) -> impl Iterator<Item = Row> {
        let begins = move |line: &Row| line.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start));
        self.from(start).iter().copied().take_while(begins)
    }

    /// Returns the lines whose keys are not before this one.
    fn from(&self, key: &str) -> &[Row] {
        &self.0[self.0.partition_point(|line| compare(key_of(line), key).is_lt())..]
    }
}

/// Compares keys in the order of the tables.
pub fn compare(a: &str, b: &str) -> Ordering {
    let [a, b] = [a, b].map(|text| text.bytes().map(|byte| byte.to_ascii_lowercase()));
    a.cmp(b)
}

/// Returns the first field of a line.
pub fn key_of(line: &str) -> &str {
    fields(line).next().unwrap_or_default()
}

/// Returns the fields of a line.
pub fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split('|')
}

/// Returns the names of a field, separated by commas.
pub fn names(field: &str) -> impl Iterator<Item = &str> {
    field.split(',').filter(|name| !name.is_empty())
}

/// Returns whether the line's second field holds this name.
pub fn has_alias(line: &str, name: &str) -> bool {
    names(fields(line).nth(1).unwrap_or_default()).any(|alias| alias.eq_ignore_ascii_case(name))
}

/// Parses the numbers of a field, separated by spaces.
pub fn numbers(field: &str) -> Vec<f64> {
    field.split_ascii_whitespace().map(number).collect()
}

/// Parses the samples of a field, separated by spaces, whose numbers are separated by colons.
pub fn samples<const N: usize>(field: &str) -> Vec<[f64; N]> {
    let sample = |text: &str| {
        let mut parts = text.split(':').map(number);
        std::array::from_fn(|_| parts.next().unwrap_or(f64::NAN))
    };
    field.split_ascii_whitespace().map(sample).collect()
}

/// Parses a number; NaN if it is not one, which the tests would find.
pub fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}
