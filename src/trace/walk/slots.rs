//! A stack of large entries.

/// A stack whose entries are filled in their place, in the memory of entries that are gone, and are never moved: to
/// copy what has just been written piece by piece takes longer than to write it.
#[derive(Debug)]
pub struct Slots<T> {
    entries: Vec<Box<T>>,
    used: usize,
}

impl<T> Slots<T> {
    pub fn new() -> Self {
        Self { entries: Vec::new(), used: 0 }
    }

    /// Another entry on top, to be filled: it holds what an entry that is gone did, or what `new` makes.
    #[inline(always)]
    pub fn add(&mut self, new: impl FnOnce() -> T) -> &mut T {
        if self.used == self.entries.len() {
            self.entries.push(Box::new(new()));
        }
        self.used += 1;
        &mut self.entries[self.used - 1]
    }

    /// Exchanges the entry at the top, if there is any, for one that is not used any more; answers whether there was.
    #[inline(always)]
    pub fn take(&mut self, entry: &mut Box<T>) -> bool {
        let Some(used) = self.used.checked_sub(1) else { return false };
        self.used = used;
        std::mem::swap(&mut self.entries[used], entry);
        true
    }

    /// An entry, counted from the bottom.
    #[inline(always)]
    pub fn get(&self, number: usize) -> Option<&T> {
        self.entries[..self.used].get(number).map(|entry| &**entry)
    }

    /// Leaves those alone whose number is to be kept.
    pub fn keep(&mut self, is_kept: impl Fn(usize) -> bool) {
        let mut kept = 0;
        for number in 0..self.used {
            if is_kept(number) {
                self.entries.swap(kept, number);
                kept += 1;
            }
        }
        self.used = kept;
    }

    pub fn clear(&mut self) {
        self.used = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::Slots;

    #[test]
    fn entries_are_filled_in_the_place_of_those_that_are_gone() {
        let (mut slots, mut entry) = (Slots::new(), Box::new(0));
        for number in 1..=3 {
            *slots.add(|| 0) = number;
        }
        slots.keep(|number| number != 1);
        assert_eq!([slots.get(0), slots.get(1), slots.get(2)], [Some(&1), Some(&3), None]);
        assert!(slots.take(&mut entry));
        assert_eq!((*entry, *slots.add(|| 7)), (3, 0));
        slots.clear();
        assert!(!slots.take(&mut entry));
    }
}
