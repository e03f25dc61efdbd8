//! Materials as they are meant: their spectra and numbers checked.

use std::collections::BTreeMap;

use super::compile::{Compiler, Materials};
use super::gather::{Gather, all, told_elsewhere};
use super::source::At;
use crate::error::Result;
use crate::material::Material;
use crate::spectrum::{Curve, CurveKind, Quantity};

impl Compiler<'_> {
    /// Every material with its spectra checked, and with those it is made of.
    pub(super) fn materials(&mut self, texts: &BTreeMap<String, Option<Material<Curve>>>) -> Materials {
        let mut materials = Materials::new();
        for (name, text) in texts {
            let material = text.as_ref().and_then(|text| {
                let material = self.material(name, text);
                self.kept(material)
            });
            materials.insert(name.clone(), material);
        }
        self.with_parts(&materials)
    }

    fn material(&mut self, name: &str, material: &Material<Curve>) -> Result<Material<Curve>> {
        let (top, kind) = (At::top("material"), material.kind());
        let named = top.key(name);
        let at = named.key(kind);
        let roughness = match material.roughness().filter(|roughness| !(0.0..=1.0).contains(roughness)) {
            Some(roughness) => {
                let message = format!("a roughness lies between 0, smooth, and 1, not {roughness}");
                Err(self.source.mistake_at(&at.key("roughness"), message, None))
            }
            None => Ok(()),
        };
        let mut curves: Vec<Result<Curve>> = Vec::new();
        let mut unknown_metal = None;
        let visited: Result<()> = material.each(|quantity, key, curve| {
            // A conductor given by name has its mistake where the name stands.
            let metal = matches!(curve.kind, CurveKind::Name(_)) && quantity == Quantity::MetalIndex;
            // A metal gives both n and k: of one that is unknown it is told once.
            if let CurveKind::Name(name) = &curve.kind
                && unknown_metal.as_ref() == Some(name)
            {
                curves.push(told_elsewhere());
                return Ok(());
            }
            let checked = self.surface_curve(&at.key(if metal { "metal" } else { key }), curve, quantity);
            if let (CurveKind::Name(name), true) = (&curve.kind, metal && checked.is_err()) {
                unknown_metal = Some(name.clone());
            }
            curves.push(checked);
            Ok(())
        });
        let (_, _, curves) = (roughness, visited, all(curves)).gather()?;
        let mut curves = curves.into_iter();
        let next = &mut |_, _: &Curve| curves.next().expect("each and map visit the same spectra");
        Ok(material.map(next))
    }
}
