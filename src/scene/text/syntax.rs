//! Text that is not TOML, in the words of people who write scenes.

use std::ops::Range;

use super::mistake::Mistake;
use crate::error::nearest;

/// What the error of reading a text as TOML means.
pub(in crate::scene) fn explain(text: &str, error: &toml::de::Error) -> Mistake {
    let span = error.span().unwrap_or(0..0);
    let (before, rest) = text.split_at_checked(span.start).unwrap_or((text, ""));
    let line = before.rsplit('\n').next().unwrap_or_default();
    let written = text.get(span.clone()).unwrap_or_default();
    let said = error.message().lines().next().unwrap_or("this is not TOML");
    let (message, help) = match said.split(", expected").next().unwrap_or(said) {
        "key with no value" => return without_value(span, line),
        "string values must be quoted" => unquoted(written),
        "invalid basic string" | "invalid literal string" if rest.is_empty() || rest.starts_with(['\r', '\n']) => {
            ("the closing quote is missing".into(), None)
        }
        _ if said.starts_with("missing escaped value") || said.contains("unicode hexadecimal value") => {
            let help = "write / in the path of a file, or put the text in single quotes";
            ("in double quotes, `\\` does not stand for itself".into(), Some(help.into()))
        }
        "missing comma between array elements" => return unclosed(before, ']'),
        "missing comma between key-value pairs" | "missing key for inline table element" => {
            return unclosed(before, '}');
        }
        "invalid literal string" | "extra comma in inline table" if !written.starts_with('\'') => {
            return of_inline_table(before);
        }
        "unclosed array" | "unclosed table" => ("the closing `]` is missing".into(), None),
        "unclosed array table" => ("the closing `]]` is missing".into(), None),
        "unclosed inline table" => ("the closing `}` is missing".into(), None),
        "unexpected key or value" => ("the line should end after its value".into(), after_value(line, rest)),
        "invalid mantissa" => ("a number starts with a digit, as in 0.5".into(), None),
        "invalid fraction" => ("a number ends with a digit, as in 1.0".into(), None),
        "unexpected leading zero" => ("a number starts with no needless 0".into(), None),
        // Of a value without quotes the reader goes by the first letter.
        "invalid float" | "invalid integer number" | "invalid boolean" if is_word(written) => word(written),
        "invalid float" | "invalid integer number" => ("this is no number".into(), None),
        "missing assignment between key-value pairs" => {
            let help = rest.trim_start().starts_with(':') || before.trim_end().ends_with(':');
            ("a key is followed by `=` and its value".into(), help.then(|| "write `=` instead of `:`".into()))
        }
        "carriage return must be followed by newline" => {
            let help = "save the file with the line ends of Unix or Windows";
            ("a carriage return alone ends no line".into(), Some(help.into()))
        }
        "duplicate key" => duplicate(written, before, line),
        _ => (said.to_owned(), None),
    };
    Mistake { span, message, help }
}

fn without_value(span: Range<usize>, line: &str) -> Mistake {
    let key = line.trim();
    let start = span.start - line.len() + (line.len() - line.trim_start().len());
    let (span, help) = if key.starts_with("//") {
        (start..start + 2, Some("a comment starts with #"))
    } else if let Some(key) = key.strip_suffix(':') {
        (start + key.len()..start + key.len() + 1, Some("write `=` instead of `:`"))
    } else {
        (span, None)
    };
    Mistake { span, message: "a key is followed by `=` and its value".into(), help: help.map(str::to_owned) }
}

/// The reader notices only at the next word, which may stand lines below.
fn unclosed(before: &str, bracket: char) -> Mistake {
    let end = before.trim_end().len();
    Mistake { span: end..end, message: format!("a comma or the closing `{bracket}` is missing here"), help: None }
}

/// A table in braces has a key without a value, or a number with a comma in it.
fn of_inline_table(before: &str) -> Mistake {
    let before = before.trim_end();
    let is_digit = |c: char| c.is_ascii_digit();
    let are_digits = |text: &str| !text.is_empty() && text.chars().all(is_digit);
    let (start, message, help) = match before.rsplit_once(',') {
        Some((first, last)) if first.ends_with(is_digit) && are_digits(last) => {
            (first.len(), "a number has no comma", Some("a decimal point is written `.`".into()))
        }
        Some((first, "")) => (first.len(), "there is a comma too many here", None),
        Some((_, last)) if !last.contains(['=', '{']) => (before.len(), "a key is followed by `=` and its value", None),
        _ => (before.len(), "a value is missing here", None),
    };
    Mistake { span: start..before.len().min(start + 1), message: message.into(), help }
}

/// Whether letters stand for no number that is spelt in some way.
fn is_word(written: &str) -> bool {
    let is_number = ["inf", "infinity", "nan"].contains(&&*written.to_lowercase());
    written.starts_with(char::is_alphabetic) && !is_number
}

/// A word without quotes: a truth in other words, or a text.
fn word(written: &str) -> (String, Option<String>) {
    let truth = match &*written.to_lowercase() {
        "true" | "yes" | "on" => "true",
        "false" | "no" | "off" => "false",
        other => {
            let or_truth = nearest(other, ["true", "false"]).map(|near| format!(", or {near}")).unwrap_or_default();
            return ("a text stands in quotes".into(), Some(format!("write {written:?}{or_truth}")));
        }
    };
    ("this is neither true nor false".into(), Some(format!("write {truth}")))
}

fn unquoted(written: &str) -> (String, Option<String>) {
    let parts: Vec<&str> = written.split_whitespace().collect();
    if parts.is_empty() {
        ("a value is missing here".into(), None)
    } else if written.contains(['“', '”', '„', '‘', '’']) {
        ("quotes are straight in TOML".into(), Some("write \"..\"".into()))
    } else if parts.iter().all(|part| part.parse::<f64>().is_ok()) {
        ("numbers in a list are separated by commas".into(), Some(format!("write {}", parts.join(", "))))
    } else if written.contains(" //") {
        ("a comment starts with #".into(), Some("write # in place of //".into()))
    } else if written.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) {
        ("this is no number".into(), Some("a number stands alone, without a unit or a calculation".into()))
    } else {
        word(written)
    }
}

fn after_value(line: &str, rest: &str) -> Option<String> {
    if rest.trim_start().starts_with("//") {
        return Some("a comment starts with #".into());
    }
    if line.split_once('=').is_some_and(|(_, value)| value.trim_start().starts_with('(')) {
        return Some("a list stands in brackets: [0, 1, 6]".into());
    }
    let digits = rest.strip_prefix(',')?;
    let decimal = line.ends_with(|c: char| c.is_ascii_digit()) && digits.starts_with(|c: char| c.is_ascii_digit());
    Some(if decimal { "a decimal point is written `.`" } else { "each key stands on a line of its own" }.to_owned())
}

fn duplicate(key: &str, before: &str, line: &str) -> (String, Option<String>) {
    if line.starts_with('[') && matches!(key, "object" | "light") {
        return (format!("`{key}` is a list of tables"), Some(format!("write [[{key}]] for each")));
    }
    let help =
        first_line(key, before, line).map(|first| format!("it stands in line {first} as well: keep one of them"));
    (format!("`{key}` is given twice"), help)
}

/// The line that gives a key first, which `line` begins to give again: a section, or a key of the same section.
fn first_line(key: &str, before: &str, line: &str) -> Option<usize> {
    let lines: Vec<&str> = before.lines().map(str::trim).collect();
    let above = lines.get(..before.matches('\n').count())?;
    if line.trim_start().starts_with('[') {
        let header = format!("{}{key}]", line.trim());
        return above.iter().position(|line| line.starts_with(&header)).map(|at| at + 1);
    }
    let section = above.iter().rposition(|line| line.starts_with('[')).map_or(0, |at| at + 1);
    let gives = |line: &&str| line.split_once('=').is_some_and(|(found, _)| found.trim() == key);
    above[section..].iter().position(gives).map(|at| section + at + 1)
}
