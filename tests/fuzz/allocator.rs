//! Counts the memory that is allocated on all threads.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

#[global_allocator]
static COUNTING: Counting = Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);
static LARGEST: AtomicUsize = AtomicUsize::new(0);

struct Counting;

fn record_allocation(bytes: usize) {
    PEAK.fetch_max(LIVE.fetch_add(bytes, Relaxed) + bytes, Relaxed);
    LARGEST.fetch_max(bytes, Relaxed);
}

// Sound: every call is forwarded unchanged to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        record_allocation(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        record_allocation(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        LIVE.fetch_sub(layout.size(), Relaxed);
        record_allocation(size);
        unsafe { System.realloc(at, layout, size) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        unsafe { System.dealloc(at, layout) }
    }
}

/// Allocated bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Memory {
    /// The largest single allocation.
    pub largest: usize,
    /// The largest total at any time, beyond what was allocated before.
    pub peak: usize,
}

impl Memory {
    pub fn max(self, other: Self) -> Self {
        Self { largest: self.largest.max(other.largest), peak: self.peak.max(other.peak) }
    }
}

/// Runs a call and measures what it allocates.
pub fn memory_of<T>(call: impl FnOnce() -> T) -> (T, Memory) {
    let before = LIVE.load(Relaxed);
    PEAK.store(before, Relaxed);
    LARGEST.store(0, Relaxed);
    let answer = call();
    let peak = PEAK.load(Relaxed).saturating_sub(before);
    (answer, Memory { largest: LARGEST.load(Relaxed), peak })
}
