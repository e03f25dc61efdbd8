//! Work on all threads. Work is handed over as a `dyn` function: what deals it out is compiled once for each type of
//! result, not once for every number of lanes.
//!
//! Pieces are dealt out one by one. Rayon's own choice for two threads is a quarter of them at a time, so that one
//! waits for the other at the end.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Does work on one processor alone: how long it takes is then the time of a processor.
pub(super) fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(one) => one.install(work),
        Err(_) => work(),
    }
}

/// Does pieces of work 0 to `count` - 1, and answers their results in that order.
pub(super) fn in_parallel<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    (0..count).into_par_iter().with_max_len(1).map(work).collect()
}

pub(super) fn for_each_in_parallel<T: Send>(items: Vec<T>, work: &(dyn Fn(T) + Sync)) {
    items.into_par_iter().with_max_len(1).for_each(work);
}
