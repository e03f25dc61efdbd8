//! Keys and values that no scene has, in the words of people who write scenes.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::description::ShapeText;
use super::structure::Mistake;
use crate::error::nearest;

type Words = (String, Option<String>);

/// What the error of reading a document as a scene means.
pub(super) fn explain(text: &str, document: &DeTable, error: &toml::de::Error) -> Mistake {
    let span = error.span().unwrap_or(0..0);
    let written = text.get(span.clone()).unwrap_or_default();
    let place = Place::find(document, &span, &mut Vec::new()).unwrap_or_default();
    let said = error.message().lines().next().unwrap_or("this is no scene");
    match place.unknown(said).or_else(|| place.wrong_type(said, written)) {
        Some((message, help)) => (span, message, help),
        None => (place.kind_span().unwrap_or(span), said.to_owned(), None),
    }
}

/// Where in the document a span lies.
#[derive(Default)]
struct Place<'t> {
    /// Keys from the top, without positions in lists.
    path: Vec<&'t str>,
    /// Whether the last step is a position in a list.
    is_entry: bool,
    value: Option<&'t DeValue<'t>>,
}

impl<'t> Place<'t> {
    /// The key or value that a span covers exactly.
    fn find(table: &'t DeTable<'t>, span: &Range<usize>, path: &mut Vec<&'t str>) -> Option<Self> {
        table.iter().find_map(|(key, value)| {
            path.push(key.get_ref());
            let found = if key.span() == *span {
                Some(Self { path: path.clone(), is_entry: false, value: Some(value.get_ref()) })
            } else {
                Self::find_in(value, span, path, false)
            };
            path.pop();
            found
        })
    }

    fn find_in(
        value: &'t Spanned<DeValue<'t>>,
        span: &Range<usize>,
        path: &mut Vec<&'t str>,
        is_entry: bool,
    ) -> Option<Self> {
        match value.get_ref() {
            found if value.span() == *span => Some(Self { path: path.clone(), is_entry, value: Some(found) }),
            DeValue::Table(table) => Self::find(table, span, path),
            DeValue::Array(entries) => entries.iter().find_map(|entry| Self::find_in(entry, span, path, true)),
            _ => None,
        }
    }

    /// The value of a material's only kind: what the material's own checks refuse.
    fn kind_span(&self) -> Option<Range<usize>> {
        match (self.path.as_slice(), self.value) {
            (["material", _], Some(DeValue::Table(kinds))) => kinds.values().next().map(Spanned::span),
            _ => None,
        }
    }

    /// A name that is unknown or missing: serde's "unknown field `x`, expected `a` or `b`" and the like.
    fn unknown(&self, said: &str) -> Option<Words> {
        let quoted: Vec<&str> = said.split('`').skip(1).step_by(2).collect();
        let (word, known) = quoted.split_first()?;
        let key = self.path.last().copied().unwrap_or_default();
        if said.starts_with("missing field ") {
            return Some(match self.path.is_empty() {
                true => (format!("the scene has no [{word}]"), Some("every scene has [camera] and [film]".into())),
                false => (format!("`{word}` is missing"), None),
            });
        }
        let message = match self.path.as_slice() {
            ["object", word] if is_shape(word) => {
                return Some((format!("`{word}` is a shape"), Some(format!("write shape.{word} = {{ .. }}"))));
            }
            _ if said.starts_with("unknown field ") => format!("unknown key `{word}`"),
            _ if !said.starts_with("unknown variant ") => return None,
            ["material", kind, _] if known.contains(kind) => {
                let help = format!("write [material.NAME] above {kind} = {{ .. }}");
                return Some(("this material has no name".into(), Some(help)));
            }
            ["material", _, _] => format!("unknown kind of material `{word}`"),
            ["object", "shape", _] => format!("unknown shape `{word}`"),
            ["object", "transform", _] => format!("unknown step of a transform `{word}`"),
            _ => format!("`{key}` cannot be \"{word}\""),
        };
        Some((message, Some(suggestion(word, known))))
    }

    /// A value of the wrong type: serde's "invalid type: map, expected f64" and the like.
    fn wrong_type(&self, said: &str, written: &str) -> Option<Words> {
        let value = self.value?;
        let expected = match said.strip_prefix("invalid ") {
            Some(rest) => rest.split_once(", expected ")?.1,
            None if said == "wanted string or table" => "a string",
            None if said.ends_with(" number overflowed") => return Some(("this number is too large".into(), None)),
            None => return None,
        };
        let too_large = matches!(value, DeValue::Integer(_)) && !written.starts_with('-');
        let wanted = match expected {
            "f64" => "a number",
            "u32" if too_large => "at most 4294967295",
            "u64" if too_large => "at most 18446744073709551615",
            "u32" | "u64" => "a whole number of 0 or more",
            "i32" => "a whole number",
            "a string" => "a text in quotes",
            "a sequence" => "a list",
            "an array of length 2" => "a list of 2 numbers",
            "an array of length 3" => "a list of 3 numbers",
            "a map" => "a table",
            other if other.starts_with("struct ") => "a table, { .. }",
            other => other,
        };
        let found = match value {
            DeValue::Array(entries) if said.starts_with("invalid length") => format!("one of {}", entries.len()),
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a table".into(),
            DeValue::Datetime(_) => "a date".into(),
            DeValue::String(_) if written.len() > 40 || written.contains('\n') => "a text".into(),
            DeValue::String(_) => format!("the text {written}"),
            _ => written.to_owned(),
        };
        let key = self.path.last()?;
        let owner = if self.is_entry { format!("an entry of `{key}`") } else { format!("`{key}`") };
        Some((format!("{owner} is {wanted}, not {found}"), remedy(key, value, expected, written)))
    }
}

/// The known name that was meant, or all of them.
fn suggestion(word: &str, known: &[&str]) -> String {
    let part_of =
        || known.iter().copied().find(|name| name.starts_with(word) || name.split('_').any(|part| part == word));
    match nearest(word, known.iter().copied()).or_else(part_of) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("known here: {}", known.join(", ")),
    }
}

/// Whether a word names a shape: the reader looks at a shape's values only after it has recognized its name.
fn is_shape(word: &str) -> bool {
    let read = toml::from_str::<ShapeText>(&format!("{word} = 0"));
    read.is_err_and(|error| error.message().starts_with("invalid type"))
}

/// How to write what a value of the wrong type seems to mean.
fn remedy(key: &str, value: &DeValue, expected: &str, written: &str) -> Option<String> {
    let number = matches!(expected, "f64" | "u32" | "u64" | "i32");
    match value {
        DeValue::String(text) if number && text.parse::<f64>().is_ok_and(f64::is_finite) => {
            Some(format!("write it without quotes: {text}"))
        }
        DeValue::Float(float) if number => {
            let float: f64 = float.as_str().parse().ok()?;
            (float >= 0.0 && float.fract() == 0.0).then(|| format!("write {float}"))
        }
        DeValue::Integer(_) if expected == "f64" => Some(format!("write it with a decimal point: {written}.0")),
        DeValue::Array(_) if expected.starts_with("a number, a catalog name") => {
            Some(format!("write {{ rgb = {written} }} for a color"))
        }
        DeValue::Table(_) if key == "material" => Some("define it as [material.NAME] and write \"NAME\" here".into()),
        DeValue::Table(_) if expected == "a sequence" => Some("put it in brackets: [{ .. }]".into()),
        _ => None,
    }
}
