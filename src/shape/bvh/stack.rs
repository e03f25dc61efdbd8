//! What a walk has still to look at.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// Entries of the stack, which no tree needs more of.
pub const STACK: usize = 256;

/// Numbers of which the last comes first; its memory is not filled in advance, which would take longer than a walk through
/// a small tree.
pub struct Stack {
    entries: [MaybeUninit<u64>; STACK],
    height: usize,
}

impl Stack {
    /// An empty one.
    #[inline(always)]
    pub fn new() -> Self {
        Self { entries: [MaybeUninit::uninit(); STACK], height: 0 }
    }

    /// Entries that it has.
    #[inline(always)]
    pub fn height(&self) -> usize {
        self.height
    }

    /// The last one, taken off.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<u64> {
        self.height = self.height.checked_sub(1)?;
        Some(self.written(self.height))
    }

    /// Puts a number on top.
    ///
    /// # Panics
    /// If it is full.
    #[inline(always)]
    pub fn push(&mut self, number: u64) {
        self.entries[self.height] = MaybeUninit::new(number);
        self.height += 1;
    }

    /// Puts a number below all smaller ones above an entry.
    #[inline(always)]
    pub fn push_in_order(&mut self, number: u64, above: usize) {
        self.push(number);
        let mut at = self.height - 1;
        while at > above && self.written(at - 1) < number {
            self.entries.swap(at, at - 1);
            at -= 1;
        }
    }

    #[inline(always)]
    fn written(&self, at: usize) -> u64 {
        // SAFETY: entries below a height that was reached have been written: `push` is all that raises it.
        unsafe { self.entries[at].assume_init() }
    }
}
