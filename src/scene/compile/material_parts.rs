//! Materials that are made of others, whose names are resolved here.

use std::collections::{BTreeMap, BTreeSet};

use super::material::{MaterialDraft, MaterialDrafts};
use crate::error::nearest;
use crate::material::{Mask, Material, Mix, Part};
use crate::scene::text::{Value, and_more};
use crate::spectrum::Curve;

/// Materials by name. A material with a mistake has an entry without a value.
pub(super) type Materials<'d> = BTreeMap<&'d str, Option<Material<Curve>>>;

/// A search for the materials that others are made of.
struct Search<'s, 'd> {
    drafts: &'s BTreeMap<&'d str, Option<MaterialDraft<'d, Curve>>>,
    /// The materials that the current one is a part of, the outermost first.
    ancestors: Vec<&'d str>,
    /// Materials made of themselves, for which the mistake is recorded.
    circular: BTreeSet<&'d str>,
    /// Number of parts of the outermost material so far, each counted as often as it is named.
    parts: usize,
    /// Whether it has been reported that a material is made of too many.
    is_too_large: bool,
}

/// Maximum number of materials that one is made of, and their maximum depth in one another. Surfaces evaluate each part
/// where they are hit, so a part that is named twice counts twice.
const MAX_PARTS: usize = 1000;
const MAX_DEPTH: usize = 64;

/// Maximum number of materials that a message names.
const MAX_NAMES: usize = 100;

/// Returns every material with its parts.
pub(super) fn resolve_parts<'d>(drafts: &MaterialDrafts<'d>) -> Materials<'d> {
    let (ancestors, circular) = (Vec::new(), BTreeSet::new());
    let mut search = Search { drafts: &drafts.by_name, ancestors, circular, parts: 0, is_too_large: false };
    let mut whole = |name| {
        search.parts = 0;
        search.resolve(name)
    };
    drafts.by_name.keys().map(|name| (*name, whole(name))).collect()
}

impl<'d> Search<'_, 'd> {
    /// Returns the material of a name with its parts.
    fn resolve(&mut self, name: &'d str) -> Option<Material<Curve>> {
        let draft = self.drafts.get(name)?.as_ref().filter(|_| !self.circular.contains(name))?;
        self.ancestors.push(name);
        let whole = match draft {
            MaterialDraft::Whole(material) => Some(material.clone()),
            MaterialDraft::Mix { parts, amount } => {
                let [first, second] = parts.map(|part| self.part("mix", part));
                let amount = amount.clone();
                first.zip(second).map(|(first, second)| Material::Mix(Mix { materials: [first, second], amount }))
            }
            MaterialDraft::Mask { part, opacity } => {
                let opacity = opacity.clone();
                self.part("mask", *part).map(|material| Material::Mask(Mask { material, opacity }))
            }
        };
        self.ancestors.pop();
        whole
    }

    /// Returns a part of a material with its own parts.
    fn part(&mut self, kind: &str, place: Value<'d>) -> Option<Part<Material<Curve>>> {
        let name = place.text()?;
        let Some((known, draft)) = self.drafts.get_key_value(name) else {
            return unknown_material(place, name, self.drafts.keys().copied());
        };
        if let Some(start) = self.ancestors.iter().position(|name| name == known) {
            self.circular.extend(&self.ancestors[start..]);
            let path: Vec<_> = self.ancestors[start + 1..].iter().map(|name| format!("{name:?}")).collect();
            let by = if path.is_empty() { String::new() } else { format!(", via {}", path.join(" and ")) };
            return place.refuse(format!("material {known:?} contains itself{by}"));
        }
        self.parts += 1;
        if self.parts > MAX_PARTS || self.ancestors.len() > MAX_DEPTH {
            return self.refuse_size(place);
        }
        match draft {
            Some(MaterialDraft::Whole(Material::Dielectric(_))) => place.advise(
                format!(
                    "a {kind} is made of surfaces, but {known:?} is a dielectric, which fills the space behind its \
                     surface"
                ),
                "a pane has no inside: thin = { index = 1.52 }",
            ),
            Some(MaterialDraft::Whole(Material::Emissive(_))) => place.advise(
                format!("a {kind} is made of surfaces that reflect or transmit light, but {known:?} is emissive"),
                "give the light source an object of its own",
            ),
            _ => {
                let whole = self.resolve(known)?;
                if kind == "mix" && whole.has_axis() {
                    let message = format!("a mix is made of surfaces without an axis, but {known:?} has one");
                    return place.advise(message, "give it an object of its own; for holes use a mask");
                }
                Some(Part::new(name, whole))
            }
        }
    }

    /// Reports only once that a material is made of too many, since those that contain it are too.
    fn refuse_size<T>(&mut self, place: Value<'d>) -> Option<T> {
        let is_reported = std::mem::replace(&mut self.is_too_large, true);
        let whole = self.ancestors.first().copied().unwrap_or_default();
        let how = match self.parts > MAX_PARTS {
            true => format!("more than {MAX_PARTS} others"),
            false => format!("others nested more than {MAX_DEPTH} deep"),
        };
        let refuse = || place.advise(format!("material {whole:?} is made of {how}"), "use fewer");
        if is_reported { None } else { refuse() }
    }
}

/// Reports that there is no material of a name.
pub(super) fn unknown_material<'n, T>(
    place: Value,
    name: &str,
    known: impl ExactSizeIterator<Item = &'n str> + Clone,
) -> Option<T> {
    let message = format!("there is no material named {name:?}");
    if place.has_many_mistakes() {
        return place.refuse(message);
    }
    let help = match nearest(name, known.clone()) {
        Some(near) => format!("did you mean {near:?}?"),
        None if known.len() == 0 => format!("define it: [material.{name}]"),
        None => list_materials(known),
    };
    place.advise(message, help)
}

/// Lists the materials of a scene in words.
pub(super) fn list_materials<'n>(mut known: impl ExactSizeIterator<Item = &'n str>) -> String {
    let shown = known.by_ref().take(MAX_NAMES).collect::<Vec<_>>().join(", ");
    format!("the scene defines {}", and_more(&shown, known.len()))
}
