//! Slips that the TOML parser notices late, or reports in its own words.

use std::ops::Range;

use super::mistake::Mistake;
use crate::scene::web_color::web_color;

/// Returns what is certainly wrong in or above the line where the parser stopped, by what it said there.
pub(super) fn slip(text: &str, span: &Range<usize>, parser_message: &str) -> Option<Mistake> {
    let place = span.start;
    let stop = text.get(..place)?;
    // Texts in triple quotes, which may span several lines, are not examined.
    if stop.contains("\"\"\"") || stop.contains("'''") {
        return None;
    }
    let start = stop.rfind('\n').map_or(0, |at| at + 1);
    let line = text[start..].lines().next().unwrap_or_default();
    color_as_comment(&text[..start + line.len()])
        .or_else(|| open_quote(text, start, place))
        .or_else(|| strange_space(line, start))
        .or_else(|| match parser_message.split(',').next()? {
            "unclosed table" => spaced_heading(line, start),
            "duplicate key" => single_heading(text.get(span.clone())?, stop, line),
            "unexpected `=` in array" => key_in_list(text, place),
            _ => None,
        })
}

/// Returns a line without its comment, in which quoted texts are replaced by as many dots as they have bytes, and the
/// position of a double quote that is never closed.
fn mask_quoted(line: &str) -> (String, Option<usize>) {
    let (mut bare, mut rest) = (String::new(), line);
    while let Some(at) = rest.find(['"', '\'', '#']) {
        let (before, from) = rest.split_at(at);
        bare.push_str(before);
        let quote = from.as_bytes()[0];
        let end = match quote {
            b'#' => return (bare, None),
            b'"' => quoted_length(from),
            _ => from[1..].find('\'').map(|end| end + 2),
        };
        let Some(end) = end else {
            let open = (quote == b'"').then_some(bare.len());
            return (bare, open);
        };
        bare.push_str(&".".repeat(end));
        rest = &from[end..];
    }
    (bare + rest, None)
}

/// Returns the length of the text in double quotes with which `from` begins.
fn quoted_length(from: &str) -> Option<usize> {
    let mut is_escaped = false;
    let end = from.bytes().skip(1).position(|byte| {
        let closes = byte == b'"' && !is_escaped;
        is_escaped = byte == b'\\' && !is_escaped;
        closes
    });
    end.map(|end| end + 2)
}

/// Finds a web color without quotes, which begins a comment, so that its key has no value.
fn color_as_comment(text: &str) -> Option<Mistake> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let (bare, open) = mask_quoted(line);
        let (key, comment) = (bare.trim_end(), line.get(bare.len()..).unwrap_or_default());
        let digits = comment.trim_start_matches('#').find(|c: char| !c.is_ascii_alphanumeric());
        let written = digits.map_or(comment, |end| &comment[..=end]);
        if let (None, Some(key), Some(color)) = (open, key.strip_suffix('='), web_color(written)) {
            let help = match key.trim_end().ends_with("rgb") {
                true => format!("write {color}, in linear light"),
                false => format!("write {{ rgb = {color} }}, in linear light"),
            };
            let span = start + bare.len()..start + bare.len() + written.len();
            return Some(Mistake { span, message: "everything after # is a comment".into(), help: Some(help) });
        }
        start += line.len();
    }
    None
}

/// Finds a text with a single quote mark at one of its ends, in the line that starts at `start`, or in the one above if
/// there is nothing before `place`.
fn open_quote(text: &str, start: usize, place: usize) -> Option<Mistake> {
    let is_above = text[start..place].trim().is_empty();
    let end = if is_above {
        text[..place].trim_end().len()
    } else {
        start + text[start..].find('\n').unwrap_or(text.len() - start)
    };
    let start = text[..end].rfind('\n').map_or(0, |at| at + 1);
    let line = text[start..end].trim_end();
    if line.contains('\\') {
        return None;
    }
    let quote = mask_quoted(line).1?;
    let word = line[..quote].rsplit([' ', '\t', '=', '[', '{', ',']).next().unwrap_or_default();
    if word.is_empty() {
        let end = start + line.len();
        return Some(Mistake { span: end..end, message: "the closing quote is missing".into(), help: None });
    }
    let is_word = word.chars().all(|c| c.is_alphanumeric() || "-_./".contains(c));
    let span = start + quote - word.len()..start + quote + 1;
    let help = Some(format!("write \"{word}\""));
    is_word.then(|| Mistake { span, message: "the opening quote is missing".into(), help })
}

/// Finds a space that TOML does not allow, as web pages and word processors produce it.
fn strange_space(line: &str, start: usize) -> Option<Mistake> {
    let (line, start) = line.strip_prefix('\u{feff}').filter(|_| start == 0).map_or((line, start), |line| (line, 3));
    let bare = mask_quoted(line).0;
    let is_strange = |c: char| c.is_whitespace() && !c.is_ascii() || "\u{200b}\u{2060}\u{feff}".contains(c);
    let (at, space) = bare.char_indices().find(|(_, c)| is_strange(*c))?;
    let span = start + at..start + at + space.len_utf8();
    let message = format!("this is not a plain space but the character U+{:04X}", u32::from(space));
    Some(Mistake { span, message, help: Some("write a plain space, or nothing".into()) })
}

/// Finds a heading with a space in the name of its material, or before it. The line begins at `start`.
fn spaced_heading(line: &str, start: usize) -> Option<Mistake> {
    let bare = mask_quoted(line).0;
    let inner = bare.trim().strip_prefix('[')?.strip_suffix(']')?.trim();
    let name = inner.strip_prefix("material")?.trim_start_matches(['.', ' ']).trim_end();
    let is_separate = inner["material".len()..].starts_with(['.', ' ']);
    if name.is_empty() || !is_separate {
        return None;
    }
    let at = start + bare.find(inner)?;
    let (message, help) = match is_bare_key(name) {
        true => ("a heading joins its words with a dot", format!("write [material.{name}]")),
        false => ("a name with a space needs quotes", format!("write [material.\"{name}\"]")),
    };
    let is_one = !name.contains(['"', '\'', '[', ']', '.']);
    is_one.then(|| Mistake { span: at..at + inner.len(), message: message.into(), help: Some(help) })
}

fn is_bare_key(name: &str) -> bool {
    name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
}

/// Returns how to write a heading that stands in a line without its brackets, or with others.
pub(super) fn heading(line: &str) -> Option<String> {
    let line = line.trim();
    let word = line.trim_matches(|c: char| c.is_whitespace() || "[](){}<>:".contains(c));
    let material = || word.strip_prefix("material.").is_some_and(|name| !name.is_empty() && is_bare_key(name));
    match word {
        "camera" | "film" | "render" | "set" => Some(format!("write [{word}]")),
        "object" | "light" => Some(format!("write [[{word}]]")),
        _ if material() => Some(format!("write [{word}]")),
        _ => None,
    }
}

/// Returns how to write numbers without the brackets of a list. They follow the last `=` before a place of a line.
pub(super) fn loose_list(line: &str, place: usize) -> Option<String> {
    let before = line.get(..place)?;
    let value = before.rfind('=').or_else(|| line.find('=').filter(|at| *at == place))? + 1;
    let written = line[value..].trim_start();
    let inner = written.trim_start_matches(['(', '{']);
    let parts = inner.split(',').map(|part| part.trim_start().trim_end_matches([')', '}', ' ']));
    let numbers: Vec<&str> = parts.take_while(|part| part.parse::<f64>().is_ok()).collect();
    let is_list = numbers.len() > 2 || numbers.len() == 2 && inner.contains(", ");
    is_list.then(|| format!("a list needs brackets: [{}]", numbers.join(", ")))
}

/// Explains a key inside the brackets of a list, before the `=` at a place: the list is not closed, or its entry is a
/// table.
fn key_in_list(text: &str, place: usize) -> Option<Mistake> {
    let before = text.get(..place)?.trim_end();
    let key = before.rsplit([' ', '\t', '\n', ',', '[', '{']).next().filter(|key| !key.is_empty())?;
    let outside = before[..before.len() - key.len()].trim_end();
    if let Some(list) = outside.strip_suffix(',') {
        let at = list.len();
        let help = Some(format!("close the list before `{key}`"));
        return Some(Mistake { span: at..at, message: "the closing `]` is missing here".into(), help });
    }
    let at = before.len() - key.len();
    let help = Some(format!("a key and its value need braces: {{ {key} = .. }}"));
    Some(Mistake { span: at..before.len(), message: "a list cannot hold keys".into(), help })
}

/// Finds a section that should be an entry of a list, above the line that begins the list correctly.
fn single_heading(key: &str, before: &str, line: &str) -> Option<Mistake> {
    if !line.starts_with("[[") || !matches!(key, "object" | "light") {
        return None;
    }
    let (single, named, listed) = (format!("[{key}]"), format!("[{key}."), format!("[[{key}."));
    let mut start = 0;
    for above in before.split_inclusive('\n') {
        let header = above.trim();
        if header.starts_with(&single) || header.starts_with(&named) || header.starts_with(&listed) {
            let at = start + above.find('[')?;
            let end = at + header.find(']').map_or(header.len(), |end| end + 1);
            let help = Some(format!("write [[{key}]] for each"));
            return Some(Mistake { span: at..end, message: format!("`{key}` is a list of tables"), help });
        }
        start += above.len();
    }
    None
}
