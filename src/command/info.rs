//! `render info`: what an OpenEXR file carries.

use std::path::PathBuf;

use abbe::Result;
use abbe::film::{CameraMatrix, Channel, ExrFile, ExrLayer, Part, PixelBounds, Statistics};
use abbe::look::number;
use abbe::spectrum::Primaries;
use clap::Parser;

use super::messages::align_columns;

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
const MAX_SHOWN_CHARACTERS: usize = 200;

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
            let name = part.name.as_deref().map_or(String::new(), |name| format!(" {}", shortened(name)));
            lines.push(format!("\npart {}{name}", number + 1));
        }
        let own = part.attributes.iter().filter(|(key, _)| !key.starts_with("render/"));
        let rest = own.filter(|(key, _)| !["screenWindowWidth", "screenWindowCenter"].contains(&key.as_str()));
        let rows =
            [picture_rows(&file, part), camera_rows(&file, part), rest.map(|(key, value)| row(key, value)).collect()];
        lines.extend(align_columns(&rows.concat()));
        let origin = part.attributes.iter().filter(|(key, _)| key.starts_with("render/"));
        let origin: Vec<_> = origin.map(|(key, value)| row(key, value)).collect();
        if !origin.is_empty() {
            lines.push(String::new());
            lines.extend(align_columns(&origin));
        }
        lines.push(String::new());
        lines.extend(channel_table(&file, part));
    }
    Ok(lines)
}

fn row(key: &str, value: &str) -> Vec<String> {
    vec![shortened(key), shortened(value)]
}

/// Shortens a long text and adds its length.
fn shortened(text: &str) -> String {
    match text.chars().count() {
        count if count > MAX_SHOWN_CHARACTERS => {
            format!("{} .. ({count} characters)", text.chars().take(MAX_SHOWN_CHARACTERS).collect::<String>())
        }
        _ => text.to_owned(),
    }
}

/// Returns the rows on size, windows, storage and color.
fn picture_rows(file: &ExrFile, part: &Part) -> Vec<Vec<String>> {
    let [width, height] = file.display.size;
    let mut rows = vec![row("size", &format!("{width} x {height} pixels"))];
    if file.display.corner != [0, 0] {
        let [x, y] = file.display.corner;
        rows.push(row("begins at", &format!("({x}, {y})")));
    }
    rows.extend(window_row(&file.display, &part.bounds).map(|(key, value)| row(key, &value)));
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
fn window_row(full: &PixelBounds, stored: &PixelBounds) -> Option<(&'static str, String)> {
    if full == stored {
        return None;
    }
    let ([left, top], [right, bottom]) = (stored.corner, stored.last());
    let exceeds = |a: &PixelBounds, b: &PixelBounds| {
        (0..2).any(|axis| a.corner[axis] < b.corner[axis] || a.last()[axis] > b.last()[axis])
    };
    let key = match (exceeds(full, stored), exceeds(stored, full)) {
        (true, false) => "crop",
        (false, _) => "overscan",
        (true, true) => "crop and overscan",
    };
    let [width, height] = stored.size;
    Some((key, format!("{width} x {height} pixels are stored, ({left}, {top}) to ({right}, {bottom})")))
}

fn chromaticities(found: &Primaries) -> String {
    let space_name = found.space().map_or(String::new(), |space| format!(" ({})", space.interop_id()));
    let [red, green, blue, white] =
        [found.red, found.green, found.blue, found.white].map(|[x, y]| format!("{x:.4} {y:.4}"));
    format!("red {red}, green {green}, blue {blue}, white {white}{space_name}")
}

/// Returns the rows on the position, direction and field of view of the camera.
fn camera_rows(file: &ExrFile, part: &Part) -> Vec<Vec<String>> {
    let Some(matrix) = part.camera else { return Vec::new() };
    let mut rows = match camera_pose(&matrix) {
        Some((position, forward)) => {
            vec![row("camera", &format!("at {}, looks along {}", triple(position), triple(forward)))]
        }
        None => vec![row("worldToCamera", &matrix.map(|x| x.to_string()).join(" "))],
    };
    let attribute = |key: &str| part.attributes.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str());
    let width: Option<f64> = attribute("screenWindowWidth").and_then(|width| width.parse().ok());
    let [columns, lines] = file.display.size.map(|size| size as f64);
    let Some(width) = width else { return rows };
    let height = width * lines / columns / f64::from(file.pixel_aspect);
    rows.push(match attribute("render/projection") {
        None | Some("perspective") => {
            let [across, up] = [width, height].map(|size| 2.0 * libm::atan(0.5 * size).to_degrees());
            row("field of view", &format!("{across:.2} degrees across, {up:.2} up"))
        }
        Some(_) => row("view", &format!("{} across, {} up", number(width), number(height))),
    });
    rows.extend(attribute("screenWindowCenter").map(|center| row("view center", center)));
    rows
}

/// Returns the position and the direction of a camera from its matrix for row vectors, if this only rotates and
/// translates.
fn camera_pose(matrix: &CameraMatrix) -> Option<([f64; 3], [f64; 3])> {
    let row = |i: usize| -> [f64; 3] { std::array::from_fn(|j| matrix[4 * i + j].into()) };
    let dot = |a: [f64; 3], b: [f64; 3]| -> f64 { (0..3).map(|i| a[i] * b[i]).sum() };
    let is_rigid = (0..3).all(|i| (0..3).all(|j| (dot(row(i), row(j)) - f64::from(u8::from(i == j))).abs() < 1e-3));
    let position = [0, 1, 2].map(|i| -dot(row(3), row(i)));
    is_rigid.then(|| (position, [0, 1, 2].map(|i| row(i)[2])))
}

fn triple(values: [f64; 3]) -> String {
    format!("({})", values.map(number).join(", "))
}

/// Returns a table with a line for each channel of a part.
fn channel_table(file: &ExrFile, part: &Part) -> Vec<String> {
    let head = ["layer", "channel", "type", "min", "mean", "max", ""].map(str::to_owned).to_vec();
    let mut rows = vec![head];
    for layer in file.layers().iter().filter(|layer| std::ptr::eq(layer.part, part)) {
        rows.extend(layer.channels.iter().map(|channel| channel_row(layer, channel)));
    }
    align_columns(&rows)
}

fn channel_row(layer: &ExrLayer, channel: &Channel) -> Vec<String> {
    let Statistics { nan, infinite, finite, min, max, mean } = channel.statistics();
    let [min, mean, max] = [min, mean, max].map(|x| if finite > 0 { number(x) } else { "-".into() });
    let broken = [(nan, "NaN"), (infinite, "infinite")].into_iter().filter(|(count, _)| *count > 0);
    let mut notes: Vec<String> = broken.map(|(count, what)| format!("{count} {what}")).collect();
    if let [across, down] = channel.sampling
        && [across, down] != [1, 1]
    {
        notes.push(format!("one value per {across} x {down} pixels"));
    }
    let [layer, name] = [&layer.name, &channel.name].map(|text| shortened(text));
    vec![layer, name, channel.kind().into(), min, mean, max, notes.join(", ")]
}
