//! Materials as they are meant: their spectra and numbers checked.

use super::compile::{Compiler, Materials};
use super::source::At;
use crate::error::Result;
use crate::spectrum::{Curve, CurveKind, Quantity};

impl Compiler<'_> {
    /// Every material with its spectra checked, and with those it is made of.
    pub(super) fn materials(&mut self, texts: &Materials) -> Result<Materials> {
        let mut materials = Materials::new();
        for (name, material) in texts {
            let (top, kind) = (At::top("material"), material.kind());
            let named = top.key(name);
            let at = named.key(kind);
            if let Some(roughness) = material.roughness().filter(|roughness| !(0.0..=1.0).contains(roughness)) {
                let message = format!("a roughness lies between 0, smooth, and 1, not {roughness}");
                return Err(self.source.mistake_at(&at.key("roughness"), message, None));
            }
            let mut curves = Vec::new();
            material.each(|quantity, key, curve| {
                // A conductor given by name has its mistake where the name stands.
                let metal = matches!(curve.kind, CurveKind::Name(_)) && quantity == Quantity::MetalIndex;
                curves.push(self.surface_curve(&at.key(if metal { "metal" } else { key }), curve, quantity)?);
                Ok(())
            })?;
            let mut curves = curves.into_iter();
            let next = &mut |_, _: &Curve| curves.next().expect("each and map visit the same spectra");
            materials.insert(name.clone(), material.map(next));
        }
        self.with_parts(&materials)
    }
}
