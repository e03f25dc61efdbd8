//! Work on all threads. Work is passed as a `dyn` function, so that the code that distributes it is compiled once for
//! each type of result, and not once for every number of lanes.
//!
//! Pieces are dealt out one by one. With two threads, Rayon itself would deal out a quarter of them at a time, so that
//! one thread would wait for the other at the end.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Runs work on a single processor, so that the time it takes is processor time.
pub(super) fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(one) => one.install(work),
        Err(_) => work(),
    }
}

/// Runs pieces of work 0 to `count` - 1, and returns their results in that order.
pub(super) fn in_parallel<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    (0..count).into_par_iter().with_max_len(1).map(work).collect()
}

pub(super) fn for_each_in_parallel<T: Send>(items: Vec<T>, work: &(dyn Fn(T) + Sync)) {
    items.into_par_iter().with_max_len(1).for_each(work);
}
