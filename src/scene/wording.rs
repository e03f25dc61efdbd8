//! Keys and values that no scene has, in the words of people who write scenes.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::description::ShapeText;
use super::structure::Mistake;
use super::suggest::{remedy, suggestion};

/// How the message begins that refuses a spectrum without a kind.
const NO_KIND: &str = "a spectrum needs one of";

/// What is told of a material whose kind stands where its name should.
pub(super) const NAMELESS: &str = "this material has no name";

type Words = (String, Option<String>);

/// What the error of reading a document as a scene means.
pub(super) fn explain(text: &str, document: &DeTable, error: &toml::de::Error) -> Mistake {
    let span = error.span().unwrap_or(0..0);
    let written = text.get(span.clone()).unwrap_or_default();
    let place = Place::find(document, &span, &mut Vec::new()).unwrap_or_default();
    let said = error.message().lines().next().unwrap_or("this is no scene");
    match place.unknown(said).or_else(|| place.wrong_type(said, written)) {
        Some((message, help)) => (span, message, help),
        None => (place.told_span(said).unwrap_or(span), said.to_owned(), place.example(said)),
    }
}

/// The words in backquotes.
pub(super) fn quoted(said: &str) -> Vec<&str> {
    said.split('`').skip(1).step_by(2).collect()
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

    /// What a check of Abbe's own refuses: the value of a material's only kind, or the last key of a spectrum that it
    /// names.
    fn told_span(&self, said: &str) -> Option<Range<usize>> {
        let Some(DeValue::Table(table)) = self.value else { return None };
        match self.path.as_slice() {
            ["material", _] => table.values().next().map(Spanned::span),
            _ if said.starts_with(NO_KIND) => None,
            _ => {
                let named = table.keys().filter(|key| said.contains(&format!("`{}`", key.get_ref())));
                named.map(Spanned::span).max_by_key(|span| span.start)
            }
        }
    }

    /// A spectrum that could stand where one has no kind.
    fn example(&self, said: &str) -> Option<String> {
        let example = match *self.path.last().filter(|_| said.starts_with(NO_KIND))? {
            "index" => "\"N-BK7\" or { cauchy = [1.5046, 0.0042] }",
            "radiance" | "intensity" | "irradiance" | "emission" => "{ illuminant = \"D65\" }",
            _ => "{ rgb = [0.7, 0.5, 0.3] }",
        };
        Some(format!("such as {example}"))
    }

    /// A name that is unknown or missing: serde's "unknown field `x`, expected `a` or `b`" and the like.
    fn unknown(&self, said: &str) -> Option<Words> {
        let quoted = quoted(said);
        let (word, known) = quoted.split_first()?;
        let key = self.path.last().copied().unwrap_or_default();
        if said.starts_with("missing field ") {
            return Some((format!("`{word}` is missing"), None));
        }
        let message = match self.path.as_slice() {
            ["object", word] if is_shape(word) => {
                return Some((format!("`{word}` is a shape"), Some(format!("write shape.{word} = {{ .. }}"))));
            }
            ["light", "sun", "look_at"] => {
                let help = "toward = [1, 2, 1] is the direction from the scene to the sun";
                return Some(("a sun is infinitely far away and looks at no point".into(), Some(help.into())));
            }
            _ if said.starts_with("unknown field ") => format!("unknown key `{word}`"),
            _ if !said.starts_with("unknown variant ") => return None,
            ["film", "filter", plain @ ("box" | "center")] => {
                return Some((
                    format!("the filter `{plain}` has no width"),
                    Some(format!("write filter = \"{plain}\"")),
                ));
            }
            ["film", "filter", _] => format!("unknown filter `{word}`"),
            ["material", kind, _] if known.contains(kind) => {
                let help = format!("write [material.NAME] above {kind} = {{ .. }}");
                return Some((NAMELESS.into(), Some(help)));
            }
            ["material", _, _] => format!("unknown kind of material `{word}`"),
            ["object", "shape", _] => format!("unknown shape `{word}`"),
            ["object", "transform" | "instances", _] => format!("unknown step of a transform `{word}`"),
            _ => format!("`{key}` cannot be \"{word}\""),
        };
        Some((message, Some(suggestion(key, word, known))))
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
            "u32" | "u64" | "usize" => "a whole number of 0 or more",
            "i32" => "a whole number",
            "a string" => "a text in quotes",
            "a sequence" => "a list",
            "an array of length 2" => "a list of 2 numbers",
            "an array of length 4" => "a list of 4 numbers",
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

/// Whether a word names a shape: the reader looks at a shape's values only after it has recognized its name.
fn is_shape(word: &str) -> bool {
    let read = toml::from_str::<ShapeText>(&format!("{word} = 0"));
    read.is_err_and(|error| error.message().starts_with("invalid type"))
}
