//! A stack of large entries.

/// A stack whose entries are filled in place, in the memory of removed entries, and are never moved. Copying what has
/// just been written piece by piece takes longer than writing it.
#[derive(Debug)]
pub struct Slots<T> {
    entries: Vec<Box<T>>,
    spare: Vec<Box<T>>,
}

impl<T> Slots<T> {
    pub fn new() -> Self {
        Self { entries: Vec::new(), spare: Vec::new() }
    }

    /// Adds an entry on top and returns it to be filled. It holds what a removed entry held, or what `new` makes.
    #[inline(always)]
    pub fn add(&mut self, new: impl FnOnce() -> T) -> &mut T {
        self.entries.push(self.spare.pop().unwrap_or_else(|| Box::new(new())));
        self.entries.last_mut().expect("one was pushed")
    }

    /// Takes the entry at the top, if there is one. [`release`](Self::release) gives its memory back.
    #[inline(always)]
    pub fn take(&mut self) -> Option<Box<T>> {
        self.entries.pop()
    }

    /// Takes back the memory of an entry that is no longer used.
    #[inline(always)]
    pub fn release(&mut self, entry: Box<T>) {
        self.spare.push(entry);
    }

    /// Returns an entry, counted from the bottom.
    #[inline(always)]
    pub fn get(&self, number: usize) -> Option<&T> {
        self.entries.get(number).map(|entry| &**entry)
    }

    /// Keeps only the entries whose numbers `is_kept` accepts.
    pub fn retain(&mut self, is_kept: impl Fn(usize) -> bool) {
        let mut number = 0;
        self.spare.extend(self.entries.extract_if(.., |_| {
            number += 1;
            !is_kept(number - 1)
        }));
    }

    pub fn clear(&mut self) {
        self.spare.append(&mut self.entries);
    }
}

#[cfg(test)]
mod tests {
    use super::Slots;

    #[test]
    fn new_entries_reuse_the_memory_of_removed_ones() {
        let mut slots = Slots::new();
        for number in 1..=3 {
            *slots.add(|| 0) = number;
        }
        slots.retain(|number| number != 1);
        assert_eq!([slots.get(0), slots.get(1), slots.get(2)], [Some(&1), Some(&3), None]);
        let entry = slots.take().expect("two are left");
        assert_eq!((*entry, *slots.add(|| 7)), (3, 2));
        slots.release(entry);
        assert_eq!([*slots.add(|| 7), *slots.add(|| 7)], [3, 7]);
        slots.clear();
        assert!(slots.take().is_none() && slots.get(0).is_none());
    }
}
