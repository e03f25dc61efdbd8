//! `render view`: an OpenEXR image on the terminal, or as a PNG.

mod terminal;

use std::path::PathBuf;

use abbe::film::{BEAUTY, ExrFile, ExrLayer};
use abbe::look::{Exposure, Mattes, Misexposure, Picture, Tone};
use abbe::{Error, Result};
use clap::Parser;
use clap::builder::PossibleValuesParser;

use super::messages::{answer, print_written, say};
use super::outputs::{Folders, check_exposure, check_not_input, check_png};
use super::signals::exit_on_ctrl_c;

const HELP: &str = "\
kitty, WezTerm and Ghostty show the pixels themselves; other terminals show two pixels per character. \
Colors are converted to Rec.709. Normals are shown from -1 to 1, depths and single numbers from their 1st to their 99th \
percentile, Cryptomattes in one color per name. The tone curve srgb clips what is brighter than white; hable is the \
filmic curve of Hable 2010.

Examples:
  render view rainbow.exr                      on the terminal
  render view rainbow.exr Z                    the depth
  render view rainbow.exr --exposure 2         four times as bright
  render view rainbow.exr CryptoObject         every object in its own color
  render view rainbow.exr CryptoObject.prism   the matte of one object
  render view rainbow.spectral.exr 550nm       the band of a spectrum around a wavelength
  render view rainbow.exr --png look.png       a PNG instead
  render view rainbow.exr albedo --sixel       for terminals that support sixels

Exit codes: 0 done, 1 a file cannot be read or written, 2 bad arguments, no such file or layer.";

/// Show an OpenEXR image on the terminal.
#[derive(Parser)]
#[command(name = "render view", bin_name = "render view", after_help = HELP)]
pub struct Query {
    /// The image
    #[arg(value_name = "FILE.exr")]
    file: PathBuf,

    /// A layer such as albedo, N or Z, a channel such as albedo.R, a band of a spectrum such as 550nm, mattes such as
    /// CryptoObject, or one of them such as CryptoObject.ball; the image itself if absent
    layer: Option<String>,

    /// Write a full-size 8-bit sRGB picture instead of showing it
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,

    /// Brighten colors by 2^STOPS
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true)]
    exposure: Option<f64>,

    /// The curve from light to the screen: srgb if absent
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(Tone::ALL.map(Tone::name)))]
    tone: Option<String>,

    /// Show the image as sixels, for a terminal that supports them
    #[arg(long, conflicts_with = "png")]
    sixel: bool,
}

/// Shows or writes the picture.
///
/// # Errors
/// If the image cannot be read, has no such layer, or the picture cannot be written.
pub fn run(query: &Query) -> Result<()> {
    check_exposure(query.exposure)?;
    check_png(query.png.as_deref())?;
    query.png.as_deref().map_or(Ok(()), |png| check_not_input(&query.file, "image", png))?;
    let file = ExrFile::read(&query.file)?;
    let file_name = query.file.display().to_string();
    let matte_name = query.layer.as_deref().and_then(|layer| Mattes::name_of_layer(&file, layer));
    let name = matte_name.or(query.layer.as_deref());
    let picture = match file.layer(name, &file_name) {
        Ok(layer) => of_layer(query, &file, &one_band(query, &file, layer, &file_name)?)?,
        Err(unknown) => mattes_picture(query, name, &file, &file_name, unknown)?,
    };
    match &query.png {
        Some(png) => {
            exit_on_ctrl_c()?;
            let _folders = Folders::of_files(&[png])?;
            picture.write_png(png)?;
            print_written(png);
            Ok(())
        }
        None => answer(&terminal::draw(&picture, query.sixel)?),
    }
}

/// Returns the layer, or the middle band of a spectrum if no layer was named. Refuses a spectrum named without a band.
fn one_band<'f>(query: &Query, file: &'f ExrFile, layer: ExrLayer<'f>, file_name: &str) -> Result<ExrLayer<'f>> {
    let Some(centers) = layer.bands_nm().filter(|centers| centers.len() > 1) else { return Ok(layer) };
    let middle = centers.len() / 2;
    if query.layer.is_none() {
        return file.layer(Some(&layer.channels[middle].full_name()), file_name);
    }
    let message = format!("{} holds the {} bands of a spectrum", layer.name, centers.len());
    Error::refuse(message, format!("name one by its wavelength: {}.{}nm", layer.name, centers[middle]))
}

/// Returns a layer as a picture, and prints what to know about it.
fn of_layer(query: &Query, file: &ExrFile, layer: &ExrLayer) -> Result<Picture> {
    if query.layer.is_none() && layer.name != BEAUTY {
        say(&format!("there are no R, G and B: showing {}", layer.name));
    }
    if layer.color().is_none() {
        refuse_color_flags(query, &layer.name)?;
    }
    let tone = Tone::ALL.into_iter().find(|tone| Some(tone.name()) == query.tone.as_deref()).unwrap_or_default();
    let exposure = Exposure { stops: query.exposure.unwrap_or(0.0), tone };
    let (picture, notes) = Picture::of_layer(file, layer, exposure);
    notes.iter().for_each(|line| say(line));
    if let (None, Some(found)) = (&query.layer, Misexposure::of_layer(file, layer, exposure)) {
        say(&format!("{}: --exposure {} shows more", found.shows.told_of("it"), found.stops));
    }
    Ok(picture)
}

/// Returns the mattes named `name` as a picture, or a single one of them. `unknown` is the error for a name that does
/// not exist.
fn mattes_picture(
    query: &Query,
    name: Option<&str>,
    file: &ExrFile,
    file_name: &str,
    unknown: Error,
) -> Result<Picture> {
    let Some(name) = name else { return Err(unknown) };
    let all = Mattes::all(file);
    let Some((mattes, one)) = Mattes::named(&all, name) else {
        let names: Vec<&str> = all.iter().map(Mattes::name).collect();
        return Err(if names.is_empty() { unknown } else { file.no_layer(name, file_name, &names) });
    };
    let picture = one.map_or_else(|| Ok(mattes.picture()), |name| mattes.matte(name, file_name));
    refuse_color_flags(query, name).and(picture)
}

/// Refuses an exposure or a tone curve for something without colors.
fn refuse_color_flags(query: &Query, name: &str) -> Result<()> {
    let given = [("--exposure", query.exposure.is_some()), ("--tone", query.tone.is_some())];
    match given.iter().find(|(_, given)| *given) {
        Some((flag, _)) => Error::refuse(format!("{flag} is for colors, and {name} has none"), "leave it out"),
        None => Ok(()),
    }
}
