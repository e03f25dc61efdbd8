//! `render info`: what an OpenEXR file carries.

use std::path::PathBuf;

use abbe::Result;
use abbe::film::{CameraMatrix, Channel, ExrFile, ExrLayer, Part, PixelBounds, Statistics};
use abbe::look::number;
use abbe::spectrum::Primaries;
use clap::Parser;

use super::messages::aligned;

const HELP: &str = "\
It lists the size and the data window, the color space, the camera and all attributes of the file. For each channel it \
lists the type, the least, mean and largest value, and how many values are not finite. For deep images and subsampled \
channels it lists everything but the values.

Examples:
  render info rainbow.exr            files of other programs as well
  render info rainbow.exr | less

Exit codes: 0 done, 1 the file cannot be read, 2 bad arguments or no such file.";

/// Describe an OpenEXR image.
#[derive(Parser)]
#[command(name = "render info", bin_name = "render info", after_help = HELP)]
pub struct Query {
    /// The image
    #[arg(value_name = "FILE.exr")]
    file: PathBuf,
}

/// The maximum number of characters shown of an attribute. Lists of names can be as long as a book.
const MOST_SHOWN: usize = 200;

/// Returns the lines that answer a query.
///
/// # Errors
/// If the file cannot be read.
pub fn lines(query: &Query) -> Result<Vec<String>> {
    let (file, unread) = match ExrFile::read(&query.file) {
        Ok(file) => (file, None),
        Err(error) => match ExrFile::outline(&query.file) {
            Ok(Some((file, why))) => (file, Some(why)),
            _ => return Err(error),
        },
    };
    let parts = if file.parts.len() == 1 { "1 part".into() } else { format!("{} parts", file.parts.len()) };
    let unread = unread.map_or(String::new(), |why| format!("; its values are not read: {why}"));
    let mut lines = vec![format!("{}: OpenEXR, {parts}, {} bytes{unread}", query.file.display(), file.length)];
    for (number, part) in file.parts.iter().enumerate() {
        if file.parts.len() > 1 {
            let name = part.name.as_deref().map_or(String::new(), |name| format!(" {}", short(name)));
            lines.push(format!("\npart {}{name}", number + 1));
        }
        let own = part.attributes.iter().filter(|(key, _)| !key.starts_with("render/"));
        let rest = own.filter(|(key, _)| !["screenWindowWidth", "screenWindowCenter"].contains(&key.as_str()));
        let rows = [picture(&file, part), camera(&file, part), rest.map(|(key, value)| row(key, value)).collect()];
        lines.extend(aligned(&rows.concat()));
        let origin = part.attributes.iter().filter(|(key, _)| key.starts_with("render/"));
        let origin: Vec<_> = origin.map(|(key, value)| row(key, value)).collect();
        if !origin.is_empty() {
            lines.push(String::new());
            lines.extend(aligned(&origin));
        }
        lines.push(String::new());
        lines.extend(channels(&file, part));
    }
    Ok(lines)
}

fn row(key: &str, value: &str) -> Vec<String> {
    vec![short(key), short(value)]
}

/// Shortens a long text and adds its length.
fn short(text: &str) -> String {
    match text.chars().count() {
        count if count > MOST_SHOWN => {
            format!("{} .. ({count} characters)", text.chars().take(MOST_SHOWN).collect::<String>())
        }
        _ => text.to_owned(),
    }
}

/// Returns the rows on size, windows, storage and color.
fn picture(file: &ExrFile, part: &Part) -> Vec<Vec<String>> {
    let [width, height] = file.display.size;
    let mut rows = vec![row("size", &format!("{width} x {height} pixels"))];
    if file.display.corner != [0, 0] {
        let [x, y] = file.display.corner;
        rows.push(row("begins at", &format!("({x}, {y})")));
    }
    rows.extend(window(&file.display, &part.bounds).map(|(key, value)| row(key, &value)));
    if file.pixel_aspect != 1.0 {
        rows.push(row("pixels", &format!("{} times as wide as high", file.pixel_aspect)));
    }
    rows.push(row("storage", &part.storage));
    if let Some(primaries) = file.chromaticities {
        rows.push(row("chromaticities", &chromaticities(&primaries)));
    }
    rows
}

/// Returns a row on the stored pixels and how they lie in the full image, or none if they cover exactly that.
fn window(full: &PixelBounds, there: &PixelBounds) -> Option<(&'static str, String)> {
    if full == there {
        return None;
    }
    let ([left, top], [right, bottom]) = (there.corner, there.last());
    let exceeds = |a: &PixelBounds, b: &PixelBounds| {
        (0..2).any(|axis| a.corner[axis] < b.corner[axis] || a.last()[axis] > b.last()[axis])
    };
    let key = match (exceeds(full, there), exceeds(there, full)) {
        (true, false) => "crop",
        (false, _) => "overscan",
        (true, true) => "crop and overscan",
    };
    let [width, height] = there.size;
    Some((key, format!("{width} x {height} pixels are stored, ({left}, {top}) to ({right}, {bottom})")))
}

fn chromaticities(found: &Primaries) -> String {
    let known = found.space().map_or(String::new(), |space| format!(" ({})", space.interop_id()));
    let [red, green, blue, white] =
        [found.red, found.green, found.blue, found.white].map(|[x, y]| format!("{x:.4} {y:.4}"));
    format!("red {red}, green {green}, blue {blue}, white {white}{known}")
}

/// Returns the rows on the position, direction and field of view of the camera.
fn camera(file: &ExrFile, part: &Part) -> Vec<Vec<String>> {
    let Some(matrix) = part.camera else { return Vec::new() };
    let mut rows = match place(&matrix) {
        Some((position, forward)) => {
            vec![row("camera", &format!("at {}, looks along {}", triple(position), triple(forward)))]
        }
        None => vec![row("worldToCamera", &matrix.map(|x| x.to_string()).join(" "))],
    };
    let said = |key: &str| part.attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str());
    let width: Option<f64> = said("screenWindowWidth").and_then(|width| width.parse().ok());
    let [columns, lines] = file.display.size.map(|size| size as f64);
    let Some(width) = width else { return rows };
    let height = width * lines / columns / f64::from(file.pixel_aspect);
    rows.push(match said("render/projection") {
        None | Some("perspective") => {
            let [across, up] = [width, height].map(|size| 2.0 * libm::atan(0.5 * size).to_degrees());
            row("field of view", &format!("{across:.2} degrees across, {up:.2} up"))
        }
        Some(_) => row("view", &format!("{} across, {} up", number(width), number(height))),
    });
    rows.extend(said("screenWindowCenter").map(|center| row("view center", center)));
    rows
}

/// Returns the position and the direction of a camera from its matrix for row vectors, if this only rotates and
/// translates.
fn place(matrix: &CameraMatrix) -> Option<([f64; 3], [f64; 3])> {
    let row = |i: usize| -> [f64; 3] { std::array::from_fn(|j| matrix[4 * i + j].into()) };
    let dot = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|i| a[i] * b[i]).sum() };
    let turns = (0..3).all(|i| (0..3).all(|j| (dot(row(i), row(j)) - f64::from(u8::from(i == j))).abs() < 1e-3));
    let position = [0, 1, 2].map(|i| -dot(row(3), row(i)));
    turns.then(|| (position, [0, 1, 2].map(|i| row(i)[2])))
}

fn triple(values: [f64; 3]) -> String {
    format!("({})", values.map(number).join(", "))
}

/// Returns a table with a line for each channel of a part.
fn channels(file: &ExrFile, part: &Part) -> Vec<String> {
    let head = ["layer", "channel", "type", "min", "mean", "max", ""].map(str::to_owned).to_vec();
    let mut rows = vec![head];
    for layer in file.layers().iter().filter(|layer| std::ptr::eq(layer.part, part)) {
        rows.extend(layer.channels.iter().map(|channel| line(layer, channel)));
    }
    aligned(&rows)
}

fn line(layer: &ExrLayer, channel: &Channel) -> Vec<String> {
    let Statistics { nan, infinite, finite, min, max, mean } = channel.statistics();
    let [min, mean, max] = [min, mean, max].map(|x| if finite > 0 { number(x) } else { "-".into() });
    let broken = [(nan, "NaN"), (infinite, "infinite")].into_iter().filter(|(count, _)| *count > 0);
    let mut told: Vec<String> = broken.map(|(count, what)| format!("{count} {what}")).collect();
    if let [across, down] = channel.sampling
        && [across, down] != [1, 1]
    {
        told.push(format!("one value per {across} x {down} pixels"));
    }
    let [layer, name] = [&layer.name, &channel.name].map(|text| short(text));
    vec![layer, name, channel.kind().into(), min, mean, max, told.join(", ")]
}
