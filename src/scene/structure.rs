//! Mistakes in a scene that show before and after its keys are read: brackets, kinds and the lengths of lists.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::nearest;

/// A mistake: the bytes that are wrong, what is wrong with them, and what to do.
pub(super) type Mistake = (Range<usize>, String, Option<String>);

/// A list in place of the table of all materials, or a table in place of the list of all objects or lights.
pub(super) fn misplaced_whole(key: &str, value: &Spanned<DeValue>) -> Option<Mistake> {
    match (key, value.get_ref()) {
        ("material", DeValue::Array(_)) => {
            mistake(value, "`material` is a table, not a list", "write [material.NAME] for each")
        }
        ("object" | "light", DeValue::Table(_)) => {
            mistake(value, format!("`{key}` is a list of tables"), format!("write [[{key}]] for each"))
        }
        _ => None,
    }
}

/// A list in place of a section, or in it a material, shape, step, filter or model without exactly one kind.
pub(super) fn misplaced(path: &[&str], value: &Spanned<DeValue>) -> Vec<Mistake> {
    let found = match (path, value.get_ref()) {
        ([key @ ("camera" | "film" | "render")], DeValue::Array(_)) => {
            mistake(value, format!("`{key}` is a table, not a list"), format!("write [{key}]"))
        }
        (["material", _], _) => one_of(value, &MATERIAL),
        (["film"], DeValue::Table(film)) => {
            film.get("filter").filter(|filter| filter.get_ref().is_table()).and_then(|filter| one_of(filter, &FILTER))
        }
        (["render"], DeValue::Table(render)) => render.get("model").and_then(unknown_model),
        (["object"], DeValue::Table(object)) => return misplaced_in_object(object),
        (["light"], DeValue::Table(light)) => {
            let turned = light.get("environment").and_then(|light| light.get_ref().as_table());
            return turned.map_or_else(Vec::new, |light| misplaced_steps(light.get("transform")));
        }
        _ => None,
    };
    found.into_iter().collect()
}

fn mistake(value: &Spanned<DeValue>, message: impl Into<String>, help: impl Into<String>) -> Option<Mistake> {
    Some((value.span(), message.into(), Some(help.into())))
}

fn misplaced_in_object(object: &DeTable) -> Vec<Mistake> {
    let shape = object.get("shape").and_then(|shape| one_of(shape, &SHAPE));
    let instances = object.get("instances").and_then(|instances| instances.get_ref().as_array());
    let all = object.get("transform").into_iter().chain(instances.into_iter().flat_map(|all| all.iter()));
    shape.into_iter().chain(misplaced_steps(all)).collect()
}

/// Steps of transforms without exactly one kind.
fn misplaced_steps<'a, 't: 'a>(transforms: impl IntoIterator<Item = &'a Spanned<DeValue<'t>>>) -> Vec<Mistake> {
    let steps = transforms.into_iter().filter_map(|steps| steps.get_ref().as_array()).flat_map(|steps| steps.iter());
    // What is wrong with one step that is no table is mostly wrong with all.
    let mut no_table = false;
    let steps = steps.filter(|step| step.get_ref().is_table() || !std::mem::replace(&mut no_table, true));
    steps.filter_map(|step| one_of(step, &STEP)).collect()
}

/// A `render.model` that there is not.
fn unknown_model(value: &Spanned<DeValue>) -> Option<Mistake> {
    const WORDS: [&str; 3] = ["auto", "rgb", "hero"];
    const FORMS: &str = "`model` is a word in quotes or { bands = .. }";
    const KNOWN: &str = "known here: \"auto\", \"rgb\", \"hero\" or { bands = 16 }";
    match value.get_ref() {
        DeValue::String(word) if WORDS.contains(&word.as_ref()) => None,
        DeValue::String(word) => {
            let help = match nearest(word, WORDS.into_iter().chain(["bands"])) {
                Some("bands") => "write { bands = 16 }".into(),
                Some(near) => format!("did you mean \"{near}\"?"),
                None => KNOWN.into(),
            };
            mistake(value, format!("`model` cannot be \"{word}\""), help)
        }
        DeValue::Table(table) if table.is_empty() => mistake(value, FORMS, KNOWN),
        DeValue::Table(table) => {
            let (key, _) = table.iter().find(|(key, _)| key.get_ref() != "bands")?;
            let word = key.get_ref();
            let help = match nearest(word, WORDS.into_iter().chain(["bands"])) {
                Some("bands") => "did you mean `bands`?".into(),
                Some(near) => format!("write model = \"{near}\""),
                None => KNOWN.into(),
            };
            Some((key.span(), format!("unknown key `{word}`"), Some(help)))
        }
        _ => mistake(value, FORMS, KNOWN),
    }
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

const FILTER: OneOf =
    OneOf { name: "a filter", example: "{ gaussian = { sigma = 0.5 } }", apart: "leave one of them out" };

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

/// Every list in place of a table, which the reader fills from a list by position; `path` leads to the section.
pub(super) fn listed(path: &[&str], section: &Spanned<DeValue>) -> Vec<Mistake> {
    lists(path, section, &|path, value, _| {
        let is_table = match path {
            ["material", _, _] | ["object", "shape", _] | [.., "transform" | "instances", "rotate"] => true,
            ["object", "normal_map" | "bump_map"] => true,
            ["light", "environment" | "point" | "spot" | "sun"] => true,
            ["camera", "lens"] | ["film", "filter", _] => true,
            [.., key] => matches!(*key, "sellmeier" | "abbe"),
            [] => false,
        };
        let key = path.last().filter(|_| is_table)?;
        Some((value.span(), format!("`{key}` is a table, {{ .. }}, not a list"), None))
    })
}

/// Every list with more entries than are read: the reader drops what comes after the last entry it wants.
pub(super) fn surplus(path: &[&str], section: &Spanned<DeValue>) -> Vec<Mistake> {
    lists(path, section, &|path, value, entries| {
        let key = *path.last()?;
        let (one, wanted, help) = match key {
            "b" | "c" | "checker" => return None,
            "samples" => ("an entry of `samples`", 2, Some("write [wavelength in nm, value]")),
            "lines" => ("an entry of `lines`", 2, Some("write [wavelength in nm, power]")),
            "repeat" => ("`repeat`", 2, Some("write [along u, along v]")),
            "cauchy" => ("`cauchy`", 2, Some("write [A, B] of n = A + B / wavelength^2")),
            "faces" => ("a face", 3, Some("cut faces with more corners into triangles")),
            "points" => ("a point", 3, None),
            "normals" => ("a normal", 3, None),
            "uv" => ("an entry of `uv`", 2, None),
            "shift" => ("`shift`", 2, Some("write [right, up] in heights of the image")),
            "crop" => ("`crop`", 4, Some("write [first column, first row, width, height]")),
            key => (&*format!("`{key}`"), 3, None),
        };
        let numbers = entries.iter().all(|entry| matches!(entry.get_ref(), DeValue::Integer(_) | DeValue::Float(_)));
        (numbers && entries.len() > wanted).then(|| {
            let message = format!("{one} is a list of {wanted} numbers, not one of {}", entries.len());
            (value.span(), message, help.map(str::to_owned))
        })
    })
}

type Entries<'t> = [Spanned<DeValue<'t>>];
/// Looks at a list, knowing the keys that lead to it, and its entries.
type Look<'l> = &'l dyn Fn(&[&str], &Spanned<DeValue>, &Entries) -> Option<Mistake>;

/// The mistakes in the lists of a section.
fn lists(path: &[&str], section: &Spanned<DeValue>, look: Look) -> Vec<Mistake> {
    let mut found = Vec::new();
    look_into(section, &mut path.to_vec(), look, &mut found);
    found
}

fn look_into<'t>(value: &'t Spanned<DeValue>, path: &mut Vec<&'t str>, look: Look, found: &mut Vec<Mistake>) {
    match value.get_ref() {
        DeValue::Table(table) => {
            for (key, value) in table {
                path.push(key.get_ref());
                look_into(value, path, look, found);
                path.pop();
            }
        }
        DeValue::Array(entries) => match look(path, value, entries) {
            Some(mistake) => found.push(mistake),
            None => entries.iter().for_each(|entry| look_into(entry, path, look, found)),
        },
        _ => {}
    }
}
