/// What was worked out last: lanes side by side are often met by the same numbers, and then share it.
pub(super) struct Last<K, V>(Option<(K, V)>);

impl<K: Copy + PartialEq, V: Copy> Last<K, V> {
    /// Nothing so far.
    pub(super) const NONE: Self = Self(None);

    /// What `make` answers to `key`, which is asked unless it was the last one.
    #[inline]
    pub(super) fn of(&mut self, key: K, make: impl FnOnce(K) -> V) -> V {
        match self.0 {
            Some((known, value)) if known == key => value,
            _ => self.0.insert((key, make(key))).1,
        }
    }
}
