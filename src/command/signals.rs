//! Ctrl-C, and signals that would end a command without a word.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use abbe::film::remove_unfinished;
use abbe::{Error, Result};

use super::messages::say_last;
use super::outputs::remove_empty_folders;
use super::progress;

/// Whether the command was told to stop.
static STOPPED: AtomicBool = AtomicBool::new(false);
/// Whether anything is done that could be lost.
static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
/// Whether any file of the image is written.
static HAS_WRITTEN: AtomicBool = AtomicBool::new(false);
/// What it says then, if nothing of the render is kept.
pub const NOTHING_KEPT: &str = "stopped; nothing of this image was kept. With --checkpoint 60s, what is done is kept";
/// The same before there was anything.
const NOTHING_DONE: &str = "stopped before anything of this image was rendered";
/// The same when some of its files are there.
const NOT_ALL_WRITTEN: &str = "stopped before all files of this image were written";
/// The exit code of a command that was.
pub const STOPPED_CODE: u8 = 130;
/// Signals that come so soon after the first one are the same one: `timeout` sends it to a command, and again to all
/// that the command belongs to.
const ECHO: Duration = Duration::from_millis(500);

/// Whether the command was told to stop.
pub fn is_stopped() -> bool {
    STOPPED.load(Ordering::Relaxed)
}

/// Begins another image; returns whether the command was told to stop during the last one.
pub fn begin_image() -> bool {
    HAS_BEGUN.store(false, Ordering::Relaxed);
    HAS_WRITTEN.store(false, Ordering::Relaxed);
    is_stopped()
}

/// Notes that something of the image is done from now on.
pub fn begin_work() {
    HAS_BEGUN.store(true, Ordering::Relaxed);
}

/// Notes that a file of the image is written.
pub fn note_written() {
    HAS_WRITTEN.store(true, Ordering::Relaxed);
}

/// Lets Ctrl-C stop the command, at once or after what is done is kept; a second one stops it at once.
///
/// # Errors
/// If it cannot be caught.
pub fn catch(stops_at_once: bool) -> Result<()> {
    let mut first = None;
    handle(move || {
        let has_begun = HAS_BEGUN.load(Ordering::Relaxed);
        let leave_nothing = || {
            progress::clear();
            leave_no_rest();
        };
        if stops_at_once || !has_begun {
            leave_nothing();
            say_last(
                match (has_begun, HAS_WRITTEN.load(Ordering::Relaxed)) {
                    (false, _) => NOTHING_DONE,
                    (true, false) => NOTHING_KEPT,
                    (true, true) => NOT_ALL_WRITTEN,
                },
                STOPPED_CODE,
            );
        }
        let is_echo = first.get_or_insert_with(Instant::now).elapsed() < ECHO;
        if STOPPED.swap(true, Ordering::Relaxed) && !is_echo {
            leave_nothing();
            std::process::exit(STOPPED_CODE.into());
        }
    })
}

/// Removes what was begun of files, and folders that were made for them alone.
fn leave_no_rest() {
    remove_unfinished();
    remove_empty_folders();
}

/// Lets Ctrl-C end a command that keeps nothing, without what it has begun to write.
///
/// # Errors
/// If it cannot be caught.
pub fn catch_plainly() -> Result<()> {
    handle(|| {
        leave_no_rest();
        say_last("stopped", STOPPED_CODE);
    })
}

/// Installs what is done on Ctrl-C, and lets SIGHUP, the end of the terminal, be ignored if `nohup` had it so: a
/// handler would end what is to outlive its terminal.
fn handle(stop: impl FnMut() + Send + 'static) -> Result<()> {
    let was_ignored = ignore_end_of_terminal();
    let caught = ctrlc::set_handler(stop);
    if was_ignored {
        ignore_end_of_terminal();
    }
    caught.map_err(|error| Error::Arguments { message: format!("cannot catch Ctrl-C: {error}"), help: None })
}

/// Ignores SIGHUP; returns whether it was ignored before.
#[cfg(unix)]
#[allow(unsafe_code)]
fn ignore_end_of_terminal() -> bool {
    // SAFETY: both the signal and what becomes of it exist, and nothing of ours is run by it.
    unsafe { libc::signal(libc::SIGHUP, libc::SIG_IGN) == libc::SIG_IGN }
}

/// There is no such signal elsewhere.
#[cfg(not(unix))]
fn ignore_end_of_terminal() -> bool {
    false
}

/// Lets a file that grows beyond what `ulimit -f` allows be an error of writing like any other.
#[cfg(unix)]
#[allow(unsafe_code)]
pub fn report_large_files() {
    // SAFETY: both the signal and what becomes of it exist, and nothing of ours is run by it.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// There is no such signal elsewhere.
#[cfg(not(unix))]
pub fn report_large_files() {}
