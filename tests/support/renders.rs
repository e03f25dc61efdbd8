//! Many renders at once.

use rayon::ThreadPoolBuilder;
use rayon::prelude::*;

/// Bytes of a thread's stack. A thread that waits for a part of one render takes up another meanwhile, and of that
/// another: so many lie on one stack that the 2 MB of a thread do not always hold them.
const STACK: usize = 64 << 20;

/// What comes of the numbers below `count`, each of which may be a render.
pub fn many<T: Send>(count: u64, one: impl Fn(u64) -> T + Send + Sync) -> Vec<T> {
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build().expect("threads can be started");
    threads.install(|| (0..count).into_par_iter().map(one).collect())
}
