//! Many renders in parallel.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Bytes of a thread's stack. A thread that waits for part of one render takes up another meanwhile, and so on. So many
/// renders then lie on one stack that a thread's default 2 MB may overflow.
const STACK: usize = 64 << 20;

/// Returns the results of `one` for all numbers below `count`, computed in parallel. Each may be a render.
pub fn parallel_map<T: Send>(count: u64, one: impl Fn(u64) -> T + Send + Sync) -> Vec<T> {
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build().expect("threads can be started");
    threads.install(|| (0..count).into_par_iter().map(one).collect())
}
