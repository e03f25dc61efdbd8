//! Numbers for distinct values.

use std::collections::HashMap;
use std::hash::Hash;

/// Distinct values, numbered from 0 in the order in which they arrived.
pub(super) struct Numbered<T> {
    values: Vec<T>,
    numbers: HashMap<T, u32>,
}

impl<T> Default for Numbered<T> {
    fn default() -> Self {
        Self { values: Vec::new(), numbers: HashMap::new() }
    }
}

impl<T: Copy + Eq + Hash> Numbered<T> {
    pub(super) fn number(&mut self, value: T) -> u32 {
        *self.numbers.entry(value).or_insert_with(|| {
            self.values.push(value);
            self.values.len() as u32 - 1
        })
    }

    /// Returns all values, each at the index of its number.
    pub(super) fn all(self) -> Vec<T> {
        self.values
    }
}
