//! `render diff`: whether two OpenEXR images agree.

use std::path::PathBuf;
use std::process::ExitCode;

use abbe::film::{ExrFile, TELL_VARIANCE};
use abbe::look::{Difference, Noise, WorstPixel, compare, number};
use abbe::{Error, Result};
use clap::Parser;

use super::messages::{aligned, answer_lines, print_error, say};
use super::outputs::{Folders, check_png, spare};
use super::signals::catch_plainly;

const HELP: &str = "\
Files with a variance layer agree if they differ by no more than their noise: no z = (a - b) / sqrt(va + vb), of a \
pixel or of a channel's mean, may exceed the bound that chance exceeds in one of a hundred pairs of images. \
Other files agree if all values are equal, or if relMSE is at most --tolerance. \
Two equal images do not agree if a layer of both files differs, such as Z, or if alpha is 0 in one and 1 in the other \
more often than chance explains. \
If one file is a crop of the other, only their common pixels are compared. \
Layers that only one of the files has are listed, but do not count.

Examples:
  render diff old.exr new.exr                       do they agree, and if not, where
  render diff old.exr new.exr --tolerance 1e-4      do they agree within 1e-4
  render diff old.exr new.exr --layer albedo
  render diff old.exr new.exr --png difference.png  see where they differ

Exit codes: 0 they agree, 1 they differ, 2 they cannot be read or compared.";

/// Test whether two OpenEXR images agree.
#[derive(Parser)]
#[command(name = "render diff", bin_name = "render diff", after_help = HELP)]
pub struct Query {
    /// One image
    #[arg(value_name = "A.exr")]
    a: PathBuf,

    /// The image to compare it with
    #[arg(value_name = "B.exr")]
    b: PathBuf,

    /// A layer such as albedo or Z, mattes such as CryptoObject, or one of them such as CryptoObject.ball, instead of
    /// the image itself
    #[arg(long, value_name = "NAME")]
    layer: Option<String>,

    /// The largest relMSE at which the images agree; noise is then ignored
    #[arg(long, value_name = "RELMSE", allow_negative_numbers = true)]
    tolerance: Option<f64>,

    /// Write a gray picture of |a - b|
    #[arg(long, value_name = "OUT.png")]
    png: Option<PathBuf>,
}

/// Compares the images, and returns the exit code.
pub fn run(query: &Query) -> ExitCode {
    match compared(query) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            print_error(&error);
            ExitCode::from(2)
        }
    }
}

fn compared(query: &Query) -> Result<bool> {
    check_png(query.png.as_deref())?;
    if query.tolerance.is_some_and(|most| !(most >= 0.0 && most.is_finite())) {
        return Error::refuse("a tolerance is a finite number, 0 or more", "for instance: --tolerance 1e-4");
    }
    for input in [&query.a, &query.b] {
        query.png.as_deref().map_or(Ok(()), |png| spare(input, "image", png))?;
    }
    let files = [ExrFile::read(&query.a)?, ExrFile::read(&query.b)?];
    let shown = [&query.a, &query.b].map(|path| path.display().to_string());
    let names = shown.each_ref().map(String::as_str);
    let found = compare(files.each_ref(), query.layer.as_deref(), names)?;
    let agrees = found.agrees(query.tolerance);
    let mut lines = vec![format!("{} and {} {}", names[0], names[1], if agrees { "agree" } else { "differ" })];
    if found.is_part {
        let (lines, [width, height], [x, y]) = (&mut lines[0], found.bounds.size, found.bounds.corner);
        lines.push_str(&format!(" in the {width} x {height} pixels at ({x}, {y}) that both have"));
    }
    lines[0].push_str(&of_equal(&found));
    let gathers = files.iter().any(|file| file.attribute("render/photonRadius").is_some());
    let mut rows = figures(&found, query.tolerance, gathers);
    let only = names.iter().zip(&found.only_in).filter(|(_, only)| !only.is_empty());
    rows.extend(only.map(|(name, only)| vec![format!("only in {name}"), only.join(", ")]));
    lines.extend(aligned(&rows));
    if let Some(png) = &query.png {
        let (picture, white) = found.picture();
        catch_plainly()?;
        let _folders = Folders::of_files(&[png])?;
        picture.write_png(png)?;
        let what = match (white > 0.0, found.torn) {
            (true, _) => format!("white is a difference of {} or more", number(white)),
            (false, 0) => "all of it is black, as nothing differs".into(),
            (false, _) => "white marks pixels that differ and are not finite".into(),
        };
        say(&format!("wrote {}: {what}", png.display()));
    }
    answer_lines(&lines)?;
    Ok(agrees)
}

/// Returns what to add to the answer if the images are equal.
fn of_equal(found: &Difference) -> String {
    match &*found.layers_apart {
        _ if !found.is_equal => String::new(),
        [] => ": all values are equal".into(),
        [one] => format!(": the image is equal, the layer {one} is not; --layer {one} compares it"),
        [one, ..] => {
            let all = found.layers_apart.join(", ");
            format!(": the image is equal, the layers {all} are not; --layer {one} compares one of them")
        }
    }
}

/// Returns the rows on how the images differ. `gathers` tells whether a photon map was used for one of them.
fn figures(found: &Difference, tolerance: Option<f64>, gathers: bool) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut put = |key: &str, text: String| rows.push(vec![key.to_owned(), text]);
    let most = tolerance.map_or(String::new(), |most| format!(", {} is tolerated", number(most)));
    if !found.is_equal {
        put("relMSE", format!("{}{most}", number(found.relative_mse)));
        put("brightness", format!("{} times that of the second", number(found.brightness)));
    }
    if let Some(color) = found.color.filter(|_| !found.is_equal) {
        let clipped = match color.clipped {
            0.0 => String::new(),
            share => format!(", for colors clipped to 0..1, which affects {:.1} % of the pixels", 100.0 * share),
        };
        put("dE2000", format!("mean {:.3}, worst {:.2}{clipped}", color.mean, color.worst));
    }
    if let Some(alpha) = &found.alpha {
        let [largest, error] = [alpha.largest, alpha.relative_mse].map(number);
        let known = if alpha.contradicts() {
            format!("{} pixels are empty in one and full in the other, more than chance explains", alpha.opposite)
        } else {
            "its noise is unknown".into()
        };
        put("alpha", format!("up to {largest} apart, relMSE {error}; {known}; --layer A compares it"));
    }
    if let Some(noise) = found.noise.as_ref().filter(|_| !found.is_equal) {
        put("z", of_noise(found, noise));
        let means: Vec<String> = noise.means.iter().map(|z| format!("{z:.1}")).collect();
        put("z of means", format!("{} in {}", means.join(", "), found.channels.join(", ")));
        if noise.changed > 0 {
            put("no noise", format!("{} values differ although neither file gives them any variance", noise.changed));
        }
        if noise.beyond > 0 && gathers {
            put(
                "photon map",
                "its noise is only partly known: by chance, a few values may differ more, fewer with more samples"
                    .into(),
            );
        }
    }
    if !found.is_equal && found.noise.is_none() && tolerance.is_none() {
        let untold =
            format!("the noise is unknown without variance layers from {TELL_VARIANCE} or more samples per pixel");
        put("judged by", format!("equality: {untold}, and no --tolerance is given"));
    }
    if let Some(worst) = &found.worst {
        put("worst pixel", of_pixel(worst));
    }
    if found.left_out > 0 {
        let all = found.absolute.len();
        put("not finite", format!("{} of {all} pixels, left out; {} of them differ", found.left_out, found.torn));
    }
    if let Some(torn) = &found.first_torn {
        put("first of them", of_pixel(torn));
    }
    rows
}

/// Describes a pixel with its values in both images.
fn of_pixel(pixel: &WorstPixel) -> String {
    let values = |values: &[f64]| values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ");
    let ([x, y], [a, b]) = (pixel.at, pixel.values.each_ref().map(|of| values(of)));
    format!("({x}, {y}): {a} and {b}")
}

fn of_noise(found: &Difference, noise: &Noise) -> String {
    let [pixel, channel] = noise.at;
    let ([x, y], channel) = (found.bounds.place(pixel), &found.channels[channel]);
    let beyond = if noise.beyond > 0 { format!("; {} above that", noise.beyond) } else { String::new() };
    format!("worst {:.1} in {channel} of ({x}, {y}), chance explains up to {:.1}{beyond}", noise.worst, noise.threshold)
}
