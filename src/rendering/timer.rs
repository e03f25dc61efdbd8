use std::time::{Duration, Instant};

/// So many times what the work took passes before it is done again.
const SELDOM: u32 = 100;

/// When work is done again, such as writing a checkpoint, that shall take at most 1 % of the time.
#[derive(Debug)]
pub struct Timer {
    period: Option<Duration>,
    due: Option<Instant>,
}

impl Timer {
    /// Of work that is done so often; never, if absent.
    pub fn new(period: Option<Duration>) -> Self {
        Self { period, due: due(period) }
    }

    /// Whether it is time.
    pub fn is_due(&self) -> bool {
        self.due.is_some_and(|due| Instant::now() >= due)
    }

    /// Does it, and not again for a while.
    pub fn run<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.due = due(self.period.map(|period| period.max(start.elapsed() * SELDOM)));
        result
    }
}

/// The end of a time from now on; none if it is absent, or beyond all times.
fn due(period: Option<Duration>) -> Option<Instant> {
    period.and_then(|period| Instant::now().checked_add(period))
}
