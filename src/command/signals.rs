//! Ctrl-C, and signals that would end a command without a message.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use abbe::film::remove_unfinished;
use abbe::{Error, Result};

use super::messages::say_and_exit;
use super::outputs::remove_empty_folders;
use super::progress;

/// Whether the command was told to stop.
static STOPPED: AtomicBool = AtomicBool::new(false);
/// Whether work has begun that could be lost.
static HAS_BEGUN: AtomicBool = AtomicBool::new(false);
/// Whether a file of the image has been written.
static HAS_WRITTEN: AtomicBool = AtomicBool::new(false);
/// The message if nothing of the render is kept.
pub const NOTHING_KEPT: &str = "stopped; nothing of this image was kept. With --checkpoint 60s, what is done is kept";
/// The message if there was nothing to keep yet.
const NOTHING_DONE: &str = "stopped before anything of this image was rendered";
/// The message if only some files of the image have been written.
const NOT_ALL_WRITTEN: &str = "stopped before all files of this image were written";
/// The exit code of a command that was stopped.
pub const STOPPED_CODE: u8 = 130;
/// Further signals within this time after the first one are copies of it: `timeout` sends one to the command, and
/// another to its whole process group.
const ECHO_TIME: Duration = Duration::from_millis(500);

/// Returns whether the command was told to stop.
pub fn is_stopped() -> bool {
    STOPPED.load(Ordering::Relaxed)
}

/// Begins another image. Returns whether the command was told to stop during the last one.
pub fn begin_image() -> bool {
    HAS_BEGUN.store(false, Ordering::Relaxed);
    HAS_WRITTEN.store(false, Ordering::Relaxed);
    is_stopped()
}

/// Records that the work on the image begins.
pub fn begin_work() {
    HAS_BEGUN.store(true, Ordering::Relaxed);
}

/// Records that a file of the image has been written.
pub fn note_written() {
    HAS_WRITTEN.store(true, Ordering::Relaxed);
}

/// Lets Ctrl-C stop the command, either at once or after saving what is done. A second Ctrl-C stops it at once.
///
/// # Errors
/// If Ctrl-C cannot be caught.
pub fn catch_ctrl_c(stops_at_once: bool) -> Result<()> {
    let mut first = None;
    install_handler(move || {
        let has_begun = HAS_BEGUN.load(Ordering::Relaxed);
        let clean_up = || {
            progress::clear();
            remove_leftovers();
        };
        if stops_at_once || !has_begun {
            clean_up();
            say_and_exit(
                match (has_begun, HAS_WRITTEN.load(Ordering::Relaxed)) {
                    (false, _) => NOTHING_DONE,
                    (true, false) => NOTHING_KEPT,
                    (true, true) => NOT_ALL_WRITTEN,
                },
                STOPPED_CODE,
            );
        }
        let is_echo = first.get_or_insert_with(Instant::now).elapsed() < ECHO_TIME;
        if STOPPED.swap(true, Ordering::Relaxed) && !is_echo {
            clean_up();
            std::process::exit(STOPPED_CODE.into());
        }
    })
}

/// Removes unfinished files, and the folders that were created only for them.
fn remove_leftovers() {
    remove_unfinished();
    remove_empty_folders();
}

/// Lets Ctrl-C end a command that keeps nothing, and removes the files that it has begun to write.
///
/// # Errors
/// If Ctrl-C cannot be caught.
pub fn exit_on_ctrl_c() -> Result<()> {
    install_handler(|| {
        remove_leftovers();
        say_and_exit("stopped", STOPPED_CODE);
    })
}

/// Installs a handler for Ctrl-C. SIGHUP, sent at the end of the terminal, stays ignored if it was, as under `nohup`: a
/// handler would end a command that is meant to outlive its terminal.
fn install_handler(stop: impl FnMut() + Send + 'static) -> Result<()> {
    let was_ignored = ignore_hangup();
    let installed = ctrlc::set_handler(stop);
    if was_ignored {
        ignore_hangup();
    }
    installed.map_err(|error| Error::Arguments { message: format!("cannot catch Ctrl-C: {error}"), help: None })
}

/// Ignores SIGHUP. Returns whether it was ignored before.
#[cfg(unix)]
#[allow(unsafe_code)]
fn ignore_hangup() -> bool {
    // SAFETY: the signal and its action are valid constants, and the action runs no code of ours.
    unsafe { libc::signal(libc::SIGHUP, libc::SIG_IGN) == libc::SIG_IGN }
}

/// Other systems have no such signal.
#[cfg(not(unix))]
fn ignore_hangup() -> bool {
    false
}

/// Ignores SIGXFSZ, so that a file larger than `ulimit -f` allows is an ordinary write error.
#[cfg(unix)]
#[allow(unsafe_code)]
pub fn ignore_file_size_signal() {
    // SAFETY: the signal and its action are valid constants, and the action runs no code of ours.
    unsafe { libc::signal(libc::SIGXFSZ, libc::SIG_IGN) };
}

/// Other systems have no such signal.
#[cfg(not(unix))]
pub fn ignore_file_size_signal() {}
