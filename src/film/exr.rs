//! Writes the film as a scan-line OpenEXR file. The same film always gives the same bytes.

use std::borrow::Cow;
use std::fmt;
use std::io::Cursor;
use std::path::Path;
use std::time::SystemTime;

use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{AttributeValue, ImageAttributes, IntegerBounds, LayerAttributes, Text, Vec2};
use serde::{Deserialize, Serialize};

use super::atomic_file::replace_with;
use super::exr_blocks::{self, CLAMPED_KEY, ScanLinePart};
use super::exr_column::{Column, ColumnContent};
use super::format::{Compression, Format, Precision};
use super::image::Film;
use super::rows::Rows;
use super::time::cap_date;
use crate::error::Result;

/// The camera, as the file records it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraView {
    /// World to camera for row vectors, left-handed: +x right, +y up, +z forward (OpenEXR standard attributes).
    pub world_to_camera: [[f64; 4]; 4],
    /// World to normalized device coordinates for row vectors: x and y are 0 at the top left corner of the full image
    /// and 1 at the bottom right one. None for a view of the full sphere.
    pub world_to_ndc: Option<[[f64; 4]; 4]>,
    /// The width of the image in the plane one unit in front of the camera.
    pub screen_window_width: f64,
    /// The center of the image in the plane one unit in front of the camera, measured to the right and up.
    pub screen_window_center: [f64; 2],
    /// Whether the image shows all directions by longitude and latitude.
    pub latlong: bool,
    /// The lens and the sensor.
    pub optics: Optics,
}

/// Data that a real camera would record, as far as the scene defines it (OpenEXR, *Standard Attributes*).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Optics {
    /// Distance at which rays start, in scene units.
    pub near: Option<f64>,
    /// Width and height of the sensor, in mm.
    pub sensor: Option<[f64; 2]>,
    /// Distance from the sensor to the pinhole, or to the center of the lens, in mm.
    pub pinhole_focal_length: Option<f64>,
    /// Focal length of the lens, in mm.
    pub focal_length: Option<f64>,
    /// Focal length divided by the diameter of the aperture.
    pub f_number: Option<f64>,
    /// Distance from the lens to the plane in focus, in m. May be infinite.
    pub focus: Option<f64>,
}

/// The origin of the image: everything that another run needs to reproduce the same bytes. The time of day is recorded
/// only on request.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Key and value of each attribute. Keys are written with the prefix `render/`.
    pub facts: Vec<(Cow<'static, str>, Fact)>,
    /// The time at which the image was made.
    pub time: Option<SystemTime>,
}

impl Provenance {
    /// Returns the count stored under a key, or none if there is no such count.
    pub fn count(&self, key: &str) -> Option<u64> {
        self.facts.iter().find_map(|(known, fact)| match fact {
            Fact::Count(count) if known == key => Some(*count),
            _ => None,
        })
    }

    /// Sets the count stored under a key, if the key exists.
    pub fn set_count(&mut self, key: &str, count: u64) {
        self.facts.iter_mut().filter(|(known, _)| known == key).for_each(|(_, fact)| *fact = Fact::Count(count));
    }
}

/// One value of the provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fact {
    /// A string attribute.
    Text(String),
    /// An int attribute. A count beyond 2^31 - 1 is written as a double.
    Count(u64),
    /// A double attribute.
    Number(f64),
}

impl fmt::Display for Fact {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Text(text) => write!(formatter, "{text}"),
            Self::Count(count) => write!(formatter, "{count}"),
            Self::Number(number) => write!(formatter, "{number}"),
        }
    }
}

/// Everything that a file records about an image besides its pixels.
#[derive(Clone, Copy, Debug)]
pub struct Heading<'a> {
    /// The image: only its size, its layers and their names are used, not its pixels.
    pub film: &'a Film,
    /// The format of the file.
    pub format: &'a Format,
    /// The camera.
    pub view: &'a CameraView,
    /// The origin of the image.
    pub provenance: &'a Provenance,
}

/// Writes a linear image: R, G, B, A and Z, and its layers. Returns how many values exceeded the range of the precision
/// and were clamped to the largest value that fits.
///
/// The data window covers the rendered pixels. The display window covers the format, as does the screen window.
/// Compositors therefore place a crop correctly within the format, and overscan around it. Writing needs memory for
/// only a few blocks of rows.
///
/// # Errors
/// If rows cannot be read, or the file cannot be encoded or written. An existing file is then untouched.
pub fn write_exr(heading: Heading, rows: &mut dyn Rows, path: impl AsRef<Path>) -> Result<u64> {
    let path = path.as_ref();
    replace_with(path, |output| exr_blocks::write(&parts(heading), rows, output, path))
}

/// Encodes the file that [`write_exr`] writes. Returns its bytes and how many values were clamped; `path` names the
/// file in errors.
///
/// # Errors
/// If rows cannot be read, or the file cannot be encoded.
pub fn encode_exr(heading: Heading, rows: &mut dyn Rows, path: impl AsRef<Path>) -> Result<(Vec<u8>, u64)> {
    let mut bytes = Cursor::new(Vec::new());
    let clamped = exr_blocks::write(&parts(heading), rows, &mut bytes, path.as_ref())?;
    Ok((bytes.into_inner(), clamped))
}

/// Returns the parts of the file: a single one, or one for the image and one for each layer if the format is multipart.
fn parts(heading: Heading) -> Vec<ScanLinePart> {
    let Heading { film, format, .. } = heading;
    let half = format.precision == Precision::Half;
    let mut attributes = attributes(heading);
    for manifest in &film.manifests {
        for (key, value) in [
            ("name", &*manifest.name),
            ("hash", "MurmurHash3_32"),
            ("conversion", "uint32_to_float32"),
            ("manifest", &manifest.json()),
        ] {
            let name = Text::new_or_panic(format!("cryptomatte/{}/{key}", manifest.key()));
            attributes.other.insert(name, AttributeValue::Text(utf8(value)));
        }
    }
    if half {
        // A placeholder: the count is known once the pixels are written.
        attributes.other.insert(Text::from(CLAMPED_KEY), AttributeValue::I32(0));
    }
    let mut shared = ImageAttributes::new(display_window(film));
    // Chromaticities would apply to all parts, including those without colors.
    shared.chromaticities = (!format.multipart).then(|| chromaticities(film));
    let part = |(number, group): (usize, Group)| {
        let own =
            if number == 0 { attributes.clone() } else { other_part_attributes(film, &attributes, group.has_colors) };
        let name = format.multipart.then(|| Text::new_or_panic(group.name));
        let packed = if group.is_data && format.compression.is_lossy() { Compression::Zip } else { format.compression };
        ScanLinePart::new(film, group.columns, packed, shared.clone(), LayerAttributes { layer_name: name, ..own })
    };
    groups(film, format, half).into_iter().enumerate().map(part).collect()
}

/// The channels of one part.
struct Group<'f> {
    name: &'f str,
    /// Whether the part holds data other than colors, separate from the image.
    is_data: bool,
    /// Whether the part holds colors in the film's color space.
    has_colors: bool,
    columns: Vec<Column>,
}

/// Groups the channels by part. Color channels have 16 bits if `half` is set.
fn groups<'f>(film: &'f Film, format: &Format, half: bool) -> Vec<Group<'f>> {
    let mut image = vec![Column::new("A", half, ColumnContent::Alpha)];
    image.extend(colors(half));
    let mut groups = vec![Group { name: "image", is_data: false, has_colors: true, columns: image }];
    if format.multipart {
        // Blender does not recognize R, G, B and A as a color if another channel shares their part.
        groups.push(Group { name: "depth", is_data: true, has_colors: false, columns: Vec::new() });
    }
    groups.last_mut().expect("the image comes first").columns.push(Column::new("Z", false, ColumnContent::Depth));
    for (layer, image) in film.layers.iter().enumerate() {
        if format.multipart {
            let (is_data, has_colors) = (!image.layer.is_color(), image.layer.has_color_space());
            groups.push(Group { name: &image.name, is_data, has_colors, columns: Vec::new() });
        }
        let columns = image.layer.channels().iter().enumerate().map(|(channel, name)| {
            let is_half = half && image.layer.may_be_half();
            Column::new(&format!("{}.{name}", image.name), is_half, ColumnContent::Layer { layer, channel })
        });
        groups.last_mut().expect("the image comes first").columns.extend(columns);
    }
    groups
}

/// Returns the columns of red, green and blue.
pub(super) fn colors(is_half: bool) -> impl Iterator<Item = Column> {
    ["R", "G", "B"]
        .into_iter()
        .enumerate()
        .map(move |(number, name)| Column::new(name, is_half, ColumnContent::Color(number)))
}

/// Returns the bounds of the full image.
pub(super) fn display_window(film: &Film) -> IntegerBounds {
    IntegerBounds::from_dimensions((film.full[0] as usize, film.full[1] as usize))
}

pub(super) fn chromaticities(film: &Film) -> Chromaticities {
    let primaries = film.color_space.primaries();
    let [red, green, blue, white] =
        [primaries.red, primaries.green, primaries.blue, primaries.white].map(|[x, y]| Vec2(x as f32, y as f32));
    Chromaticities { red, green, blue, white }
}

/// Converts text in any language. The type is meant for Latin-1, but readers interpret its bytes as UTF-8.
fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

/// Returns the attributes of a part other than the first: its position, its view and the meaning of its numbers. All
/// colors of a file share one color space.
fn other_part_attributes(film: &Film, attributes: &LayerAttributes, has_colors: bool) -> LayerAttributes {
    let mut own = LayerAttributes {
        layer_position: attributes.layer_position,
        screen_window_width: attributes.screen_window_width,
        screen_window_center: attributes.screen_window_center,
        ..LayerAttributes::default()
    };
    let space = if has_colors { film.color_space.interop_id() } else { "data" };
    own.other.insert(Text::from("colorInteropID"), AttributeValue::Text(Text::from(space)));
    own
}

/// Returns the attributes of the first part.
pub(super) fn attributes(heading: Heading) -> LayerAttributes {
    let Heading { film, format, view, provenance } = heading;
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("Abbe ", env!("CARGO_PKG_VERSION")))),
        owner: format.owner.as_deref().map(utf8),
        white_luminance: format.white_luminance.map(|luminance| luminance as f32),
        comments: format.comments.as_deref().map(utf8),
        frames_per_second: format.frames_per_second.map(|[frames, seconds]| (frames as i32, seconds)),
        // Readers take an environment's data window for the full sphere, which crops and overscan are not.
        environment_map: (view.latlong && film.corner == [0, 0] && film.full == [film.width, film.height])
            .then_some(EnvironmentMap::LatitudeLongitude),
        layer_position: Vec2(film.corner[0], film.corner[1]),
        screen_window_width: view.screen_window_width as f32,
        screen_window_center: vector(view.screen_window_center),
        world_to_camera: Some(matrix(&view.world_to_camera)),
        world_to_normalized_device: view.world_to_ndc.as_ref().map(matrix),
        near_clip_plane: view.optics.near.map(|near| near as f32),
        focus: view.optics.focus.map(|focus| focus as f32),
        aperture: view.optics.f_number.map(|number| number as f32),
        capture_date: provenance.time.map(|time| Text::new_or_panic(cap_date(time))),
        utc_offset: provenance.time.map(|_| 0.0),
        ..LayerAttributes::default()
    };
    let optics = [
        ("sensorOverallDimensions", view.optics.sensor.map(|mm| AttributeValue::FloatVec2(vector(mm)))),
        ("pinholeFocalLength", view.optics.pinhole_focal_length.map(|mm| AttributeValue::F32(mm as f32))),
        ("effectiveFocalLength", view.optics.focal_length.map(|mm| AttributeValue::F32(mm as f32))),
    ];
    let known = optics.into_iter().filter_map(|(name, value)| Some((Text::from(name), value?)));
    attributes.other.extend(known);
    let text = |value: &str| AttributeValue::Text(Text::new_or_panic(value));
    attributes.other.insert(Text::from("colorInteropID"), text(film.color_space.interop_id()));
    for (key, fact) in &provenance.facts {
        let value = match fact {
            Fact::Text(value) => AttributeValue::Text(utf8(value)),
            Fact::Count(count) => i32::try_from(*count).map_or(AttributeValue::F64(*count as f64), AttributeValue::I32),
            Fact::Number(number) => AttributeValue::F64(*number),
        };
        attributes.other.insert(Text::new_or_panic(format!("render/{key}")), value);
    }
    attributes
}

fn vector([x, y]: [f64; 2]) -> Vec2<f32> {
    Vec2(x as f32, y as f32)
}

fn matrix(rows: &[[f64; 4]; 4]) -> [f32; 16] {
    std::array::from_fn(|i| rows[i / 4][i % 4] as f32)
}
