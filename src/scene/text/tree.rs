//! The content of a text as TOML, with places in the joined texts.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::mistake::Mistake;
use super::syntax::explain;

pub(super) type Key<'d> = Spanned<DeString<'d>>;
pub(super) type Node<'d> = Spanned<DeValue<'d>>;

pub(super) fn key_text<'k>(key: &'k Key) -> &'k str {
    key.get_ref()
}

/// Parses a text that starts at a place of the joined texts.
pub(in crate::scene) fn parse_toml(text: &str, start: usize) -> Result<DeTable<'_>, Mistake> {
    match DeTable::parse(text) {
        Ok(table) if start == 0 => Ok(table.into_inner()),
        Ok(table) => Ok(shift_spans(table.into_inner(), start)),
        Err(error) => {
            let mistake = explain(text, &error);
            Err(Mistake { span: shifted(mistake.span, start), ..mistake })
        }
    }
}

fn shifted(span: Range<usize>, start: usize) -> Range<usize> {
    span.start + start..span.end + start
}

fn shift_spans(table: DeTable, start: usize) -> DeTable {
    let entries = table.into_iter().map(|(key, value)| {
        let span = shifted(key.span(), start);
        (Spanned::new(span, key.into_inner()), shift_value_spans(value, start))
    });
    entries.collect()
}

fn shift_value_spans(value: Node, start: usize) -> Node {
    let span = shifted(value.span(), start);
    let value = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(shift_spans(table, start)),
        DeValue::Array(entries) => {
            DeValue::Array(entries.into_iter().map(|entry| shift_value_spans(entry, start)).collect())
        }
        other => other,
    };
    Spanned::new(span, value)
}
