//! Variables of a scene: `[set] angle = 30`, and `"$angle"` wherever that value is meant.

use std::collections::{BTreeMap, BTreeSet};

use toml::de::{DeTable, DeValue};

use super::mistake::Mistake;
use super::tree::{Key, Node, key_text};
use super::value::MANY_MISTAKES;
use crate::error::nearest;

/// The section of the variables.
pub(in crate::scene) const SET: &str = "set";
/// The variable that the frame number sets.
pub(super) const FRAME: &str = "frame";

/// The variables of a scene.
#[derive(Default)]
struct Variables<'d> {
    /// Values without mistakes, by name.
    values: BTreeMap<String, Node<'d>>,
    /// All names, including those of values with mistakes.
    known: BTreeSet<String>,
    used: BTreeSet<String>,
    mistakes: Vec<Mistake>,
}

/// Removes the variables from a scene and inserts their values where they are used. Returns the names of those that are
/// not used. A mistake in a value is reported where the variable is defined.
pub(in crate::scene) fn substitute_variables(
    root: &mut DeTable,
    sections: &[&str],
) -> Result<Vec<String>, Vec<Mistake>> {
    let mut variables = Variables::default();
    if let Some((key, given)) = root.remove_entry(SET) {
        match given.into_inner() {
            DeValue::Table(table) => {
                table.into_iter().for_each(|(name, value)| variables.define(&name, value, sections));
            }
            _ => variables.report(
                &key,
                "`set` is the table of variables".into(),
                "write [set], with the variables below it".into(),
            ),
        }
    }
    variables.fill_table(root);
    if !variables.mistakes.is_empty() {
        return Err(variables.mistakes);
    }
    // The frame number is also used in the names of files.
    let is_unused = |name: &String| !variables.used.contains(name) && name != FRAME;
    Ok(variables.known.into_iter().filter(is_unused).collect())
}

impl<'d> Variables<'d> {
    fn report(&mut self, place: &toml::Spanned<impl Sized>, message: String, help: String) {
        self.mistakes.push(Mistake { span: place.span(), message, help: Some(help) });
    }

    fn define(&mut self, key: &Key<'d>, mut value: Node<'d>, sections: &[&str]) {
        let name = key_text(key);
        self.known.insert(name.to_owned());
        if sections.contains(&name) {
            let message = format!("`{name}` is a section of the scene, not a variable");
            self.report(key, message, "give the variable another name".into());
        } else if !is_name(name) {
            let message = format!("{name:?} cannot name a variable");
            self.report(key, message, "a name starts with a letter or _, followed by letters, digits, _ and -".into());
        } else if let Some(other) = variable_in(&value) {
            let message = format!("the variable `{name}` refers to another, `{}`", variable(other).unwrap_or_default());
            self.report(&value, message, "give each variable a value of its own".into());
        } else {
            self.fill_value(&mut value);
            self.values.insert(name.to_owned(), value);
        }
    }

    fn fill_table(&mut self, table: &mut DeTable<'d>) {
        for (_, value) in table.iter_mut() {
            self.fill_value(value);
        }
    }

    fn fill_value(&mut self, node: &mut Node<'d>) {
        match node.get_mut() {
            DeValue::Table(table) => self.fill_table(table),
            DeValue::Array(entries) => entries.iter_mut().for_each(|entry| self.fill_value(entry)),
            DeValue::String(text) => {
                if let Some(plain) = text.strip_prefix("$$") {
                    *text = format!("${plain}").into();
                } else if let Some(name) = variable(text).map(str::to_owned) {
                    match self.values.get(&name) {
                        Some(value) => *node = value.clone(),
                        None if self.known.contains(&name) => {}
                        None => self.unknown(node, &name),
                    }
                    self.used.insert(name);
                }
            }
            _ => {}
        }
    }

    fn unknown(&mut self, place: &Node, name: &str) {
        let message = format!("there is no variable `{name}`");
        if self.mistakes.len() >= MANY_MISTAKES {
            return self.mistakes.push(Mistake { span: place.span(), message, help: None });
        }
        let near = nearest(name, self.known.iter().map(String::as_str));
        let help = match near {
            Some(near) => format!("did you mean \"${near}\"?"),
            None if name == FRAME => "give the number of the frame: --frame 1, or [set] frame = 1".into(),
            None => format!("give it a value: [set] {name} = .."),
        };
        self.report(place, message, help);
    }
}

/// Returns the name of the variable that a text stands for.
fn variable(text: &str) -> Option<&str> {
    text.strip_prefix('$').filter(|name| is_name(name))
}

fn is_name(name: &str) -> bool {
    let may_follow = |letter: char| letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-');
    name.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_') && name.chars().all(may_follow)
}

/// Returns a text within a value that stands for a variable.
fn variable_in<'v>(value: &'v Node) -> Option<&'v str> {
    match value.get_ref() {
        DeValue::String(text) => Some(&**text).filter(|text| variable(text).is_some()),
        DeValue::Array(entries) => entries.iter().find_map(variable_in),
        DeValue::Table(table) => table.values().find_map(variable_in),
        _ => None,
    }
}
