//! `render diff`: whether two OpenEXR images agree.

use std::path::PathBuf;
use std::process::ExitCode;

use abbe::film::{ExrFile, TELL_VARIANCE};
use abbe::look::{Difference, Noise, WorstPixel, compare, number};
use abbe::{Error, Result};
use clap::Parser;

use super::messages::{align_columns, answer_lines, print_error, say};
use super::outputs::{Folders, check_not_input, check_png};
use super::signals::exit_on_ctrl_c;

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
    match compare_files(query) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            print_error(&error);
            ExitCode::from(2)
        }
    }
}

fn compare_files(query: &Query) -> Result<bool> {
    check_png(query.png.as_deref())?;
    if query.tolerance.is_some_and(|limit| !(limit >= 0.0 && limit.is_finite())) {
        return Error::refuse("a tolerance is a finite number, 0 or more", "for instance: --tolerance 1e-4");
    }
    for input in [&query.a, &query.b] {
        query.png.as_deref().map_or(Ok(()), |png| check_not_input(input, "image", png))?;
    }
    let files = [ExrFile::read(&query.a)?, ExrFile::read(&query.b)?];
    let paths = [&query.a, &query.b].map(|path| path.display().to_string());
    let names = paths.each_ref().map(String::as_str);
    let diff = compare(files.each_ref(), query.layer.as_deref(), names)?;
    let agrees = diff.agrees(query.tolerance);
    let mut lines = vec![format!("{} and {} {}", names[0], names[1], if agrees { "agree" } else { "differ" })];
    if diff.is_part {
        let (lines, [width, height], [x, y]) = (&mut lines[0], diff.bounds.size, diff.bounds.corner);
        lines.push_str(&format!(" in the {width} x {height} pixels at ({x}, {y}) that both have"));
    }
    lines[0].push_str(&equality_note(&diff));
    let has_photon_map = files.iter().any(|file| file.attribute("render/photonRadius").is_some());
    let mut rows = difference_rows(&diff, query.tolerance, has_photon_map);
    let only = names.iter().zip(&diff.only_in).filter(|(_, only)| !only.is_empty());
    rows.extend(only.map(|(name, only)| vec![format!("only in {name}"), only.join(", ")]));
    lines.extend(align_columns(&rows));
    if let Some(png) = &query.png {
        let (picture, white) = diff.picture();
        exit_on_ctrl_c()?;
        let _folders = Folders::of_files(&[png])?;
        picture.write_png(png)?;
        let what = match (white > 0.0, diff.torn) {
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
fn equality_note(diff: &Difference) -> String {
    match &*diff.layers_apart {
        _ if !diff.is_equal => String::new(),
        [] => ": all values are equal".into(),
        [one] => format!(": the image is equal, the layer {one} is not; --layer {one} compares it"),
        [one, ..] => {
            let all = diff.layers_apart.join(", ");
            format!(": the image is equal, the layers {all} are not; --layer {one} compares one of them")
        }
    }
}

/// Returns the rows on how the images differ. `has_photon_map` tells whether a photon map was used for one of them.
fn difference_rows(diff: &Difference, tolerance: Option<f64>, has_photon_map: bool) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    let mut add_row = |key: &str, text: String| rows.push(vec![key.to_owned(), text]);
    let limit = tolerance.map_or(String::new(), |limit| format!(", {} is tolerated", number(limit)));
    if !diff.is_equal {
        add_row("relMSE", format!("{}{limit}", number(diff.relative_mse)));
        add_row("brightness", format!("{} times that of the second", number(diff.brightness)));
    }
    if let Some(color) = diff.color.filter(|_| !diff.is_equal) {
        let clipped = match color.clipped {
            0.0 => String::new(),
            share => format!(", for colors clipped to 0..1, which affects {:.1} % of the pixels", 100.0 * share),
        };
        add_row("dE2000", format!("mean {:.3}, worst {:.2}{clipped}", color.mean, color.worst));
    }
    if let Some(alpha) = &diff.alpha {
        let [largest, error] = [alpha.largest, alpha.relative_mse].map(number);
        let alpha_note = if alpha.contradicts() {
            format!("{} pixels are empty in one and full in the other, more than chance explains", alpha.opposite)
        } else {
            "its noise is unknown".into()
        };
        add_row("alpha", format!("up to {largest} apart, relMSE {error}; {alpha_note}; --layer A compares it"));
    }
    if let Some(noise) = diff.noise.as_ref().filter(|_| !diff.is_equal) {
        add_row("z", noise_text(diff, noise));
        let means: Vec<String> = noise.means.iter().map(|z| format!("{z:.1}")).collect();
        add_row("z of means", format!("{} in {}", means.join(", "), diff.channels.join(", ")));
        if noise.changed > 0 {
            add_row(
                "no noise",
                format!("{} values differ although neither file gives them any variance", noise.changed),
            );
        }
        if noise.beyond > 0 && has_photon_map {
            add_row(
                "photon map",
                "its noise is only partly known: by chance, a few values may differ more, fewer with more samples"
                    .into(),
            );
        }
    }
    if !diff.is_equal && diff.noise.is_none() && tolerance.is_none() {
        let unknown_noise =
            format!("the noise is unknown without variance layers from {TELL_VARIANCE} or more samples per pixel");
        add_row("judged by", format!("equality: {unknown_noise}, and no --tolerance is given"));
    }
    if let Some(worst) = &diff.worst {
        add_row("worst pixel", pixel_text(worst));
    }
    if diff.left_out > 0 {
        let all = diff.absolute.len();
        add_row("not finite", format!("{} of {all} pixels, left out; {} of them differ", diff.left_out, diff.torn));
    }
    if let Some(torn) = &diff.first_torn {
        add_row("first of them", pixel_text(torn));
    }
    rows
}

/// Describes a pixel with its values in both images.
fn pixel_text(pixel: &WorstPixel) -> String {
    let values = |values: &[f64]| values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(" ");
    let ([x, y], [a, b]) = (pixel.position, pixel.values.each_ref().map(|all| values(all)));
    format!("({x}, {y}): {a} and {b}")
}

fn noise_text(diff: &Difference, noise: &Noise) -> String {
    let [pixel, channel] = noise.worst_place;
    let ([x, y], channel) = (diff.bounds.place(pixel), &diff.channels[channel]);
    let count_above = if noise.beyond > 0 { format!("; {} above that", noise.beyond) } else { String::new() };
    format!(
        "worst {:.1} in {channel} of ({x}, {y}), chance explains up to {:.1}{count_above}",
        noise.worst, noise.threshold
    )
}
