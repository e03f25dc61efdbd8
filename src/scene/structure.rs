//! Mistakes in a scene that show before and after its keys are read: brackets, kinds and the lengths of lists.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A mistake: the bytes that are wrong, what is wrong with them, and what to do.
pub(super) type Mistake = (Range<usize>, String, Option<String>);

/// A list in place of a table or the reverse, or a material, shape or step without exactly one kind.
pub(super) fn misplaced(document: &DeTable) -> Option<Mistake> {
    document.iter().find_map(|(key, value)| match (key.get_ref().as_ref(), value.get_ref()) {
        (key @ ("camera" | "film" | "render"), DeValue::Array(_)) => {
            mistake(value, format!("`{key}` is a table, not a list"), format!("write [{key}]"))
        }
        ("material", DeValue::Array(_)) => {
            mistake(value, "`material` is a table, not a list", "write [material.NAME] for each")
        }
        (key @ ("object" | "light"), DeValue::Table(_)) => {
            mistake(value, format!("`{key}` is a list of tables"), format!("write [[{key}]] for each"))
        }
        ("material", DeValue::Table(materials)) => materials.values().find_map(|material| one_of(material, &MATERIAL)),
        ("object", DeValue::Array(objects)) => objects.iter().find_map(|object| misplaced_in_object(object.get_ref())),
        _ => None,
    })
}

fn mistake(value: &Spanned<DeValue>, message: impl Into<String>, help: impl Into<String>) -> Option<Mistake> {
    Some((value.span(), message.into(), Some(help.into())))
}

fn misplaced_in_object(object: &DeValue) -> Option<Mistake> {
    let DeValue::Table(object) = object else { return None };
    let shape = object.get("shape").and_then(|shape| one_of(shape, &SHAPE));
    let steps = || object.get("transform").and_then(|steps| steps.get_ref().as_array());
    shape.or_else(|| steps()?.iter().find_map(|step| one_of(step, &STEP)))
}

/// A table with one key, its kind.
struct OneOf {
    name: &'static str,
    example: &'static str,
    /// What to do with a second kind.
    apart: &'static str,
}

const MATERIAL: OneOf = OneOf {
    name: "a material",
    example: "diffuse = { reflectance = 0.7 }",
    apart: "give each kind its own [material.NAME]",
};
const SHAPE: OneOf = OneOf {
    name: "a shape",
    example: "shape.sphere = { center = [0, 1, 0], radius = 1 }",
    apart: "start another [[object]] for the second shape",
};
const STEP: OneOf = OneOf {
    name: "a step of a transform",
    example: "{ translate = [0, 1, 0] }",
    apart: "write one step after the other: [{ scale = 2 }, { translate = [0, 1, 0] }]",
};

fn one_of(value: &Spanned<DeValue>, choice: &OneOf) -> Option<Mistake> {
    let example = || format!("such as {}", choice.example);
    let DeValue::Table(table) = value.get_ref() else {
        return mistake(value, format!("{} is a table with one kind", choice.name), example());
    };
    let mut keys: Vec<_> = table.keys().collect();
    keys.sort_by_key(|key| key.span().start);
    match keys.as_slice() {
        [] => mistake(value, format!("{} needs a kind", choice.name), example()),
        [_] => None,
        [_, second, ..] => {
            Some((second.span(), format!("{} has exactly one kind", choice.name), Some(choice.apart.into())))
        }
    }
}

/// A list in place of a table, or with more entries than are read.
///
/// The reader fills a table from a list by position, and drops what comes after the last entry it wants.
pub(super) fn surplus(document: &DeTable) -> Option<Mistake> {
    surplus_in(document, &mut Vec::new())
}

fn surplus_in<'t>(table: &'t DeTable, path: &mut Vec<&'t str>) -> Option<Mistake> {
    table.iter().find_map(|(key, value)| {
        path.push(key.get_ref());
        let found = surplus_at(value, path);
        path.pop();
        found
    })
}

fn surplus_at<'t>(value: &'t Spanned<DeValue>, path: &mut Vec<&'t str>) -> Option<Mistake> {
    let entries = match value.get_ref() {
        DeValue::Table(table) => return surplus_in(table, path),
        DeValue::Array(entries) => entries,
        _ => return None,
    };
    let is_table = match path.as_slice() {
        ["material", _, _] | ["object", "shape", _] | ["object", "transform", "rotate"] | ["light", _] => true,
        [.., key] => matches!(*key, "sellmeier" | "abbe"),
        [] => false,
    };
    let key = *path.last()?;
    if is_table {
        return Some((value.span(), format!("`{key}` is a table, {{ .. }}, not a list"), None));
    }
    let (one, wanted, help) = match key {
        "b" | "c" => return None,
        "samples" => ("an entry of `samples`", 2, Some("write [wavelength in nm, value]")),
        "cauchy" => ("`cauchy`", 2, Some("write [A, B] of n = A + B / wavelength^2")),
        "faces" => ("a face", 3, Some("cut faces with more corners into triangles")),
        "points" => ("a point", 3, None),
        key => (&*format!("`{key}`"), 3, None),
    };
    let numbers = entries.iter().all(|entry| matches!(entry.get_ref(), DeValue::Integer(_) | DeValue::Float(_)));
    if numbers && entries.len() > wanted {
        let message = format!("{one} is a list of {wanted} numbers, not one of {}", entries.len());
        return Some((value.span(), message, help.map(str::to_owned)));
    }
    entries.iter().find_map(|entry| surplus_at(entry, path))
}
