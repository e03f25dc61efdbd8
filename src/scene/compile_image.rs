//! Images and patterns on surfaces: files read once, everything checked.

use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use sha2::Digest;

use super::compile::Compiler;
use super::gather::{Gather, all};
use super::image_file::{Meaning, read_texture};
use super::source::At;
use crate::error::Result;
use crate::spectrum::{Channel, Curve, CurveKind, Encoding, Image, ImageText, Quantity, Texture};

/// Most bytes of an image.
const MOST_IMAGE: u64 = 1 << 32;
/// Most and, as one over it, least repetitions in a unit.
const MOST_REPEAT: f64 = 1e6;

/// Images by their path and by what was read of them.
pub(super) type Images = BTreeMap<(PathBuf, Meaning, Option<Channel>), Arc<Image>>;

impl Compiler<'_> {
    /// The spectrum of a surface, which may vary over it, checked.
    pub(super) fn surface_curve(&mut self, at: &At, curve: &Curve, quantity: Quantity) -> Result<Curve> {
        let on_surface =
            matches!(quantity, Quantity::Reflectance | Quantity::Transmittance | Quantity::Share | Quantity::Emission);
        match &curve.kind {
            CurveKind::Image(image) if on_surface => self.image_curve(at, curve, image, quantity),
            CurveKind::Checker { cells, repeat } if on_surface => self.checker(at, curve, cells, *repeat, quantity),
            _ => self.curve(at, curve, quantity),
        }
    }

    fn image_curve(&mut self, at: &At, curve: &Curve, text: &ImageText, quantity: Quantity) -> Result<Curve> {
        let factor = self.factor_on_image(at, curve);
        let repeat = self.repeat(at, text.placement.repeat);
        let here = at.key("image");
        let image = match (text.channel, text.encoding) {
            (Some(Channel::Alpha), Some(Encoding::Srgb)) => {
                let message = "alpha is a share, which no kind of file encodes as sRGB";
                Err(self.source.mistake_at(&at.key("encoding"), message, Some("leave `encoding` out".into())))
            }
            _ => self.image(&here, &text.file, Meaning::Light(text.encoding), text.channel),
        };
        let (_, _, image) = (factor, repeat, image).gather()?;
        let ([x, y], brightest) = image.brightest();
        let most = f64::from(brightest) * curve.scale;
        if quantity != Quantity::Emission && most > 1.0 {
            let scaled =
                if curve.scale == 1.0 { String::new() } else { format!(" times its scale of {}", curve.scale) };
            let message = format!(
                "{}: pixel ({x}, {y}) is {brightest}{scaled}, and no surface gives back more than 1",
                text.file
            );
            let help = format!("scale = {:.4} makes it 1", (1e4 / f64::from(brightest)).floor() / 1e4);
            return Err(self.source.mistake_at(&here, message, (brightest < 1e4).then_some(help)));
        }
        let texture = Texture { image, placement: text.placement };
        Ok(Curve { kind: CurveKind::Texture(texture), ..curve.clone() })
    }

    pub(super) fn repeat(&self, at: &At, repeat: [f64; 2]) -> Result<()> {
        let possible = |x: &f64| (1.0 / MOST_REPEAT..=MOST_REPEAT).contains(x);
        match repeat.iter().find(|x| !possible(x)) {
            Some(wrong) => {
                let message = format!("`repeat` counts copies in a unit, above 0 to {MOST_REPEAT:e}, not {wrong}");
                Err(self.source.mistake_at(&at.key("repeat"), message, None))
            }
            None => Ok(()),
        }
    }

    /// That the factor on an image is one, and no luminance stands in its place.
    pub(super) fn factor_on_image(&mut self, at: &At, curve: &Curve) -> Result<()> {
        if curve.luminance.is_some() {
            let help = Some("use `scale`".into());
            return Err(self.source.mistake_at(&at.key("luminance"), "an image has no single luminance", help));
        }
        let factor = self.curve(at, &curve.scale.into(), Quantity::Emission);
        factor.map(|_| ()).map_err(|_| {
            let message = format!("a factor on an image is finite and at least 0, not {}", curve.scale);
            self.source.mistake_at(&at.key("scale"), message, None)
        })
    }

    fn checker(
        &mut self,
        at: &At,
        curve: &Curve,
        cells: &[Curve; 2],
        repeat: [f64; 2],
        quantity: Quantity,
    ) -> Result<Curve> {
        let repeated = self.repeat(at, repeat);
        if curve.luminance.is_some() {
            let help = Some("give its squares a `scale`".into());
            return Err(self.source.mistake_at(&at.key("luminance"), "a checker has no single luminance", help));
        }
        let list = at.key("checker");
        let squares = cells.iter().enumerate().map(|(number, cell)| {
            let scaled = Curve { scale: cell.scale * curve.scale, ..cell.clone() };
            self.square(&list.index(number), &scaled, quantity)
        });
        let squares = all(squares);
        let (_, squares) = (repeated, squares).gather()?;
        let [mut first, mut second] = <[Curve; 2]>::try_from(squares).expect("two squares were checked");
        let mut scale = 1.0;
        if quantity == Quantity::Emission {
            let brightest =
                |cell: &Curve| cell.kind.rgb().map_or(0.0, |rgb| rgb.into_iter().fold(0.0, f64::max) * cell.scale);
            scale = brightest(&first).max(brightest(&second));
            let filter = |cell: &mut Curve| cell.scale = if scale > 0.0 { cell.scale / scale } else { 0.0 };
            filter(&mut first);
            filter(&mut second);
        }
        Ok(Curve { kind: CurveKind::Checker { cells: Box::new([first, second]), repeat }, scale, luminance: None })
    }

    fn square(&mut self, at: &At, cell: &Curve, quantity: Quantity) -> Result<Curve> {
        // A lamp has one spectrum, the white that colors are filters of.
        if quantity == Quantity::Emission && cell.kind.rgb().is_none() {
            let message = "the squares of a lamp are numbers or `rgb`: it shines in one white";
            return Err(self.source.mistake_at(at, message, Some("make it of several lamps".into())));
        }
        if quantity == Quantity::Emission && cell.luminance.is_some() {
            let (message, help) = ("the squares of a lamp have no luminance", "use `scale`");
            return Err(self.source.mistake_at(&at.key("luminance"), message, Some(help.into())));
        }
        self.surface_curve(at, cell, quantity)
    }

    /// An image, read once for each meaning of its numbers.
    pub(super) fn image(
        &mut self,
        at: &At,
        file: &str,
        meaning: Meaning,
        channel: Option<Channel>,
    ) -> Result<Arc<Image>> {
        let key = (self.source.folder().join(file), meaning, channel);
        if let Some(image) = self.images.get(&key) {
            return Ok(image.clone());
        }
        let bytes = self.bytes_of_image(at, file)?;
        let read = read_texture(Path::new(file), &bytes, meaning, channel);
        let read = read.map_err(|(message, help)| self.source.mistake_at(at, message, help))?;
        self.hash.update(&bytes);
        if read.ignores_alpha {
            let warning = format!("{at}: the alpha of {file} is ignored; channel = \"alpha\" reads it");
            self.warnings.push(warning);
        }
        let image = Arc::new(read.image);
        self.images.insert(key, image.clone());
        Ok(image)
    }

    pub(super) fn bytes_of_image(&self, at: &At, file: &str) -> Result<Vec<u8>> {
        let path = self.source.folder().join(file);
        self.file_of_size(at, &path, file, MOST_IMAGE)?;
        std::fs::read(&path).map_err(|error| match error.kind() {
            _ if file.is_empty() => self.source.mistake_at(at, "an image needs the name of its file", None),
            ErrorKind::NotFound | ErrorKind::NotADirectory => self.source.missing_file(at, file),
            _ if path.is_dir() => self.source.mistake_at(at, format!("{file} is a folder"), None),
            _ => self.source.mistake_at(at, format!("cannot read {file}: {error}"), None),
        })
    }
}
