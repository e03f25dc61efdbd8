//! Materials that are made of others: the names of these looked up.

use super::compile::{Compiler, Materials};
use super::source::At;
use crate::error::{Error, Result, nearest};
use crate::material::Material;
use crate::spectrum::Curve;

impl Compiler<'_> {
    /// Every material with those it is made of.
    pub(super) fn with_parts(&self, materials: &Materials) -> Result<Materials> {
        let whole = |name: &String| Ok((name.clone(), self.whole(name, materials, &mut Vec::new())?));
        materials.keys().map(whole).collect()
    }

    /// The material of a name with those it is made of; `within` are the names of those that are made of it.
    fn whole<'m>(&self, name: &'m str, materials: &'m Materials, within: &mut Vec<&'m str>) -> Result<Material<Curve>> {
        let material = &materials[name];
        within.push(name);
        let whole = material.with_found(|number, part| {
            let refuse = |message: String, help: Option<String>| Err(self.refuse_part(name, material, number, message, help));
            let Some((known, found)) = materials.get_key_value(&part.name) else {
                let names = || materials.keys().map(String::as_str);
                let help = match nearest(&part.name, names()) {
                    Some(near) => format!("did you mean {near:?}?"),
                    None => format!("the scene defines {}", names().collect::<Vec<_>>().join(", ")),
                };
                return refuse(format!("there is no material named {:?}", part.name), Some(help));
            };
            if let Some(start) = within.iter().position(|name| name == known) {
                let way: Vec<_> = within[start + 1..].iter().map(|name| format!("{name:?}")).collect();
                let by = if way.is_empty() { String::new() } else { format!(", by way of {}", way.join(" and ")) };
                return refuse(format!("material {known:?} is made of itself{by}"), None);
            }
            let kind = material.kind();
            match found {
                Material::Dielectric(_) => refuse(
                    format!("a {kind} is made of surfaces, and {known:?} is a dielectric, which fills the space behind its own"),
                    Some("a pane has no inside: thin = { index = 1.52 }".into()),
                ),
                Material::Emissive(_) => refuse(
                    format!("a {kind} is made of surfaces that reflect or let through, and {known:?} is emissive"),
                    Some("give what shines an object of its own".into()),
                ),
                _ => Ok(part.found(self.whole(known, materials, within)?)),
            }
        });
        within.pop();
        whole
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
