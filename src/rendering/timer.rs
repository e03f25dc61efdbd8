use std::time::{Duration, Instant};

/// The minimum pause before the work is repeated, as a multiple of the time that it took.
const MIN_PAUSE_FACTOR: u32 = 100;

/// Schedules repeated work, such as writing a checkpoint, so that it takes at most 1 % of the time.
#[derive(Clone, Debug)]
pub struct Timer {
    period: Option<Duration>,
    deadline: Option<Instant>,
}

impl Timer {
    /// Creates a timer for work that is repeated after each period, or never if there is none.
    pub fn new(period: Option<Duration>) -> Self {
        Self { period, deadline: end_of_period(period) }
    }

    /// Returns whether the work is due.
    pub fn is_due(&self) -> bool {
        self.deadline.is_some_and(|due| Instant::now() >= due)
    }

    /// Does the work, and schedules its next time.
    pub fn run<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.deadline = end_of_period(self.period.map(|period| period.max(start.elapsed() * MIN_PAUSE_FACTOR)));
        result
    }
}

/// Returns the end of a period that starts now, or none if there is no period or its end cannot be represented.
fn end_of_period(period: Option<Duration>) -> Option<Instant> {
    period.and_then(|period| Instant::now().checked_add(period))
}
