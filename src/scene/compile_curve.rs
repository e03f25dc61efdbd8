//! Spectra as they are meant: files read, names looked up, everything checked.

use std::io::ErrorKind;
use std::path::Path;

use sha2::Digest;

use super::compile::Compiler;
use super::source::At;
use super::spectrum_file::read_columns;
use crate::error::{Error, Result};
use crate::spectrum::{Curve, CurveKind, Quantity, Refusal, absorption_of, imitation, reach};

/// Most bytes of a table of samples.
const MOST_TEXT: u64 = 1 << 26;

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
        let here = at.key("file");
        if column < 2 {
            let message = "the values stand in column 2 or later: column 1 holds the wavelengths";
            return Err(self.source.mistake_at(&at.key("column"), message, None));
        }
        let text = self.text_of(&here, file)?;
        let samples = read_columns(&text, column).map_err(|fault| {
            // The second column is taken where none is named.
            let place = if fault.is_column && column != 2 { at.key("column") } else { here };
            self.source.mistake_at(&place, format!("{file}{}", fault.message), fault.help)
        })?;
        self.hash.update(text.as_bytes());
        let curve = Curve { kind: CurveKind::Samples(samples.iter().map(|row| row.1).collect()), ..curve.clone() };
        match curve.check(quantity) {
            Ok(()) => Ok(curve),
            Err(Refusal { message, help, entry: Some(entry), .. }) => {
                let message = format!("{file}, line {}: {message}", samples[entry].0);
                Err(self.source.mistake_at(&here, message, help))
            }
            Err(refusal) => Err(self.refuse_curve(at, refusal.keys, refusal)),
        }
    }

    /// Refuses what is there but no file that could be read whole: a device never ends.
    pub(super) fn file_of_size(&self, at: &At, path: &Path, file: &str, most: u64) -> Result<()> {
        let refuse = |message: String| Err(self.source.mistake_at(at, message, None));
        match std::fs::metadata(path) {
            Ok(found) if found.is_file() && found.len() > most => {
                refuse(format!("{file} has {} bytes, more than {most}", found.len()))
            }
            Ok(found) if !found.is_file() && !found.is_dir() => refuse(format!("{file} is no file but a device")),
            _ => Ok(()),
        }
    }

    fn text_of(&self, at: &At, file: &str) -> Result<String> {
        let path = self.source.folder().join(file);
        self.file_of_size(at, &path, file, MOST_TEXT)?;
        std::fs::read_to_string(&path).map_err(|error| {
            let refuse =
                |message: String, help: Option<&str>| self.source.mistake_at(at, message, help.map(str::to_owned));
            match error.kind() {
                _ if file.is_empty() => refuse("a file of samples needs a name".into(), None),
                _ if path.is_dir() => refuse(format!("{file} is a folder"), None),
                ErrorKind::NotFound | ErrorKind::NotADirectory => self.source.missing_file(at, file),
                ErrorKind::InvalidData => {
                    refuse(format!("{file} is not text in UTF-8"), Some("save the table as CSV in UTF-8"))
                }
                _ => refuse(format!("cannot read {file}: {error}"), None),
            }
        })
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
