//! A document read section by section, so that a mistake in one hides none in another.

use std::collections::BTreeMap;

use serde::de::{DeserializeOwned, IgnoredAny};
use toml::Spanned;
use toml::de::{DeTable, DeValue, ValueDeserializer};

use super::description::{Description, RenderText};
use super::repair::{Repair, STAND_IN};
use super::structure::{self, Mistake};
use super::suggest::{meant, suggestion};
use super::wording::{self, NAMELESS};
use crate::material::Material;
use crate::spectrum::Curve;

/// The tables of a scene.
const SECTIONS: [&str; 6] = ["camera", "film", "render", "material", "object", "light"];
/// Most attempts at a section: mistakes in it and values that might stand in.
const MOST_REPAIRS: usize = 200;

/// What a document says, and all that is wrong with its words.
pub(super) fn read(text: &str, document: &Spanned<DeTable>) -> Description {
    let table = document.get_ref();
    let mut reader = Reader { text, document: table, nameless: false, mistakes: Vec::new() };
    reader.sections_there();
    let render = table.get("render").map_or(Some(RenderText::default()), |value| reader.section(&["render"], value));
    Description {
        camera: table.get("camera").and_then(|value| reader.section(&["camera"], value)),
        film: table.get("film").and_then(|value| reader.section(&["film"], value)),
        // A length that is misspelt is not missing as well.
        render: render.unwrap_or(RenderText { meters_per_unit: Some(1.0), ..RenderText::default() }),
        material: table.get("material").map_or_else(BTreeMap::new, |value| reader.materials(value)),
        object: table.get("object").map_or_else(Vec::new, |value| reader.list("object", value)),
        light: table.get("light").map_or_else(Vec::new, |value| reader.list("light", value)),
        nameless: reader.nameless,
        mistakes: reader.mistakes,
    }
}

struct Reader<'t> {
    text: &'t str,
    document: &'t DeTable<'t>,
    nameless: bool,
    mistakes: Vec<Mistake>,
}

impl<'t> Reader<'t> {
    /// That all tables are known, and those there that every scene has.
    fn sections_there(&mut self) {
        let mut missing: Vec<&str> =
            ["camera", "film"].into_iter().filter(|key| !self.document.contains_key(*key)).collect();
        for key in self.document.keys().filter(|key| !SECTIONS.contains(&key.get_ref().as_ref())) {
            let word = key.get_ref().as_ref();
            let help = Some(suggestion(word, word, &SECTIONS));
            self.mistakes.push((key.span(), format!("unknown key `{word}`"), help));
            missing.retain(|section| meant(word, word, &SECTIONS) != Some(section));
        }
        if !missing.is_empty() {
            let missing: Vec<_> = missing.into_iter().map(|section| format!("no [{section}]")).collect();
            let message = format!("the scene has {}", missing.join(" and "));
            self.mistakes.push((0..0, message, Some("every scene has [camera] and [film]".into())));
        }
    }

    fn materials(&mut self, value: &Spanned<DeValue<'t>>) -> BTreeMap<String, Option<Material<Curve>>> {
        let (before, misplaced) = (self.mistakes.len(), structure::misplaced_whole("material", value));
        self.mistakes.extend(misplaced);
        let materials = self.named(value);
        self.nameless =
            !value.get_ref().is_table() || self.mistakes[before..].iter().any(|mistake| mistake.1 == NAMELESS);
        materials
    }

    fn named(&mut self, value: &Spanned<DeValue<'t>>) -> BTreeMap<String, Option<Material<Curve>>> {
        match value.get_ref() {
            DeValue::Table(table) => {
                let named = table.iter().map(|(name, value)| {
                    let name = name.get_ref().to_string();
                    let material = self.section(&["material", &name], value);
                    (name, material)
                });
                named.collect()
            }
            DeValue::Array(_) => BTreeMap::new(),
            _ => self
                .section::<BTreeMap<String, IgnoredAny>>(&["material"], value)
                .map_or_else(BTreeMap::new, |_| BTreeMap::new()),
        }
    }

    fn list<T: DeserializeOwned>(&mut self, key: &str, value: &Spanned<DeValue<'t>>) -> Vec<Option<T>> {
        self.mistakes.extend(structure::misplaced_whole(key, value));
        match value.get_ref() {
            DeValue::Array(entries) => entries.iter().map(|entry| self.section(&[key], entry)).collect(),
            DeValue::Table(_) => Vec::new(),
            _ => self.section::<Vec<IgnoredAny>>(&[], value).map_or_else(Vec::new, |_| Vec::new()),
        }
    }

    /// What a section says, if nothing is wrong with it; `path` are the keys that lead to it.
    fn section<T: DeserializeOwned>(&mut self, path: &[&str], value: &Spanned<DeValue<'t>>) -> Option<T> {
        let before = self.mistakes.len();
        let mut repair = Repair::of(value.clone());
        let misplaced = structure::misplaced(path, value);
        let cleared = misplaced.iter().all(|mistake| repair.clear(&mistake.0));
        self.mistakes.extend(misplaced);
        if !cleared {
            return None;
        }
        let read = self.repaired(path, &mut repair)?;
        let lists = [structure::listed(path, &repair.value), structure::surplus(path, &repair.value)].concat();
        self.mistakes.extend(lists.into_iter().filter(|mistake| mistake.0 != STAND_IN));
        Some(read).filter(|_| self.mistakes.len() == before)
    }

    /// Reads a section again and again, each time without the mistake that was found before.
    fn repaired<T: DeserializeOwned>(&mut self, path: &[&str], repair: &mut Repair) -> Option<T> {
        for _ in 0..MOST_REPAIRS {
            let error = match T::deserialize(ValueDeserializer::from(repair.value.clone())) {
                Ok(read) => return Some(read),
                Err(error) => error,
            };
            let mut span = error.span().unwrap_or_default();
            let mut said = error.message().lines().next().unwrap_or_default();
            if span != STAND_IN && !repair.follows(&span, said) {
                let lists = structure::listed(path, &repair.value).into_iter();
                let listed = lists.into_iter().find(|(list, ..)| list.start <= span.start && span.end <= list.end);
                if let Some((list, ..)) = &listed {
                    (span, said) = (list.clone(), "");
                }
                self.mistakes.push(listed.unwrap_or_else(|| wording::explain(self.text, self.document, &error)));
            }
            if !repair.mend(&span, said) {
                return None;
            }
        }
        None
    }
}
