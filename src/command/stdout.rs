//! Lines on stdout for a program. If it stops reading, the work goes on.

use std::io::{Error, ErrorKind, Write};
use std::sync::OnceLock;

/// Why the first lost line could not be written.
static WRITE_ERROR: OnceLock<Error> = OnceLock::new();

/// Prints a line and flushes it. Remembers an error such as a full disk, but ignores that nobody reads the line.
pub fn print(line: &str) {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{line}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let _ = WRITE_ERROR.set(error);
        }
        _ => {}
    }
}

/// Returns why lines were lost, if any were.
pub fn write_error() -> Option<&'static Error> {
    WRITE_ERROR.get()
}
