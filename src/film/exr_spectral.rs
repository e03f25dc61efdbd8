//! Spectral images as OpenEXR files, in the layout of Fichet, Pacanowski & Wilkie 2021, *An OpenEXR Layout for Spectral
//! Images*, Journal of Computer Graphics Techniques 10(3).

use std::path::Path;

use exr::prelude::{AttributeValue, ImageAttributes, Text};

use super::atomic_file::replace_with;
use super::exr::{Heading, attributes, chromaticities, colors, display_window};
use super::exr_blocks::{self, ScanLinePart};
use super::exr_column::{Column, ColumnContent};
use super::format::Compression;
use super::rows::Rows;
use crate::error::Result;

/// Writes the spectra of an image. Each band has a channel such as `S0.380,000000nm`, named after its center in nm with
/// a decimal comma. R, G and B are added for viewing. If Stokes vectors are requested, S1, S2 and S3 follow S0. Writes
/// nothing for an image without spectra.
///
/// Values are radiance in W m^-2 sr^-1 nm^-1 if the scene's light is absolute, or given in that unit. Each is the mean
/// over its band, although programs that know the layout take it for the radiance at the center. They treat
/// `emissiveUnits` as a mere name, so that attribute holds the text that they expect. The actual unit is in
/// `render/spectralUnits`.
///
/// # Errors
/// If rows cannot be read, or the file cannot be encoded or written. An existing file is then untouched.
pub fn write_spectral_exr(heading: Heading, rows: &mut dyn Rows, path: impl AsRef<Path>) -> Result<()> {
    let path = path.as_ref();
    let film = heading.film;
    let Some(spectral) = &film.spectral else { return Ok(()) };
    let bands = (0..spectral.components()).flat_map(|component| {
        let bands = spectral.bands.centers_nm().enumerate();
        bands.map(move |(band, center)| {
            Column::new(&channel_name(component, center), false, ColumnContent::Band { component, band })
        })
    });
    let columns = colors(false).chain(bands).collect();
    let mut attributes = attributes(heading);
    let step = AttributeValue::F32(spectral.bands.step_nm() as f32);
    for (key, value) in [
        ("spectralLayoutVersion", text("1.0")),
        ("emissiveUnits", text("W.m^-2.sr^-1")),
        ("render/spectralUnits", text("W.m^-2.sr^-1.nm^-1")),
        ("render/spectralStep", step),
    ] {
        attributes.other.insert(Text::from(key), value);
    }
    if spectral.has_stokes {
        // S3 is positive for light that turns to the right, seen toward its source.
        attributes.other.insert(Text::from("polarisationHandedness"), text("right"));
    }
    let mut shared = ImageAttributes::new(display_window(film));
    shared.chromaticities = Some(chromaticities(film));
    let parts = [ScanLinePart::new(film, columns, Compression::Zip, shared, attributes)];
    replace_with(path, |output| exr_blocks::write(&parts, rows, output, path).map(drop))
}

fn text(value: &str) -> AttributeValue {
    AttributeValue::Text(Text::from(value))
}

/// Returns the layout's channel name for a Stokes component of the band around a wavelength.
fn channel_name(component: usize, center_nm: f64) -> String {
    format!("S{component}.{}nm", format!("{center_nm:.6}").replace('.', ","))
}
