//! Explanations of text that is not TOML, in the words of people who write scenes.

use std::ops::Range;

use super::mistake::Mistake;
use super::toml_slips::{heading, loose_list, slip};
use crate::error::nearest;

/// Explains the error of reading a text as TOML.
pub(in crate::scene) fn explain(text: &str, error: &toml::de::Error) -> Mistake {
    let span = error.span().unwrap_or(0..0);
    let parser_message = error.message().lines().next().unwrap_or("this is not TOML");
    if let Some(slip) = slip(text, &span, parser_message) {
        return slip;
    }
    let (before, rest) = text.split_at_checked(span.start).unwrap_or((text, ""));
    let line = before.rsplit('\n').next().unwrap_or_default();
    let written = text.get(span.clone()).unwrap_or_default();
    let (message, help) = match parser_message.split(", expected").next().unwrap_or(parser_message) {
        "key with no value" => return explain_missing_value(span, line, rest),
        "string values must be quoted" => explain_unquoted(written),
        "invalid basic string" | "invalid literal string" if rest.is_empty() || rest.starts_with(['\r', '\n']) => {
            ("the closing quote is missing".into(), None)
        }
        _ if parser_message.starts_with("missing escaped value")
            || parser_message.contains("unicode hexadecimal value") =>
        {
            let help = "write / in the path of a file, or put the text in single quotes";
            ("in double quotes, `\\` starts an escape sequence".into(), Some(help.into()))
        }
        "missing comma between array elements" => return unclosed_bracket(before, ']'),
        "missing comma between key-value pairs" | "missing key for inline table element" => {
            return unclosed_bracket(before, '}');
        }
        "invalid literal string" | "extra comma in inline table" if !written.starts_with('\'') => {
            return explain_inline_table(before, rest);
        }
        "unclosed array" | "unclosed table" => ("the closing `]` is missing".into(), None),
        "unclosed array table" => ("the closing `]]` is missing".into(), None),
        "unclosed inline table" => ("the closing `}` is missing".into(), None),
        "unexpected key or value" => ("the line should end after its value".into(), after_value_help(line, rest)),
        "invalid mantissa" => ("a number starts with a digit, as in 0.5".into(), None),
        "invalid fraction" => ("a number ends with a digit, as in 1.0".into(), None),
        "unexpected leading zero" => ("a number has no leading zero".into(), None),
        // For a value without quotes, the parser goes by the first letter.
        "invalid float" | "invalid integer number" | "invalid boolean" if is_word(written) => word(written),
        "invalid float" | "invalid integer number" => ("this is not a number".into(), None),
        "missing assignment between key-value pairs" => {
            ("a key is followed by `=` and its value".into(), missing_sign_help(line, rest))
        }
        "carriage return must be followed by newline" => {
            let help = "save the file with Unix or Windows line endings";
            ("a carriage return alone does not end a line".into(), Some(help.into()))
        }
        "missing opening quote" => ("TOML needs straight quotes".into(), Some("write \"..\"".into())),
        "invalid unquoted key" => explain_unquoted_key(parser_message, line, rest),
        "duplicate key" => explain_duplicate(written, before, line),
        _ => (parser_message.to_owned(), None),
    };
    Mistake { span, message, help }
}

fn explain_missing_value(span: Range<usize>, line: &str, rest: &str) -> Mistake {
    let key = line.trim();
    let start = span.start - line.len() + (line.len() - line.trim_start().len());
    let (span, help) = if key.starts_with("//") {
        (start..start + 2, Some("a comment starts with #"))
    } else if let Some(help) = heading(&whole_line(line, rest)) {
        let message = "a heading needs brackets".into();
        return Mistake { span: start..start + key.len(), message, help: Some(help) };
    } else if let Some(key) = key.strip_suffix(':') {
        (start + key.len()..start + key.len() + 1, Some("write `=` instead of `:`"))
    } else if rest.starts_with(|c: char| "{[\"'-".contains(c) || c.is_ascii_digit()) {
        (span, Some("write `=` between the two"))
    } else {
        (span, rest.starts_with(":=").then_some("write `=` alone"))
    };
    Mistake { span, message: "a key is followed by `=` and its value".into(), help: help.map(str::to_owned) }
}

/// Returns the whole line that `line` begins and `rest` continues.
fn whole_line(line: &str, rest: &str) -> String {
    format!("{line}{}", rest.lines().next().unwrap_or_default())
}

/// Returns what to do where a key is not followed by its `=`.
fn missing_sign_help(line: &str, rest: &str) -> Option<String> {
    if rest.trim_start().starts_with(':') || line.trim_end().ends_with(':') {
        return Some("write `=` instead of `:`".into());
    }
    let whole = whole_line(line, rest);
    let heading_help = heading(&whole).map(|help| format!("a heading needs brackets: {}", &help["write ".len()..]));
    heading_help.or_else(|| loose_list(&whole, line.len()))
}

/// Explains a key with letters that TOML only allows in quotes.
fn explain_unquoted_key(parser_message: &str, line: &str, rest: &str) -> (String, Option<String>) {
    let is_end = |c: char| c.is_whitespace() || ".,=:[](){}<>\"'#".contains(c);
    let first = line.rsplit(is_end).next().unwrap_or_default();
    let word = format!("{first}{}", rest.split(is_end).next().unwrap_or_default());
    match word.chars().all(|c| c.is_alphanumeric() || "-_".contains(c)) && !word.is_ascii() {
        true => ("a name with letters beyond a to z needs quotes".into(), Some(format!("write \"{word}\""))),
        false => (parser_message.to_owned(), None),
    }
}

/// Reports a bracket that is not closed. The parser notices it only at the next word, which may be lines below.
fn unclosed_bracket(before: &str, bracket: char) -> Mistake {
    let end = before.trim_end().len();
    Mistake { span: end..end, message: format!("a comma or the closing `{bracket}` is missing here"), help: None }
}

/// Explains a table in braces in which a key has no value, or a number contains a comma.
fn explain_inline_table(before: &str, rest: &str) -> Mistake {
    let before = before.trim_end();
    let line = before.rsplit('\n').next().unwrap_or_default();
    let whole = whole_line(line, rest);
    let list = loose_list(&whole, line.len());
    let is_digit = |c: char| c.is_ascii_digit();
    let are_digits = |text: &str| !text.is_empty() && text.chars().all(is_digit);
    let (start, message, help) = match before.rsplit_once(',') {
        Some((first, last)) if first.ends_with(is_digit) && are_digits(last) => {
            (first.len(), "a number has no comma", Some("use `.` as the decimal point".into()))
        }
        Some((first, "")) => (first.len(), "there is an extra comma here", None),
        Some((_, last)) if !last.contains(['=', '{']) => (before.len(), "a key is followed by `=` and its value", None),
        _ => (before.len(), "a value is missing here", None),
    };
    Mistake { span: start..before.len().min(start + 1), message: message.into(), help: list.or(help) }
}

/// Returns whether letters form a word that is not a spelling of a number.
fn is_word(written: &str) -> bool {
    let is_number = ["inf", "infinity", "nan"].contains(&&*written.to_lowercase());
    written.starts_with(char::is_alphabetic) && !is_number
}

/// Explains a word without quotes: a word for true or false, or a text.
fn word(written: &str) -> (String, Option<String>) {
    let truth = match &*written.to_lowercase() {
        "true" | "yes" | "on" => "true",
        "false" | "no" | "off" => "false",
        other => {
            let or_truth = nearest(other, ["true", "false"]).map(|near| format!(", or {near}")).unwrap_or_default();
            return ("text needs quotes".into(), Some(format!("write {written:?}{or_truth}")));
        }
    };
    ("this is neither true nor false".into(), Some(format!("write {truth}")))
}

fn explain_unquoted(written: &str) -> (String, Option<String>) {
    let parts: Vec<&str> = written.split_whitespace().collect();
    if parts.is_empty() {
        ("a value is missing here".into(), None)
    } else if written.contains(['“', '”', '„', '‘', '’', '‚', '«', '»', '`', '´']) {
        ("TOML needs straight quotes".into(), Some("write \"..\"".into()))
    } else if parts.iter().all(|part| part.parse::<f64>().is_ok()) {
        ("numbers in a list are separated by commas".into(), Some(format!("write {}", parts.join(", "))))
    } else if let Some(number) = after_minus(written) {
        ("this is not a number".into(), Some(format!("use a plain minus sign: write -{number}")))
    } else if let Some(number) = written.strip_suffix(';').filter(|number| number.parse::<f64>().is_ok()) {
        ("this is not a number".into(), Some(format!("write {number}, without `;`")))
    } else if written.contains(" /*") {
        ("a comment starts with #".into(), Some("write # in place of /*".into()))
    } else if written.contains(" //") {
        ("a comment starts with #".into(), Some("write # in place of //".into()))
    } else if written.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first)) || is_call(written) {
        ("this is not a number".into(), Some("write a number alone, without a unit or arithmetic".into()))
    } else {
        word(written)
    }
}

/// Returns the number after a minus sign that is not the one on a keyboard.
fn after_minus(written: &str) -> Option<&str> {
    let number = written.strip_prefix(['\u{2212}', '\u{2013}', '\u{2014}'])?;
    number.parse::<f64>().is_ok().then_some(number)
}

/// Returns whether a text begins with a function of a pocket calculator.
fn is_call(written: &str) -> bool {
    let name = written.split_once('(').map(|(name, _)| name.trim());
    name.is_some_and(|name| ["sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "radians", "degrees"].contains(&name))
}

fn after_value_help(line: &str, rest: &str) -> Option<String> {
    if rest.trim_start().starts_with("//") {
        return Some("a comment starts with #".into());
    }
    let whole = whole_line(line, rest);
    if let Some(help) = loose_list(&whole, line.len()) {
        return Some(help);
    }
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    if rest.starts_with('=') {
        let is_one = value.starts_with('(') || value.split_whitespace().count() < 2;
        let help = if is_one { "keys within a value need braces: { .. }" } else { OWN_LINE };
        return Some(help.into());
    }
    if let Some(help) = heading(&whole) {
        return Some(help);
    }
    let digits = rest.strip_prefix(',')?;
    let decimal = line.ends_with(|c: char| c.is_ascii_digit()) && digits.starts_with(|c: char| c.is_ascii_digit());
    Some(if decimal { "use `.` as the decimal point" } else { OWN_LINE }.to_owned())
}

const OWN_LINE: &str = "each key goes on a line of its own";

fn explain_duplicate(key: &str, before: &str, line: &str) -> (String, Option<String>) {
    if line.starts_with('[') && matches!(key, "object" | "light") {
        return (format!("`{key}` is a list of tables"), Some(format!("write [[{key}]] for each")));
    }
    if line.starts_with("[[") && key == "material" {
        return ("`material` is a table, not a list".into(), Some("write [material.NAME] for each".into()));
    }
    let help = first_line(key, before, line).map(|first| format!("it is also given in line {first}: keep one of them"));
    (format!("`{key}` is given twice"), help)
}

/// Returns the line that first gives a key that `line` gives again: the line of a section, or of a key in the same
/// section.
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
