//! What people meant who gave arguments that there are not.

use std::ffi::OsString;

use clap::error::{ContextKind, ErrorKind};

/// Commands, and what may be taken for one.
const COMMANDS: [(&str, &str); 11] = [
    ("catalog", "render catalog"),
    ("info", "render info"),
    ("view", "render view"),
    ("diff", "render diff"),
    ("merge", "render merge"),
    ("completions", "render completions"),
    ("man", "render man"),
    ("plan", "render --plan"),
    ("check", "render --check"),
    ("help", "render --help"),
    ("render", "render --exr"),
];

/// Arguments of other renderers, and what does the same here.
const ELSEWHERE: [(&str, &str); 10] = [
    ("--spp", "--samples 64"),
    ("--output", "--exr frame.exr"),
    ("-o", "--exr frame.exr"),
    ("--width", "--set film.width=640"),
    ("--height", "--set film.height=360"),
    ("--resolution", "--set film.width=640 --set film.height=360"),
    ("--res", "--set film.width=640 --set film.height=360"),
    ("--size", "--set film.width=640 --set film.height=360"),
    ("--noise", "--error 0.01"),
    ("--aov", "--layers albedo,N"),
];

/// Most letters that are wrong in a command.
const WRONG: usize = 2;

/// A message on an argument that there is not, and what to write in place of it; none where that is not known.
pub fn meant(said: &clap::Error, words: &[OsString]) -> Option<(String, String)> {
    let given = match said.kind() {
        ErrorKind::UnknownArgument => said.get(ContextKind::InvalidArg)?.to_string(),
        _ => return None,
    };
    if let Some((_, here)) = ELSEWHERE.iter().find(|(there, _)| *there == given) {
        return Some((format!("there is no argument {given}"), format!("write {here}")));
    }
    let first = words.get(1)?.to_str().filter(|first| !first.starts_with('-') && !first.contains('.'))?;
    let wrong = |command: &str| strsim::damerau_levenshtein(first, command);
    let (_, here) =
        COMMANDS.iter().min_by_key(|(command, _)| wrong(command)).filter(|(near, _)| wrong(near) <= WRONG)?;
    Some((format!("there is no command `{first}`"), format!("did you mean {here}?")))
}
