//! Lines on stdout for the program that listens there. Where it does not listen any more the work goes on.

use std::io::{Error, ErrorKind, Write};
use std::sync::OnceLock;

/// Why the first line that was lost could not be written.
static LOST: OnceLock<Error> = OnceLock::new();

/// Says a line at once. That it is lost, as on a full disk, is kept in mind; that nobody reads it is not.
pub fn tell(line: &str) {
    let mut stdout = std::io::stdout().lock();
    match writeln!(stdout, "{line}").and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            let _ = LOST.set(error);
        }
        _ => {}
    }
}

/// Why lines were lost, if any were.
pub fn lost() -> Option<&'static Error> {
    LOST.get()
}
