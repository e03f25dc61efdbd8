//! Numbers for distinct values.

use std::collections::HashMap;
use std::hash::Hash;

/// Distinct values, numbered from 0 in the order in which they arrived.
pub(super) struct Interner<T> {
    values: Vec<T>,
    numbers: HashMap<T, u32>,
}

impl<T> Default for Interner<T> {
    fn default() -> Self {
        Self { values: Vec::new(), numbers: HashMap::new() }
    }
}

impl<T: Copy + Eq + Hash> Interner<T> {
    /// Returns the number of a value.
    pub(super) fn intern(&mut self, value: T) -> u32 {
        *self.numbers.entry(value).or_insert_with(|| {
            self.values.push(value);
            self.values.len() as u32 - 1
        })
    }

    /// Returns all values, each at the index of its number.
    pub(super) fn into_values(self) -> Vec<T> {
        self.values
    }
}
