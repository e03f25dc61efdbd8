//! Materials that are made of others: the names of these looked up.

use std::collections::BTreeSet;

use super::compile::{Compiler, Materials};
use super::gather::{all, told_elsewhere};
use super::source::At;
use crate::error::{Error, Result, nearest};
use crate::material::{Material, Part};
use crate::spectrum::Curve;

/// A search for the materials that others are made of.
struct Search<'m> {
    materials: &'m Materials,
    /// Those that are made of the one that is looked for, the outermost first.
    within: Vec<&'m str>,
    /// Those of which it was told that they are made of themselves.
    circular: BTreeSet<&'m str>,
}

impl Compiler<'_> {
    /// Every material with those it is made of.
    pub(super) fn with_parts(&mut self, materials: &Materials) -> Materials {
        let mut search = Search { materials, within: Vec::new(), circular: BTreeSet::new() };
        let mut found = Materials::new();
        for (name, material) in materials {
            let whole = material.as_ref().map(|_| self.whole(name, &mut search));
            found.insert(name.clone(), whole.and_then(|whole| self.kept(whole)));
        }
        found
    }

    /// The material of a name with those it is made of.
    fn whole<'m>(&self, name: &'m str, search: &mut Search<'m>) -> Result<Material<Curve>> {
        let Some(material) = search.materials[name].as_ref().filter(|_| !search.circular.contains(name)) else {
            return told_elsewhere();
        };
        search.within.push(name);
        let mut parts = Vec::new();
        let whole = material.with_found(|number, part| {
            let found = self.part(name, material, number, part, search);
            // What takes the place of a wrong part is never seen.
            let taken = found.as_ref().map_or_else(|_| part.clone(), Part::clone);
            parts.push(found);
            Ok::<_, Error>(taken)
        });
        search.within.pop();
        all(parts)?;
        whole
    }

    /// A part of a material with what it is made of.
    fn part<'m>(
        &self,
        name: &str,
        material: &Material<Curve>,
        number: usize,
        part: &Part<Curve>,
        search: &mut Search<'m>,
    ) -> Result<Part<Curve>> {
        let refuse =
            |message: String, help: Option<String>| Err(self.refuse_part(name, material, number, message, help));
        let Some((known, found)) = search.materials.get_key_value(&part.name) else {
            let names = || search.materials.keys().map(String::as_str);
            let help = match nearest(&part.name, names()) {
                Some(near) => format!("did you mean {near:?}?"),
                None => format!("the scene defines {}", names().collect::<Vec<_>>().join(", ")),
            };
            return refuse(format!("there is no material named {:?}", part.name), Some(help));
        };
        if let Some(start) = search.within.iter().position(|name| name == known) {
            search.circular.extend(&search.within[start..]);
            let way: Vec<_> = search.within[start + 1..].iter().map(|name| format!("{name:?}")).collect();
            let by = if way.is_empty() { String::new() } else { format!(", by way of {}", way.join(" and ")) };
            return refuse(format!("material {known:?} is made of itself{by}"), None);
        }
        let kind = material.kind();
        match found {
            Some(Material::Dielectric(_)) => refuse(
                format!(
                    "a {kind} is made of surfaces, and {known:?} is a dielectric, which fills the space behind its own"
                ),
                Some("a pane has no inside: thin = { index = 1.52 }".into()),
            ),
            Some(Material::Emissive(_)) => refuse(
                format!("a {kind} is made of surfaces that reflect or let through, and {known:?} is emissive"),
                Some("give what shines an object of its own".into()),
            ),
            _ => Ok(part.found(self.whole(known, search)?)),
        }
    }

    /// The error of a part of a material.
    fn refuse_part(
        &self,
        name: &str,
        material: &Material<Curve>,
        number: usize,
        message: String,
        help: Option<String>,
    ) -> Error {
        let top = At::top("material");
        let named = top.key(name);
        let kind = named.key(material.kind());
        match material {
            Material::Mix(_) => self.source.mistake_at(&kind.key("materials").index(number), message, help),
            _ => self.source.mistake_at(&kind.key("material"), message, help),
        }
    }
}
