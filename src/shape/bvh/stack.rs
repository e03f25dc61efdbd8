//! What a walk has still to look at.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// Entries of the stack, which no tree needs more of.
pub const STACK: usize = 256;

/// Room for a stack, not filled in advance: that would take longer than a walk through a small tree.
///
/// It stands apart from the stack's height. A value in which only some bytes are known is copied whole from a constant.
pub struct Room([MaybeUninit<u64>; STACK]);

impl Room {
    /// Room in which nothing has been written.
    #[inline(always)]
    pub fn new() -> Self {
        Self([MaybeUninit::uninit(); STACK])
    }
}

/// Numbers of which the last comes first.
pub struct Stack<'a> {
    entries: &'a mut [MaybeUninit<u64>; STACK],
    height: usize,
}

impl<'a> Stack<'a> {
    /// An empty stack in some room.
    #[inline(always)]
    pub fn new(room: &'a mut Room) -> Self {
        Self { entries: &mut room.0, height: 0 }
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
