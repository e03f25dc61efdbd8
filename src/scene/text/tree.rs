//! The content of a text as TOML, with places in the joined texts.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::mistake::Mistake;
use super::syntax::explain;

pub(super) type Key<'d> = Spanned<DeString<'d>>;
pub(super) type Node<'d> = Spanned<DeValue<'d>>;

pub(super) fn word<'k>(key: &'k Key) -> &'k str {
    key.get_ref()
}

/// Parses a text that starts at a place of the joined texts.
pub(in crate::scene) fn parsed(text: &str, start: usize) -> Result<DeTable<'_>, Mistake> {
    match DeTable::parse(text) {
        Ok(table) if start == 0 => Ok(table.into_inner()),
        Ok(table) => Ok(moved(table.into_inner(), start)),
        Err(error) => {
            let mistake = explain(text, &error);
            Err(Mistake { span: by(mistake.span, start), ..mistake })
        }
    }
}

fn by(span: Range<usize>, start: usize) -> Range<usize> {
    span.start + start..span.end + start
}

fn moved(table: DeTable, start: usize) -> DeTable {
    let entries = table.into_iter().map(|(key, value)| {
        let span = by(key.span(), start);
        (Spanned::new(span, key.into_inner()), moved_value(value, start))
    });
    entries.collect()
}

fn moved_value(value: Node, start: usize) -> Node {
    let span = by(value.span(), start);
    let value = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(moved(table, start)),
        DeValue::Array(entries) => DeValue::Array(entries.into_iter().map(|entry| moved_value(entry, start)).collect()),
        other => other,
    };
    Spanned::new(span, value)
}
