//! Tables as text: a line for each entry, in the order of the keys' lower-case characters, fields parted by `|`.

use std::cmp::Ordering;

/// The lines of a table.
pub struct Rows(Vec<Row>);

/// A line of a table.
pub type Row = &'static str;

impl Rows {
    /// A table whose first line says where it comes from.
    pub fn new(text: &'static str) -> Self {
        Self(text.lines().skip(1).collect())
    }

    /// Every line, in order.
    pub fn all(&self) -> impl Iterator<Item = Row> {
        self.0.iter().copied()
    }

    /// The line of that key, whatever the case of its letters.
    pub fn find(&self, key: &str) -> Option<Row> {
        self.from(key).first().copied().filter(|line| key_of(line).eq_ignore_ascii_case(key))
    }

    /// The lines whose keys begin with these characters, whatever their case.
    pub fn starting_with(&self, start: &str) -> impl Iterator<Item = Row> {
        let begins = move |line: &Row| line.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start));
        self.from(start).iter().copied().take_while(begins)
    }

    /// The lines whose keys are not before this one.
    fn from(&self, key: &str) -> &[Row] {
        &self.0[self.0.partition_point(|line| compare(key_of(line), key).is_lt())..]
    }
}

/// The order of the tables.
pub fn compare(a: &str, b: &str) -> Ordering {
    let [a, b] = [a, b].map(|text| text.bytes().map(|byte| byte.to_ascii_lowercase()));
    a.cmp(b)
}

/// The first field of a line.
pub fn key_of(line: &str) -> &str {
    fields(line).next().unwrap_or_default()
}

/// The fields of a line.
pub fn fields(line: &str) -> impl Iterator<Item = &str> {
    line.split('|')
}

/// The names of a field, parted by commas.
pub fn names(field: &str) -> impl Iterator<Item = &str> {
    field.split(',').filter(|name| !name.is_empty())
}

/// Whether the line's second field holds this name.
pub fn has_alias(line: &str, name: &str) -> bool {
    names(fields(line).nth(1).unwrap_or_default()).any(|alias| alias.eq_ignore_ascii_case(name))
}

/// The numbers of a field, parted by spaces.
pub fn numbers(field: &str) -> Vec<f64> {
    field.split_ascii_whitespace().map(number).collect()
}

/// The samples of a field, parted by spaces, their numbers by colons.
pub fn samples<const N: usize>(field: &str) -> Vec<[f64; N]> {
    let sample = |text: &str| {
        let mut parts = text.split(':').map(number);
        std::array::from_fn(|_| parts.next().unwrap_or(f64::NAN))
    };
    field.split_ascii_whitespace().map(sample).collect()
}

/// A number; none if it is not one, which the tests would find.
pub fn number(text: &str) -> f64 {
    text.parse().unwrap_or(f64::NAN)
}
