//! Messages of a task of Open Job Description: lines on stdout that the runner of the task looks for.
//!
//! <https://github.com/OpenJobDescription/openjd-specifications/wiki/How-Jobs-Are-Run#stdoutstderr-messages>

use super::stdout;

/// Reports the share of the work that is done, from 0 to 1. Only finished work is shown as 100 %.
pub fn progress(share: f64) {
    print("progress", &percent(share));
}

/// Reports what the task is doing.
pub fn status(words: &str) {
    print("status", words);
}

/// Reports why the task fails.
pub fn fail(words: &str) {
    print("fail", words);
}

/// Prints a message in one line. If nobody reads it, the work goes on.
fn print(kind: &str, words: &str) {
    stdout::print(&format!("openjd_{kind}: {}", single_line(words)));
}

fn percent(share: f64) -> String {
    let percent = if share < 1.0 { (share.max(0.0) * 1000.0).floor() / 10.0 } else { 100.0 };
    format!("{percent:.1}")
}

fn single_line(words: &str) -> String {
    words.lines().map(str::trim).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_nearly_done_is_not_done() {
        assert_eq!([0.0, 0.5, 0.9999, 1.0].map(percent), ["0.0", "50.0", "99.9", "100.0"]);
    }

    #[test]
    fn several_lines_are_joined_into_one() {
        assert_eq!(single_line("stopped. Go on with\n  render s.toml"), "stopped. Go on with render s.toml");
    }
}
