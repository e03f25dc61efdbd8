//! The nodes and leaves that a walk has yet to visit.
#![allow(unsafe_code)]

use std::mem::MaybeUninit;

/// Number of entries of the stack. No tree needs more.
pub const STACK_SIZE: usize = 256;

/// Memory for a stack, not filled in advance: that would take longer than a walk through a small tree.
///
/// It is separate from the stack's height. A value of which only some bytes are initialized would be copied whole from
/// a constant.
pub struct StackMemory([MaybeUninit<u64>; STACK_SIZE]);

impl StackMemory {
    /// Creates memory in which nothing has been written.
    #[inline(always)]
    pub fn new() -> Self {
        Self([MaybeUninit::uninit(); STACK_SIZE])
    }
}

/// A stack of numbers: last in, first out.
pub struct Stack<'a> {
    entries: &'a mut [MaybeUninit<u64>; STACK_SIZE],
    height: usize,
}

impl<'a> Stack<'a> {
    /// Creates an empty stack in the given memory.
    #[inline(always)]
    pub fn new(memory: &'a mut StackMemory) -> Self {
        Self { entries: &mut memory.0, height: 0 }
    }

    /// Returns the number of entries.
    #[inline(always)]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Removes the top entry and returns it.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<u64> {
        self.height = self.height.checked_sub(1)?;
        Some(self.entry(self.height))
    }

    /// Puts a number on top.
    ///
    /// # Panics
    /// If the stack is full.
    #[inline(always)]
    pub fn push(&mut self, number: u64) {
        self.entries[self.height] = MaybeUninit::new(number);
        self.height += 1;
    }

    /// Inserts a number below all smaller ones among the entries from index `above` on.
    #[inline(always)]
    pub fn push_in_order(&mut self, number: u64, above: usize) {
        self.push(number);
        let mut at = self.height - 1;
        while at > above && self.entry(at - 1) < number {
            self.entries.swap(at, at - 1);
            at -= 1;
        }
    }

    #[inline(always)]
    fn entry(&self, at: usize) -> u64 {
        // SAFETY: entries below a height that was reached have been written, because only `push` raises the height.
        unsafe { self.entries[at].assume_init() }
    }
}
