//! The end of the terminal, which `nohup` has a command ignore.

/// Installs handlers of signals, and lets SIGHUP be ignored if it was: a handler would end what is to outlive its
/// terminal.
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
