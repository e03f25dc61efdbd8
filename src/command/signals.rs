//! Signals that would end a command without a word.

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

/// Installs handlers of signals, and lets SIGHUP, the end of the terminal, be ignored if `nohup` had it so: a handler
/// would end what is to outlive its terminal.
#[cfg(unix)]
#[allow(unsafe_code)]
pub fn kept_ignored<T>(install: impl FnOnce() -> T) -> T {
    // SAFETY: both the signal and what becomes of it exist, and nothing of ours is run by it.
    let ignore = || unsafe { libc::signal(libc::SIGHUP, libc::SIG_IGN) };
    let before = ignore();
    let installed = install();
    if before == libc::SIG_IGN {
        ignore();
    }
    installed
}

/// There are no such signals elsewhere.
#[cfg(not(unix))]
pub fn kept_ignored<T>(install: impl FnOnce() -> T) -> T {
    install()
}
