//! Work on all threads. Work is passed as a `dyn` function, so that the code that distributes it is compiled once for
//! each type of result, and not once for every number of lanes.
//!
//! Pieces are dealt out one by one. With two threads, Rayon itself would deal out a quarter of them at a time, so that
//! one thread would wait for the other at the end.

use std::panic::resume_unwind;
use std::thread;

use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Runs work on the threads of a pool, and sleeps until it is done.
///
/// A thread of another pool does not sleep in [`ThreadPool::install`] but takes up further work of its own pool. Where
/// a program starts many renders in parallel, that is the next render, and hundreds of them overflow its stack.
pub fn run_on<T: Send>(threads: &ThreadPool, work: impl FnOnce() -> T + Send) -> T {
    if rayon::current_thread_index().is_none() || threads.current_thread_index().is_some() {
        return threads.install(work);
    }
    thread::scope(|scope| match scope.spawn(|| threads.install(work)).join() {
        Ok(result) => result,
        Err(panic) => resume_unwind(panic),
    })
}

/// Runs work on a single thread, so that the time it takes is that of one processor.
pub(super) fn on_one_thread<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(one) => run_on(&one, work),
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
