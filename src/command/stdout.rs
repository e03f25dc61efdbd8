//! Lines on stdout for a program. If it stops reading, the work goes on.

use std::io::{Error, ErrorKind, Write};
use std::sync::OnceLock;

/// Why the first lost line could not be written.
static LOST: OnceLock<Error> = OnceLock::new();

/// Prints a line and flushes it. Remembers an error such as a full disk, but ignores that nobody reads the line.
pub fn tell(line: &str) {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{line}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let _ = LOST.set(error);
        }
        _ => {}
    }
}

/// Returns why lines were lost, if any were.
pub fn lost() -> Option<&'static Error> {
    LOST.get()
}
