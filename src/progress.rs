//! Progress with time left: a bar on a terminal, a plain line for every tenth elsewhere.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// How far a render is.
pub struct Progress {
    bar: Option<ProgressBar>,
    work: u64,
    done: AtomicU64,
    start: Instant,
}

/// Renders shorter than this say nothing where there is no terminal.
const QUIET: Duration = Duration::from_secs(5);

impl Progress {
    /// Of a render of so many camera samples and photons.
    pub fn new(work: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {elapsed} passed, {eta} left");
            ProgressBar::new(work).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        Self { bar, work, done: AtomicU64::new(0), start: Instant::now() }
    }

    /// Counts those that are done; may be called from any thread.
    pub fn advance(&self, work: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(work);
            return;
        }
        let before = self.done.fetch_add(work, Ordering::Relaxed);
        let (tenth, next) = (before * 10 / self.work, (before + work) * 10 / self.work);
        let passed = self.start.elapsed();
        if next > tenth && next < 10 && passed > QUIET {
            let left = passed.as_secs_f64() * (10 - next) as f64 / next as f64;
            eprintln!("{next}0 %, {:.0} s passed, about {left:.0} s left", passed.as_secs_f64());
        }
    }

    /// Removes the bar and says how long it took.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        eprintln!("rendered in {:.1} s", self.start.elapsed().as_secs_f64());
    }
}
