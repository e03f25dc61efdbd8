//! Spectra as they are meant: files read, names looked up, everything checked.

use sha2::Digest;

use super::compile::Compiler;
use super::source::At;
use super::spectrum_file::read_columns;
use crate::error::{Error, Result};
use crate::spectrum::{Curve, CurveKind, Quantity, Refusal, absorption_of, imitation, reach};

impl Compiler<'_> {
    /// The curve with its file read and its absorption looked up, checked.
    pub(super) fn curve(&mut self, at: &At, curve: &Curve, quantity: Quantity) -> Result<Curve> {
        let curve = match (&curve.kind, quantity) {
            (CurveKind::File { file, column }, _) => return self.curve_of_file(at, curve, file, *column, quantity),
            (CurveKind::Name(name), Quantity::Absorption) => self.absorption(at, name)?,
            _ => curve.clone(),
        };
        curve.check(quantity).map_err(|refusal| self.refuse_curve(at, refusal.keys, refusal))?;
        if quantity == Quantity::Index {
            self.warn_of_index(at, &curve);
        }
        Ok(curve)
    }

    fn refuse_curve(&self, at: &At, keys: &[&str], refusal: Refusal) -> Error {
        match (keys, refusal.entry) {
            ([key, inner @ ..], _) => self.refuse_curve(&at.key(key), inner, refusal),
            ([], Some(entry)) => self.source.mistake_at(&at.index(entry), refusal.message, refusal.help),
            ([], None) => self.source.mistake_at(at, refusal.message, refusal.help),
        }
    }

    fn curve_of_file(
        &mut self,
        at: &At,
        curve: &Curve,
        file: &str,
        column: usize,
        quantity: Quantity,
    ) -> Result<Curve> {
        let path = self.source.path.parent().unwrap_or(std::path::Path::new("")).join(file);
        let refuse =
            |message: String, help: Option<String>| Err(self.source.mistake_at(&at.key("file"), message, help));
        if column < 2 {
            let message = "the values stand in column 2 or later: column 1 holds the wavelengths";
            return Err(self.source.mistake_at(&at.key("column"), message, None));
        }
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) => return refuse(format!("cannot read {}: {error}", path.display()), None),
        };
        let samples = match read_columns(&text, column) {
            Ok(samples) => samples,
            Err((line, message)) => return refuse(format!("{}, line {line}: {message}", path.display()), None),
        };
        self.hash.update(text.as_bytes());
        let curve = Curve { kind: CurveKind::Samples(samples.iter().map(|row| row.1).collect()), ..curve.clone() };
        match curve.check(quantity) {
            Ok(()) => Ok(curve),
            Err(Refusal { message, help, entry, .. }) => {
                let line = entry.and_then(|entry| samples.get(entry)).map(|row| row.0);
                let line = line.map_or(String::new(), |line| format!(", line {line}"));
                refuse(format!("{}{line}: {message}", path.display()), help)
            }
        }
    }

    /// The absorption per scene unit of a glass of the catalog.
    fn absorption(&mut self, at: &At, name: &str) -> Result<Curve> {
        let per_meter = absorption_of(name).map_err(|refusal| self.refuse_curve(at, refusal.keys, refusal))?;
        let Some(meters) = self.meters_per_unit else {
            let message =
                format!("the absorption of {name} is known per meter, and the scene does not say how long its unit is");
            let help = "for a scene in centimeters: [render] meters_per_unit = 0.01";
            return Err(self.source.mistake_at(at, message, Some(help.into())));
        };
        let samples = per_meter.iter().map(|&[nm, per_meter]| [nm, per_meter * meters]).collect();
        Ok(CurveKind::Samples(samples).into())
    }

    /// What an author should know of an index that is accepted.
    fn warn_of_index(&mut self, at: &At, curve: &Curve) {
        self.warnings.extend(reach(curve).map(|warning| format!("{at}: {warning}")));
        self.warnings.extend(imitation(curve).map(|warning| format!("{at}: {warning}")));
    }
}
