//! Long work, done without the lock of the interpreter and in such a way that Ctrl-C is noticed.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Mutex, OnceLock};
use std::thread::Builder;
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::errors::{bug_error, to_exception};

/// The maximum time between two checks for signals.
const TICK: Duration = Duration::from_millis(50);
/// The bytes of a thread's stack, as many as the command has.
const STACK: usize = 8 << 20;
/// The process that worked first, all of whose work shares its threads. A process forked from it only has a copy of
/// their memory, and would wait for them forever.
static FIRST_PROCESS: OnceLock<u32> = OnceLock::new();

/// Work on a thread of its own.
pub(super) struct Work<T> {
    answer: Mutex<Receiver<Option<T>>>,
}

/// Does work. If a signal raises an exception meanwhile, raises it, and ignores the result of the work, which goes on.
///
/// # Errors
/// The exception of a signal, or a defect if the work panics.
pub(super) fn run<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    Work::begin(work)?.finish(py, &mut || Ok(()))
}

impl<T: Send + 'static> Work<T> {
    /// Begins the work.
    ///
    /// # Errors
    /// If no thread can be started.
    pub(super) fn begin(work: impl FnOnce() -> T + Send + 'static) -> PyResult<Self> {
        let (sender, answer) = sync_channel(1);
        let threads = threads_of_forked()?;
        let run_work = move || {
            let work = || match threads {
                Some(threads) => threads.install(work),
                None => work(),
            };
            // If nobody waits any longer, the result is not needed.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)).ok());
        };
        Builder::new().name("abbe".into()).stack_size(STACK).spawn(run_work)?;
        Ok(Self { answer: Mutex::new(answer) })
    }

    /// Waits for the result. Calls `meanwhile` now and then, with the lock of the interpreter.
    ///
    /// # Errors
    /// The exception of a signal or of `meanwhile`, or a defect if the work panics.
    pub(super) fn finish(&self, py: Python<'_>, meanwhile: &mut dyn FnMut() -> PyResult<()>) -> PyResult<T> {
        loop {
            if let Some(answer) = self.wait(py, TICK)? {
                return Ok(answer);
            }
            py.check_signals()?;
            meanwhile()?;
        }
    }

    /// Waits for the result for a limited time. Returns none if it is not there by then.
    ///
    /// # Errors
    /// If the work has panicked.
    pub(super) fn wait(&self, py: Python<'_>, time: Duration) -> PyResult<Option<T>> {
        let answer = py.detach(|| match self.answer.lock() {
            Ok(answer) => answer.recv_timeout(time),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        });
        match answer {
            Ok(Some(answer)) => Ok(Some(answer)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Ok(None) | Err(RecvTimeoutError::Disconnected) => Err(bug_error("it panicked; stderr says why")),
        }
    }
}

/// Returns threads for one piece of work in a process forked from the first one. The first process has threads of its
/// own, and gets none.
///
/// # Errors
/// If no threads can be started.
fn threads_of_forked() -> PyResult<Option<ThreadPool>> {
    if *FIRST_PROCESS.get_or_init(process::id) == process::id() {
        return Ok(None);
    }
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build();
    threads.map(Some).map_err(|error| to_exception(error.into()))
}
