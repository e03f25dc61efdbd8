//! What a task of Open Job Description says of itself on stdout: lines that whoever runs it looks for.
//!
//! <https://github.com/OpenJobDescription/openjd-specifications/wiki/How-Jobs-Are-Run#stdoutstderr-messages>

use super::stdout;

/// How far the task is: a share of its work, from 0 to 1. Only all of it is 100 %.
pub fn progress(share: f64) {
    tell("progress", &percent(share));
}

/// What it does now.
pub fn status(words: &str) {
    tell("status", words);
}

/// Why it fails.
pub fn fail(words: &str) {
    tell("fail", words);
}

/// Says it in one line. Where nobody listens the work goes on.
fn tell(kind: &str, words: &str) {
    stdout::tell(&format!("openjd_{kind}: {}", line(words)));
}

fn percent(share: f64) -> String {
    let percent = if share < 1.0 { (share.max(0.0) * 1000.0).floor() / 10.0 } else { 100.0 };
    format!("{percent:.1}")
}

fn line(words: &str) -> String {
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
    fn several_lines_are_said_as_one() {
        assert_eq!(line("stopped. Go on with\n  render s.toml"), "stopped. Go on with render s.toml");
    }
}
