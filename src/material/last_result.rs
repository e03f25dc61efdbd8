/// A cache of the last result: neighboring lanes often have the same key, and then share the result.
pub(super) struct LastResult<K, V>(Option<(K, V)>);

impl<K: Copy + PartialEq, V: Copy> LastResult<K, V> {
    /// The empty cache.
    pub(super) const NONE: Self = Self(None);

    /// Returns `make(key)`, which is computed only if `key` differs from the last one.
    #[inline]
    pub(super) fn get_or_make(&mut self, key: K, make: impl FnOnce(K) -> V) -> V {
        match self.0 {
            Some((known, value)) if known == key => value,
            _ => self.0.insert((key, make(key))).1,
        }
    }
}
