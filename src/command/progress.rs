//! Progress with time left: a bar on a terminal, a plain line now and then elsewhere.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

use abbe::Rendering;
use indicatif::{ProgressBar, ProgressStyle};

use super::events::Event;
use super::messages::{Listener, listener, say, warn};
use super::openjd;

/// The progress of a render, as a bar or in lines.
pub struct Progress {
    bar: Option<ProgressBar>,
    ticker: Option<Ticker>,
    counts: Arc<Counts>,
}

/// The work that is done, and the work to do.
struct Counts {
    start: Instant,
    /// The time after which the render ends, finished or not.
    limit: Option<Duration>,
    /// The work that an earlier run has done.
    done_before: u64,
    done: AtomicU64,
    /// The total work if time allows, as far as it is known.
    work: AtomicU64,
    /// Whether the total work is known. If not, `work` is the maximum.
    is_known: AtomicBool,
}

impl Counts {
    fn work_done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Returns the total work that will be done within the time limit, at the pace so far.
    fn total(&self) -> u64 {
        let (done, work) = (self.work_done(), self.work.load(Ordering::Relaxed));
        let Some(limit) = self.limit.filter(|_| done > self.done_before) else { return work };
        let times = limit.as_secs_f64() / self.start.elapsed().as_secs_f64();
        let in_time = self.done_before + ((done - self.done_before) as f64 * times) as u64;
        in_time.clamp(done.min(work), work)
    }

    /// Returns the seconds left, if they are known.
    fn remaining_seconds(&self) -> Option<f64> {
        let (done, total) = (self.work_done(), self.total().max(1));
        let parts = [self.done_before, done].map(|count| count as f64 / total as f64);
        let is_known = self.is_known.load(Ordering::Relaxed) && done > self.done_before;
        is_known.then(|| left(parts, self.start.elapsed().as_secs_f64()))
    }

    /// Returns the time passed and the time left, in words.
    fn time_message(&self) -> String {
        times(self.start.elapsed().as_secs_f64(), self.remaining_seconds())
    }
}

/// The time before the first line for people. Shorter work shows no progress, except for a bar on a terminal.
const FIRST_DELAY: Duration = Duration::from_secs(10);
/// The time between two lines for people.
const PERIOD: Duration = Duration::from_secs(30);
/// The time between two lines for a program.
const TICK: Duration = Duration::from_secs(1);
/// The time between two lines for the log of a farm.
const LOG_PERIOD: Duration = Duration::from_secs(5);

impl Progress {
    /// Begins to show the progress of a render, part of which an earlier run may have done.
    pub fn new(rendering: &Rendering) -> Self {
        let (work, done) = (rendering.work(), rendering.done());
        let counts = Arc::new(Counts {
            start: Instant::now(),
            limit: rendering.plan().method.stop.as_ref().and_then(|stop| stop.time),
            done_before: done,
            done: AtomicU64::new(done),
            work: AtomicU64::new(work),
            is_known: AtomicBool::new(rendering.is_work_known()),
        });
        let is_shown = listener() == Listener::Person && std::io::stderr().is_terminal();
        let new = || ProgressBar::new(work).with_position(done).with_style(style()).with_message(counts.time_message());
        // Terminals that cannot move back in a line have no bar.
        let bar = is_shown.then(new).filter(|bar| !bar.is_hidden());
        BAR.lock().unwrap_or_else(PoisonError::into_inner).clone_from(&bar);
        let ticker = bar.is_none().then(|| {
            let counts = counts.clone();
            let (first, then) = match listener() {
                Listener::Program => (TICK, TICK),
                Listener::Farm => (TICK, LOG_PERIOD),
                _ => (FIRST_DELAY, PERIOD),
            };
            Ticker::new(first, then, move || print(&counts))
        });
        if listener() == Listener::Farm {
            openjd::progress(share([done, work]));
        }
        Self { bar, ticker, counts }
    }

    /// Updates the total work.
    pub fn update_total(&self, rendering: &Rendering) {
        let is_known = rendering.is_work_known();
        self.counts.work.store(rendering.work(), Ordering::Relaxed);
        self.counts.is_known.store(is_known, Ordering::Relaxed);
        self.advance(0);
    }

    /// Prints a line during the render.
    pub fn say(&self, line: &str) {
        self.with_hidden_bar(|| say(line));
    }

    /// Prints a warning during the render.
    pub fn warn(&self, message: &str) {
        self.with_hidden_bar(|| warn(message));
    }

    /// Hides the bar while `print` prints something.
    fn with_hidden_bar(&self, print: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Adds to the work done. May be called from any thread.
    pub fn advance(&self, work: u64) {
        self.counts.done.fetch_add(work, Ordering::Relaxed);
        if let Some(bar) = &self.bar {
            bar.set_length(self.counts.total());
            bar.set_message(self.counts.time_message());
            bar.inc(work);
        }
    }

    /// Returns the time left in words, if it is known.
    pub fn left(&self) -> Option<String> {
        self.counts.remaining_seconds().map(in_words)
    }

    /// Removes the bar, prints how long the render took and how long it was expected to take, and returns the former.
    pub fn finish(mut self, expected: Duration) -> Duration {
        let (start, work) = (self.counts.start, self.counts.work.load(Ordering::Relaxed));
        self.stop();
        let took = start.elapsed();
        report([work, work], took.as_secs_f64(), Some(0.0), &final_line(took, expected));
        took
    }

    /// Stops the lines or removes the bar.
    fn stop(&mut self) {
        drop(self.ticker.take());
        if self.bar.take().is_some() {
            clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.stop();
    }
}

/// Does work of unknown length, and prints from time to time that it goes on.
pub fn during<T>(doing: &'static str, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let _ticker = Ticker::new(FIRST_DELAY, PERIOD, move || say(&ongoing_line(doing, start.elapsed().as_secs_f64())));
    work()
}

/// The bar on the terminal, if there is one.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Removes the bar when the command ends at once.
pub fn clear() {
    BAR.lock().unwrap_or_else(PoisonError::into_inner).take().iter().for_each(ProgressBar::finish_and_clear);
}

/// Returns the style of the bar, with a percentage and a message beside it.
fn style() -> ProgressStyle {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %, {msg}");
    style.unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Prints how much of the work is done.
fn print(counts: &Counts) {
    let (done, total, seconds) = (counts.work_done(), counts.total(), counts.start.elapsed().as_secs_f64());
    let left = counts.remaining_seconds();
    report([done, total], seconds, left, &line(share([done, total]), seconds, left));
}

/// Reports the work done and the total work, the seconds passed and the seconds left: in numbers to a program, in words
/// to all others.
fn report(parts: [u64; 2], seconds: f64, seconds_left: Option<f64>, words: &str) {
    let [done, total] = parts;
    match listener() {
        Listener::Program => return Event::Progress { done, total, seconds, seconds_left }.print(),
        Listener::Farm => openjd::progress(share(parts)),
        Listener::Person | Listener::Quiet => {}
    }
    say(words);
}

fn share([done, total]: [u64; 2]) -> f64 {
    done as f64 / total.max(1) as f64
}

/// Returns the seconds left after `passed` seconds, in which the share that is done has grown from `before` to `part`.
fn left([before, part]: [f64; 2], passed: f64) -> f64 {
    passed * (1.0 - part).max(0.0) / (part - before)
}

/// Returns the line for the end of a render. The expected time of a short render means nothing, and is left out.
fn final_line(took: Duration, expected: Duration) -> String {
    let [took, expected] = [took, expected].map(|time| time.as_secs_f64());
    let compared = if took.max(expected) < 2.0 {
        String::new()
    } else {
        format!("; the plan expected {expected:.1} s on an idle machine")
    };
    format!("rendered in {took:.1} s{compared}")
}

/// A thread that prints from time to time until it is dropped.
struct Ticker {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Ticker {
    fn new(first: Duration, then: Duration, print: impl Fn() + Send + 'static) -> Self {
        let (stop, stopped) = channel::<()>();
        let thread = spawn(move || {
            let mut wait = first;
            while stopped.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
                print();
                wait = then;
            }
        });
        Self { stop: Some(stop), thread: Some(thread) }
    }
}

impl Drop for Ticker {
    fn drop(&mut self) {
        drop(self.stop.take());
        // If the thread has panicked, it has nothing more to print.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Returns a line on the share of the work done, the seconds passed, and the seconds left if they are known.
fn line(part: f64, passed: f64, left: Option<f64>) -> String {
    let percent = (100.0 * part).floor().min(99.0);
    format!("{percent} %, {}", times(passed, left))
}

/// Returns a line on work that has taken `passed` seconds so far.
fn ongoing_line(doing: &str, passed: f64) -> String {
    format!("{doing}, {}", times(passed, None))
}

fn times(passed: f64, left: Option<f64>) -> String {
    let left = left.map_or(String::new(), |left| format!(", about {} left", in_words(left)));
    format!("{} passed{left}", in_words(passed))
}

/// Formats a time in the unit that people would use.
fn in_words(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 99.5 => format!("{seconds:.0} s"),
        seconds if seconds < 99.5 * 60.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_the_part_that_is_done_and_the_time_passed_and_left() {
        let after = |parts: [f64; 2], passed| line(parts[1], passed, Some(left(parts, passed)));
        assert_eq!(line(0.0, 10.0, None), "0 %, 10 s passed");
        assert_eq!(after([0.0, 0.25], 40.0), "25 %, 40 s passed, about 2 min left");
        assert_eq!(after([0.0, 0.999], 3000.0), "99 %, 50 min passed, about 3 s left");
        assert_eq!(after([0.0, 0.1], 7200.0), "10 %, 2.0 h passed, about 18.0 h left");
        assert_eq!(after([0.5, 0.6], 10.0), "60 %, 10 s passed, about 40 s left");
        assert_eq!(ongoing_line("planning", 40.0), "planning, 40 s passed");
    }

    #[test]
    fn a_long_render_prints_lines_even_while_no_work_is_done_and_a_short_one_none() {
        let (report, told) = channel();
        let ticker =
            Ticker::new(Duration::from_millis(1), Duration::from_millis(1), move || report.send(()).unwrap_or(()));
        assert_eq!(told.iter().take(5).count(), 5);
        drop(ticker);
        // This ends because the sender was dropped with the thread.
        told.iter().for_each(drop);
        let (report, told) = channel();
        drop(Ticker::new(Duration::from_secs(3600), PERIOD, move || report.send(()).unwrap_or(())));
        assert_eq!(told.iter().count(), 0);
    }

    #[test]
    fn there_is_a_line_a_minute_at_least() {
        assert!(FIRST_DELAY.max(PERIOD) <= Duration::from_secs(60));
    }
}
