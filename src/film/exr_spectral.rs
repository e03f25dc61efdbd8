//! Spectral images as OpenEXR files, in the layout of Fichet, Pacanowski & Wilkie 2021, *An OpenEXR Layout for Spectral
//! Images*, Journal of Computer Graphics Techniques 10(3).

use std::path::Path;

use exr::prelude::{AnyChannels, AttributeValue, Image, ImageAttributes, Layer, SmallVec, Text, Vec2};

use super::exr::{
    Channel, Channels, Provenance, View, attributes, chromaticities, display_window, encode_image, encoding,
};
use super::file::replace_file;
use super::format::{Compression, Format};
use super::image::Film;
use crate::error::Result;

/// Writes the spectra of an image: a channel `S0.380,000000nm` and so on for each band, with its center in nm and a
/// decimal comma, and R, G and B for looking. Nothing is written of an image without spectra.
///
/// Numbers are radiance in W m^-2 sr^-1 nm^-1 where the scene's light is absolute, or given in that unit; each is the
/// mean over its band. Programs that know the layout take it for the radiance at the center, and `emissiveUnits` for a
/// mere name: that attribute holds the text that they expect, and `render/spectralUnits` the unit.
///
/// # Errors
/// If the file cannot be encoded or written; a file that was there before is then untouched.
pub fn write_spectral_exr(
    film: &Film,
    format: &Format,
    view: &View,
    provenance: &Provenance,
    path: &Path,
) -> Result<()> {
    let Some(spectral) = &film.spectral else { return Ok(()) };
    let (mut make, mut channels) = (Channels::new(film), SmallVec::<[Channel; 4]>::new());
    for (number, name) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push(make.of(name, false, |pixel| film.pixels[pixel].rgb[number]));
    }
    for (band, center) in spectral.bands.centers_nm().enumerate() {
        channels.push(make.of(&channel_name(center), false, |pixel| spectral.pixel(pixel)[band]));
    }
    let mut attributes = attributes(film, format, view, provenance);
    let step = AttributeValue::F32(spectral.bands.step_nm() as f32);
    for (key, value) in [
        ("spectralLayoutVersion", text("1.0")),
        ("emissiveUnits", text("W.m^-2.sr^-1")),
        ("render/spectralUnits", text("W.m^-2.sr^-1.nm^-1")),
        ("render/spectralStep", step),
    ] {
        attributes.other.insert(Text::from(key), value);
    }
    let size = Vec2(film.width as usize, film.height as usize);
    let part = Layer::new(size, attributes, encoding(Compression::Zip), AnyChannels::sort(channels));
    let mut image = Image::from_layers(ImageAttributes::new(display_window(film)), vec![part]);
    image.attributes.chromaticities = Some(chromaticities(film));
    replace_file(path, &encode_image(image, path)?)
}

fn text(value: &str) -> AttributeValue {
    AttributeValue::Text(Text::from(value))
}

/// The layout's name of the band around a wavelength.
fn channel_name(center_nm: f64) -> String {
    format!("S0.{}nm", format!("{center_nm:.6}").replace('.', ","))
}
