//! Values that replace those of a scene, such as `film.width=320` on a command line.

use std::borrow::Cow;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::include::INCLUDE;
use super::mistake::Mistake;
use super::suggest::suggestion;
use super::tree::{Key, Node, key_text, parse_toml};
use super::variables::{FRAME, SET};
use crate::error::nearest;

/// The path of a key, and its value.
struct Setting<'d> {
    path: Vec<Key<'d>>,
    value: Node<'d>,
}

/// Puts the value of a setting in its place in a scene with these sections. The setting starts at a place of the joined
/// texts.
pub(in crate::scene) fn set<'d>(
    root: &mut DeTable<'d>,
    text: &'d str,
    start: usize,
    sections: &[&str],
) -> Result<(), Mistake> {
    let Setting { mut path, value } = parse_setting(text, start)?;
    if let Some(key) = path.first().filter(|key| key_text(key) == INCLUDE) {
        let help = Some("write it into the scene; a scene may come from standard input".into());
        return Err(Mistake { span: key.span(), message: "`include` cannot be set".into(), help });
    }
    if let [name] = path.as_slice() {
        let is_value = !value.get_ref().is_table() && !value.get_ref().is_array();
        match variables(root) {
            variables
                if key_text(name) == FRAME || variables.is_some_and(|known| known.contains_key(key_text(name))) =>
            {
                path.insert(0, Spanned::new(name.span(), SET.into()));
            }
            variables if is_value && !root.contains_key(key_text(name)) && !sections.contains(&key_text(name)) => {
                return Err(unknown_variable(name, &names(variables), sections));
            }
            _ => {}
        }
    }
    if let [section, name, _, ..] = path.as_slice()
        && section.get_ref() == "material"
    {
        let materials = root.get("material").and_then(|materials| materials.get_ref().as_table());
        let known = names(materials);
        if !known.contains(&key_text(name)) {
            let message = format!("there is no material named {:?}", key_text(name));
            let help = match nearest(key_text(name), known) {
                Some(near) => format!("did you mean {near:?}?"),
                None => format!("a new material is set as a whole: material.{}={{ .. }}", key_text(name)),
            };
            return Err(Mistake { span: name.span(), message, help: Some(help) });
        }
    }
    put(root, &path, value)
}

fn variables<'t, 'd>(root: &'t DeTable<'d>) -> Option<&'t DeTable<'d>> {
    root.get(SET)?.get_ref().as_table()
}

fn names<'t>(table: Option<&'t DeTable>) -> Vec<&'t str> {
    table.into_iter().flat_map(DeTable::keys).map(key_text).collect()
}

fn unknown_variable(name: &Key, known: &[&str], sections: &[&str]) -> Mistake {
    let key_text = key_text(name);
    let help = match nearest(key_text, known.iter().chain(sections).copied()) {
        Some(near) => format!("did you mean `{near}`?"),
        None if known.is_empty() => {
            "a scene defines its variables in [set]; other values have a path: film.width=320".into()
        }
        None => format!("known here: {}", known.join(", ")),
    };
    Mistake { span: name.span(), message: format!("there is no variable `{key_text}`"), help: Some(help) }
}

/// Parses `KEY=VALUE`. A value that is not TOML is taken as a text.
fn parse_setting(text: &str, start: usize) -> Result<Setting<'_>, Mistake> {
    let whole = start..start + text.len();
    let refuse = |message: &str| {
        let help = Some("for instance: film.width=320".into());
        Err(Mistake { span: whole.clone(), message: message.into(), help })
    };
    let Some(equals_position) = equals_position(text) else { return refuse("a setting is a key, `=` and a value") };
    if text[..equals_position].trim().is_empty() {
        return refuse("a setting is a key, `=` and a value");
    }
    let key = format!("{}=0", &text[..equals_position]);
    // Where the part begins that is parsed with its value: of words with spaces, only the last one is.
    let (path, tail): (Option<Vec<Key>>, _) =
        match (parse_toml(&key, start), split_at_dots(&text[..equals_position], start)) {
            (Ok(table), _) => (path(&table).map(|path| path.into_iter().map(owned_key).collect()), 0),
            (Err(_), Some(path)) => {
                let last = path.len() - 1;
                (Some(path), last)
            }
            (Err(_), None) => {
                let message = format!("`{}` is not the path of a key", text[..equals_position].trim());
                let help = Some("a path is words joined by dots, such as film.width".into());
                return Err(Mistake { span: start..start + equals_position, message, help });
            }
        };
    let Some(path) = path else { return refuse("a setting is one key, `=` and its value") };
    let (before, value) = text.split_at(equals_position + 1);
    let at = start + before.len() + (value.len() - value.trim_start().len());
    let value = value.trim();
    let from = if tail == 0 { start } else { path[tail].span().start };
    match parse_toml(&text[from - start..], from) {
        Ok(mut table) => match take_value(&mut table, &path[tail..]) {
            Some(value) => Ok(Setting { path, value }),
            None => refuse("a setting is one key, `=` and its value"),
        },
        Err(mistake) if value.is_empty() || is_meant_as_toml(value) => Err(mistake),
        Err(_) => {
            let value = Spanned::new(at..at + value.len(), DeValue::String(Cow::Borrowed(value)));
            Ok(Setting { path, value })
        }
    }
}

fn owned_key<'k>(key: &Key) -> Key<'k> {
    Spanned::new(key.span(), key_text(key).to_string().into())
}

/// Splits a path at its dots, if names in it have spaces or other characters that TOML wants quotes for. Returns none
/// if there are quotes, or if the last word, which is a key, needs them.
fn split_at_dots<'k>(path: &str, start: usize) -> Option<Vec<Key<'k>>> {
    let (mut keys, mut next) = (Vec::new(), start);
    for part in path.split('.') {
        let key_text = part.trim();
        let at = next + (part.len() - part.trim_start().len());
        keys.push(Spanned::new(at..at + key_text.len(), key_text.to_owned().into()));
        next += part.len() + 1;
    }
    let is_bare = |letter: char| letter.is_ascii_alphanumeric() || letter == '_' || letter == '-';
    let is_plain = |key: &Key| {
        !key_text(key).is_empty() && !key_text(key).contains(['"', '\'', '#', '[', ']', '{', '}', '\n', '\r'])
    };
    let last = keys.last().is_some_and(|key| key_text(key).chars().all(is_bare));
    (last && keys.iter().all(is_plain)).then_some(keys)
}

/// Returns the position of the `=` that ends a key, which may be quoted.
fn equals_position(text: &str) -> Option<usize> {
    let (mut quote, mut is_escaped) = (None, false);
    text.char_indices().find_map(|(at, letter)| {
        match (quote, letter) {
            _ if is_escaped => is_escaped = false,
            (Some('"'), '\\') => is_escaped = true,
            (Some(open), _) if letter == open => quote = None,
            (None, '"' | '\'') => quote = Some(letter),
            (None, '=') => return Some(at),
            _ => {}
        }
        None
    })
}

/// Returns whether a value is meant as TOML: a list, a table, a quoted text, or a number that is not in the form of
/// TOML.
fn is_meant_as_toml(value: &str) -> bool {
    let is_number = value.starts_with(|first: char| first.is_ascii_digit() || "+-.".contains(first))
        && value.parse::<f64>().is_ok();
    value.starts_with(['[', '{', '"', '\'']) || is_number
}

/// Returns the keys that lead to a number, if each is the only one of its table.
fn path<'t, 'd>(table: &'t DeTable<'d>) -> Option<Vec<&'t Key<'d>>> {
    let (mut path, mut table) = (Vec::new(), table);
    loop {
        let (key, value) = table.iter().next().filter(|_| table.len() == 1)?;
        path.push(key);
        match value.get_ref() {
            DeValue::Table(inner) => table = inner,
            _ => return Some(path),
        }
    }
}

/// Returns the value at the end of a path, if there is nothing beside it.
fn take_value<'d>(table: &mut DeTable<'d>, path: &[Key]) -> Option<Node<'d>> {
    let (key, rest) = path.split_first()?;
    let mut value = Some(table.remove(key_text(key))?).filter(|_| table.is_empty())?;
    match (value.get_mut(), rest) {
        (_, []) => Some(value),
        (DeValue::Table(inner), rest) => take_value(inner, rest),
        _ => None,
    }
}

fn put<'d>(table: &mut DeTable<'d>, path: &[Key<'d>], value: Node<'d>) -> Result<(), Mistake> {
    let Some((key, rest)) = path.split_first() else { return Ok(()) };
    if rest.is_empty() {
        // The key is replaced as well, so that a mistake in the value is reported here.
        table.remove(key_text(key));
        table.insert(key.clone(), value);
        return Ok(());
    }
    let empty_table = || Spanned::new(key.span(), DeValue::Table(DeTable::new()));
    put_into(table.entry(key.clone()).or_insert_with(empty_table), key, rest, value)
}

/// Puts a value into the value of a key.
fn put_into<'d>(node: &mut Node<'d>, key: &Key, path: &[Key<'d>], value: Node<'d>) -> Result<(), Mistake> {
    let Some((next, rest)) = path.split_first() else {
        *node = value;
        return Ok(());
    };
    match node.get_mut() {
        DeValue::Table(table) => put(table, path, value),
        DeValue::Array(entries) => {
            let number = position(key_text(key), entries, next)?;
            put_into(&mut entries.as_mut()[number], next, rest, value)
        }
        _ => {
            let message = format!("`{}` is not a table here, so it has no `{}`", key_text(key), key_text(next));
            let help = format!("set `{}` itself", key_text(key));
            Err(Mistake { span: next.span(), message, help: Some(help) })
        }
    }
}

/// Returns the index of the entry of a list that has this name or number. Numbers count from 1.
fn position(list: &str, entries: &[Node], key: &Key) -> Result<usize, Mistake> {
    let key_text: &str = key_text(key);
    let names = entries.iter().map(|entry| entry.get_ref().as_table()?.get("name")?.get_ref().as_str());
    let names: Vec<Option<&str>> = names.collect();
    let named: Vec<usize> = (0..names.len()).filter(|&number| names[number] == Some(key_text)).collect();
    let refuse = |span: Range<usize>, message: String, help: String| Err(Mistake { span, message, help: Some(help) });
    match named.as_slice() {
        [number] => return Ok(*number),
        [] => {}
        several => {
            let numbers: Vec<String> = several.iter().map(|number| format!("{list}.{}", number + 1)).collect();
            let message = format!("{} entries of `{list}` are named {key_text:?}", several.len());
            return refuse(key.span(), message, format!("refer to each by its number: {}", numbers.join(", ")));
        }
    }
    if let Some(number) = key_text.parse::<usize>().ok().and_then(|number| number.checked_sub(1))
        && number < entries.len()
    {
        return Ok(number);
    }
    let known: Vec<&str> = names.into_iter().flatten().collect();
    let counted = format!("entries are counted from 1 to {}", entries.len());
    let help = match known.as_slice() {
        _ if entries.is_empty() => "the list is empty".into(),
        [] => counted,
        _ if key_text.parse::<usize>().is_ok() => counted,
        known => suggestion(key_text, key_text, known),
    };
    refuse(key.span(), format!("`{list}` has no entry `{key_text}`"), help)
}
