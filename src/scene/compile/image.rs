//! Images and patterns on surfaces.

use std::path::Path;
use std::sync::Arc;

use super::context::Context;
use super::curve::curve;
use super::curve_range::{MAX_EMISSION, check_thickness, is_factor};
use super::curve_text::{CurveText, KindText, check_repeat};
use super::image_file::{ImageFile, read_texture};
use super::image_numbers::Meaning;
use super::radiometry::scale_to_film;
use crate::scene::text::{Fault, FileKind, IMAGES, Spanned};
use crate::spectrum::{Channel, Curve, CurveKind, Encoding, Image, Quantity, Texture};

const IMAGE: FileKind =
    FileKind { empty_name_message: "an image needs the name of its file", max_bytes: 1 << 32, endings: IMAGES };
/// Images that may be brighter than white.
pub(super) const BRIGHT_IMAGE: FileKind = FileKind { endings: &["exr", "hdr"], ..IMAGE };

/// Reads the spectrum of a surface, which may vary over it.
pub(super) fn surface_curve<'d>(context: &mut Context, text: &CurveText<'d>, quantity: Quantity) -> Option<Curve> {
    match &text.kind {
        KindText::Image(file) if text.fits(quantity) => image_curve(context, text, file, quantity),
        KindText::Checker(cells) if text.fits(quantity) => checker(context, text, cells, quantity),
        _ => curve(context, text, quantity),
    }
}

fn image_curve<'d>(context: &mut Context, text: &CurveText<'d>, file: &'d str, quantity: Quantity) -> Option<Curve> {
    let (factor, placement) = (factor_on_image(text), text.placement());
    let at_file = Spanned { place: text.place, value: file };
    let encoding = text.encoding.map(|encoding| encoding.value);
    let meaning = match quantity {
        // The grays of a thickness are numbers that no screen has encoded.
        Quantity::Thickness => Meaning::Thicknesses(encoding.unwrap_or(Encoding::Linear)),
        Quantity::Share => Meaning::Shares(encoding),
        _ => Meaning::Light(encoding),
    };
    let image = match (text.channel, text.encoding) {
        (Some(Channel::Alpha), Some(Spanned { place, value: Encoding::Srgb })) => {
            place.advise("alpha is a share, which is never encoded as sRGB", "leave `encoding` out")
        }
        _ => image(context, &at_file, meaning, text.channel),
    };
    let (scale, placement, image) = (factor?, placement?, image?);
    let ([x, y], brightest) = image.brightest();
    if quantity == Quantity::Thickness {
        check_thicknesses(text, file, &image, scale)?;
    } else if quantity != Quantity::Emission && f64::from(brightest) * scale > 1.0 {
        let scaled = if scale == 1.0 { String::new() } else { format!(" times its scale of {scale}") };
        let limit = if quantity == Quantity::Share { "a share is at most 1" } else { "no surface returns more than 1" };
        let message = format!("{file}: pixel ({x}, {y}) is {brightest}{scaled}, and {limit}");
        let help = format!("scale = {:.4} makes it 1", (1e4 / f64::from(brightest)).floor() / 1e4);
        return text.place.report(message, (brightest < 1e4).then_some(help));
    }
    let curve = Curve { kind: CurveKind::Texture(Texture { image, placement }), scale, luminance: None };
    match quantity {
        Quantity::Emission => scale_to_film(context, text, curve),
        _ => Some(curve),
    }
}

/// Checks that an image has a single number at each place, and that all numbers are possible thicknesses in nm.
fn check_thicknesses(text: &CurveText, file: &str, image: &Image, scale: f64) -> Option<()> {
    let [r, g, b] = image.most_colorful();
    if r != g || g != b {
        let help = "a thickness is a single number: save it in grayscale, or name its channel = \"red\"";
        return text.place.advise(format!("{file} has colors"), help);
    }
    let ([x, y], most) = image.brightest();
    let place = format!(" where pixel ({x}, {y}) of {file} is {most}");
    text.scale.place.reported(check_thickness(f64::from(most) * scale, &place))
}

/// Returns the factor on an image, if it is valid and no luminance is given in its place.
pub(super) fn factor_on_image(text: &CurveText) -> Option<f64> {
    if let Some(luminance) = text.luminance {
        return luminance.place.advise("an image has no single luminance", "use `scale`");
    }
    match text.scale.value {
        scale if is_factor(scale) => Some(scale),
        scale => {
            text.scale.place.refuse(format!("the scale of an image lies between 0 and {MAX_EMISSION:e}, not {scale}"))
        }
    }
}

fn checker<'d>(
    context: &mut Context,
    text: &CurveText<'d>,
    cells: &[CurveText<'d>; 2],
    quantity: Quantity,
) -> Option<Curve> {
    if let Some(luminance) = text.luminance {
        return luminance.place.advise("a checker has no single luminance", "give its squares a `scale`");
    }
    let repeat = check_repeat(text.repeat);
    let [first, second] = cells.each_ref().map(|cell| {
        let scale = Spanned { value: cell.scale.value * text.scale.value, ..cell.scale };
        square(context, &CurveText { scale, ..cell.clone() }, quantity)
    });
    let (repeat, mut cells, mut scale) = (repeat?, [first?, second?], 1.0);
    if quantity == Quantity::Emission {
        let brightest =
            |cell: &Curve| cell.kind.rgb().map_or(0.0, |rgb| rgb.into_iter().fold(0.0, f64::max) * cell.scale);
        scale = brightest(&cells[0]).max(brightest(&cells[1]));
        cells.iter_mut().for_each(|cell| cell.scale = if scale > 0.0 { cell.scale / scale } else { 0.0 });
    }
    let kind = CurveKind::Checker { cells: Box::new(cells), repeat };
    Some(Curve { kind, scale, luminance: None })
}

fn square<'d>(context: &mut Context, cell: &CurveText<'d>, quantity: Quantity) -> Option<Curve> {
    // A lamp has a single spectrum, a white that its colors filter.
    if quantity == Quantity::Emission && !matches!(cell.kind, KindText::Number(_) | KindText::Rgb(_)) {
        let message = "the squares of a lamp are numbers or `rgb`, which filter a single white";
        return cell.value.advise(message, "use several lamps");
    }
    if let (Quantity::Emission, Some(luminance)) = (quantity, cell.luminance) {
        return luminance.place.advise("the squares of a lamp have no luminance", "use `scale`");
    }
    surface_curve(context, cell, quantity)
}

/// Reads an image from its file with `read`.
pub(super) fn read_file(
    context: &mut Context,
    file: &Spanned<&str>,
    kind: &FileKind,
    read: impl FnOnce(&Path, &[u8]) -> Result<ImageFile, Fault>,
) -> Option<Arc<Image>> {
    let Spanned { place, value: file } = *file;
    let bytes = place.file(file, kind)?;
    let ImageFile { image, warnings } = place.reported(read(Path::new(file), &bytes))?;
    context.record_file(place.path(file), &bytes);
    warnings.into_iter().for_each(|warning| context.warn_at(place, warning));
    Some(Arc::new(image))
}

/// Reads an image, once for each meaning of its numbers and each channel.
pub(super) fn image(
    context: &mut Context,
    file: &Spanned<&str>,
    meaning: Meaning,
    channel: Option<Channel>,
) -> Option<Arc<Image>> {
    let key = (file.place.path(file.value), meaning, channel);
    if let Some(image) = context.images.get(&key) {
        return Some(image.clone());
    }
    let image = read_file(context, file, &IMAGE, |path, bytes| read_texture(path, bytes, meaning, channel))?;
    context.images.insert(key, image.clone());
    Some(image)
}
