//! Work that takes its time: without the lock of the interpreter, and so that Ctrl-C is heard.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::sync::{Mutex, OnceLock};
use std::thread::Builder;
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::errors::{defect, raised};

/// How long Python waits for its turn at most.
const TICK: Duration = Duration::from_millis(50);
/// Bytes of a thread's stack: as many as a command has.
const STACK: usize = 8 << 20;
/// The process that worked first, whose threads share work. One that is forked of it has only the memory of them, and
/// would wait for them without end.
static FIRST: OnceLock<u32> = OnceLock::new();

/// Work on a thread of its own.
pub(super) struct Work<T> {
    answer: Mutex<Receiver<Option<T>>>,
}

/// Does work, and raises what a signal raises meanwhile; the work then comes to its end unheard.
///
/// # Errors
/// What a signal raises, and if the work has panicked.
pub(super) fn run<T: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> T + Send + 'static) -> PyResult<T> {
    Work::begin(work)?.finish(py, &mut || Ok(()))
}

impl<T: Send + 'static> Work<T> {
    /// Begins it.
    ///
    /// # Errors
    /// If there can be no thread.
    pub(super) fn begin(work: impl FnOnce() -> T + Send + 'static) -> PyResult<Self> {
        let (tell, answer) = sync_channel(1);
        let threads = threads_of_forked()?;
        let answered = move || {
            let work = || match threads {
                Some(threads) => threads.install(work),
                None => work(),
            };
            // Whoever does not wait any longer need not know.
            let _ = tell.send(catch_unwind(AssertUnwindSafe(work)).ok());
        };
        Builder::new().name("abbe".into()).stack_size(STACK).spawn(answered)?;
        Ok(Self { answer: Mutex::new(answer) })
    }

    /// Waits for what comes of it; `meanwhile` is done now and then, with the lock of the interpreter.
    ///
    /// # Errors
    /// What a signal or `meanwhile` raises, and if the work has panicked.
    pub(super) fn finish(&self, py: Python<'_>, meanwhile: &mut dyn FnMut() -> PyResult<()>) -> PyResult<T> {
        loop {
            if let Some(answer) = self.wait(py, TICK)? {
                return Ok(answer);
            }
            py.check_signals()?;
            meanwhile()?;
        }
    }

    /// What comes of it within a time, if anything does.
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
            Ok(None) | Err(RecvTimeoutError::Disconnected) => Err(defect("it panicked, as stderr says")),
        }
    }
}

/// Threads for one piece of work in a process that was forked of the first one; none in that, which has its own.
///
/// # Errors
/// If there can be no threads.
fn threads_of_forked() -> PyResult<Option<ThreadPool>> {
    if *FIRST.get_or_init(process::id) == process::id() {
        return Ok(None);
    }
    let threads = ThreadPoolBuilder::new().stack_size(STACK).build();
    threads.map(Some).map_err(|error| raised(error.into()))
}
