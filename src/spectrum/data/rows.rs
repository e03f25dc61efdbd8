//! Tables as text: a line for each entry, in the order of the keys' lower-case characters, fields parted by `|`.

use std::cmp::Ordering;

/// The lines of a table.
#[derive(Clone, Copy)]
pub struct Rows(&'static str);

/// A line of a table.
pub type Row = &'static str;

impl Rows {
    /// A table whose first line says where it comes from.
    pub const fn new(text: &'static str) -> Self {
        Self(text)
    }

    /// Every line, in order.
    pub fn all(self) -> impl Iterator<Item = Row> {
        self.0.lines().skip(1)
    }

    /// The line of that key, whatever the case of its letters.
    pub fn find(self, key: &str) -> Option<Row> {
        let line = self.0[self.lower_bound(key)..].lines().next()?;
        key_of(line).eq_ignore_ascii_case(key).then_some(line)
    }

    /// The lines whose keys begin with these characters, whatever their case.
    pub fn starting_with(self, start: &str) -> impl Iterator<Item = Row> {
        let begins = move |line: &Row| line.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start));
        self.0[self.lower_bound(start)..].lines().take_while(begins)
    }

    /// Where the first line begins whose key is not before this one.
    fn lower_bound(self, key: &str) -> usize {
        let text = self.0.as_bytes();
        let after_line =
            |at: usize| text[at..].iter().position(|&byte| byte == b'\n').map_or(text.len(), |i| at + i + 1);
        let (mut low, mut high) = (after_line(0), text.len());
        while low < high {
            let middle = low.midpoint(high);
            let start = text[low..middle].iter().rposition(|&byte| byte == b'\n').map_or(low, |i| low + i + 1);
            match compare(key_of(&self.0[start..]), key) {
                Ordering::Less => low = after_line(start),
                _ => high = start,
            }
        }
        low
    }
}

/// The order of the tables.
pub fn compare(a: &str, b: &str) -> Ordering {
    let lower = |text: &str| text.bytes().map(|byte| byte.to_ascii_lowercase()).collect::<Vec<_>>();
    lower(a).cmp(&lower(b))
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
