//! The film as an OpenEXR file of scan lines; the same bytes for the same film.

use std::borrow::Cow;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;

use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatImage, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer, LayerAttributes, LineOrder, SmallVec, Text, Vec2, f16,
};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use serde::{Deserialize, Serialize};

use super::exr_blocks;
use super::file::replace_file;
use super::format::{Compression, Format, Precision};
use super::image::Film;
use super::time::cap_date;
use crate::error::{Error, Result};

/// How the camera saw, as the file records it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// World to camera for row vectors, left-handed: +x right, +y up, +z forward (OpenEXR standard attributes).
    pub world_to_camera: [[f64; 4]; 4],
    /// World to normalized device coordinates for row vectors: x and y are 0 at the top left corner of the full image,
    /// 1 at the bottom right one; none of a view all around.
    pub world_to_ndc: Option<[[f64; 4]; 4]>,
    /// Width of the image in the plane one unit before the camera.
    pub screen_window_width: f64,
    /// The middle of the image there, to the right and up.
    pub screen_window_center: [f64; 2],
    /// Whether the image shows all directions by longitude and latitude.
    pub latlong: bool,
    /// The lens and what is behind it.
    pub optics: Optics,
}

/// What a camera of glass and metal would say of itself, as far as the scene knows it (OpenEXR, *Standard Attributes*).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Optics {
    /// Distance at which rays start, in scene units.
    pub near: Option<f64>,
    /// Width and height of the sensor, in mm.
    pub sensor: Option<[f64; 2]>,
    /// Distance from the sensor to the pinhole, or to the middle of the lens, in mm.
    pub pinhole_focal_length: Option<f64>,
    /// Focal length of the lens, in mm.
    pub focal_length: Option<f64>,
    /// Focal length over the diameter of the opening.
    pub f_number: Option<f64>,
    /// Distance from the lens to the plane in focus, in m; may be infinite.
    pub focus: Option<f64>,
}

/// Where the image comes from: everything that another run needs to make the same bytes, and no time of day unless that
/// is asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Key and value of each attribute; keys are written below `render/`.
    pub facts: Vec<(Cow<'static, str>, Fact)>,
    /// When the image was made.
    pub time: Option<SystemTime>,
}

/// One value of the provenance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fact {
    /// A string attribute.
    Text(String),
    /// An int attribute; counts beyond 2^31 - 1 are written as that.
    Count(u64),
    /// A double attribute.
    Number(f64),
}

/// Writes a linear image: R, G, B, A and Z, and the layers that it has beside them. Answers how many values were too
/// large for the precision and became the largest that fits.
///
/// What was made is the data window, the format the display window, which is also what the screen window spans:
/// compositors lay a crop over the format at its place, and overscan around it.
///
/// # Errors
/// If the file cannot be encoded or written; a file that was there before is then untouched.
pub fn write_exr(film: &Film, format: &Format, view: &View, provenance: &Provenance, path: &Path) -> Result<u64> {
    let (bytes, clamped) = encode_exr(film, format, view, provenance, path)?;
    replace_file(path, &bytes)?;
    Ok(clamped)
}

/// The bytes of such a file, and how many values were too large; `path` is what it is called in an error.
///
/// # Errors
/// If it cannot be encoded.
pub fn encode_exr(
    film: &Film,
    format: &Format,
    view: &View,
    provenance: &Provenance,
    path: &Path,
) -> Result<(Vec<u8>, u64)> {
    let half = format.precision == Precision::Half;
    let mut channels = Channels { half, ..Channels::new(film) };
    let parts = parts(film, format, &mut channels);
    let mut attributes = attributes(film, format, view, provenance);
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
    if channels.half {
        let clamped = AttributeValue::I32(i32::try_from(channels.clamped).unwrap_or(i32::MAX));
        attributes.other.insert(Text::from("render/clamped"), clamped);
    }
    let size = Vec2(film.width as usize, film.height as usize);
    let part = |(number, part): (usize, Part)| {
        let own = if number == 0 { attributes.clone() } else { of_data(&attributes) };
        let name = format.multipart.then(|| Text::new_or_panic(part.name));
        let packed = if part.is_data && format.compression.is_lossy() { Compression::Zip } else { format.compression };
        let own = LayerAttributes { layer_name: name, ..own };
        Layer::new(size, own, encoding(packed), AnyChannels::sort(part.channels))
    };
    let layers: Vec<_> = parts.into_iter().enumerate().map(part).collect();
    let mut image = Image::from_layers(ImageAttributes::new(display_window(film)), layers);
    // The chromaticities would be those of all parts, also of those that hold no colors.
    image.attributes.chromaticities = (!format.multipart).then(|| chromaticities(film));
    Ok((encode_image(image, path)?, channels.clamped))
}

/// The bytes of a file of parts.
pub(super) fn encode_image(image: FlatImage, path: &Path) -> Result<Vec<u8>> {
    let encode = |error: exr::error::Error| Error::Encode { path: path.to_owned(), message: error.to_string() };
    let mut bytes = exr_blocks::file(&image).map_err(encode)?;
    drop(image);
    sort_attributes(&mut bytes);
    Ok(bytes)
}

pub(super) type Channel = AnyChannel<FlatSamples>;

/// A part of the file.
struct Part {
    name: String,
    /// Whether it holds what is no color, apart from the image.
    is_data: bool,
    channels: SmallVec<[Channel; 4]>,
}

/// Makes channels, and counts what does not fit into them.
pub(super) struct Channels {
    half: bool,
    /// Of each channel.
    pixels: usize,
    clamped: u64,
}

impl Channels {
    /// Of 32 bits, for the pixels of a film.
    pub(super) fn new(film: &Film) -> Self {
        Self { half: false, pixels: film.pixels.len(), clamped: 0 }
    }

    /// A channel of some name, of the value of each pixel; it has 16 bits if it may and colors have.
    pub(super) fn of(&mut self, name: &str, may_be_half: bool, value: impl Fn(usize) -> f32 + Send + Sync) -> Channel {
        let pixels = (0..self.pixels).into_par_iter();
        let sample_data = if self.half && may_be_half {
            let clamped = AtomicU64::new(0);
            let halves = pixels.map(|pixel| half(value(pixel), &clamped)).collect();
            self.clamped += clamped.into_inner();
            FlatSamples::F16(halves)
        } else {
            FlatSamples::F32(pixels.map(value).collect())
        };
        AnyChannel { name: Text::new_or_panic(name), sample_data, quantize_linearly: false, sampling: Vec2(1, 1) }
    }
}

/// A value in 16 bits; one that does not fit is counted, and becomes the largest that does.
fn half(value: f32, clamped: &AtomicU64) -> f16 {
    let half = f16::from_f32(value);
    if half.is_finite() {
        return half;
    }
    clamped.fetch_add(1, Ordering::Relaxed);
    if value > 0.0 { f16::MAX } else { f16::MIN }
}

/// What the file holds: one part, or one for the image and each layer if the format sets them apart.
fn parts(film: &Film, format: &Format, channels: &mut Channels) -> Vec<Part> {
    let mut image = SmallVec::new();
    image.push(channels.of("A", true, |pixel| film.pixels[pixel].alpha));
    for (number, name) in ["R", "G", "B"].into_iter().enumerate() {
        image.push(channels.of(name, true, |pixel| film.pixels[pixel].rgb[number]));
    }
    let depth = channels.of("Z", false, |pixel| film.pixels[pixel].depth);
    let mut parts = vec![Part { name: "image".to_owned(), is_data: false, channels: image }];
    if format.multipart {
        // Blender takes a part of R, G, B, A and another channel for none of what they are.
        parts.push(Part { name: "depth".to_owned(), is_data: true, channels: SmallVec::new() });
    }
    parts.last_mut().expect("the image comes first").channels.push(depth);
    for image in &film.layers {
        if format.multipart {
            let is_data = !image.layer.is_color();
            parts.push(Part { name: image.name.clone(), is_data, channels: SmallVec::new() });
        }
        let part = parts.last_mut().expect("the image comes first");
        let names = image.layer.channels();
        for (number, channel) in names.iter().enumerate() {
            let value = |pixel: usize| image.values[pixel * names.len() + number];
            part.channels.push(channels.of(&format!("{}.{channel}", image.name), image.layer.may_be_half(), value));
        }
    }
    parts
}

/// Rows from the top, packed in a way.
pub(super) fn encoding(packed: Compression) -> Encoding {
    Encoding { compression: compression(packed), line_order: LineOrder::Increasing, ..Encoding::UNCOMPRESSED }
}

fn compression(compression: Compression) -> exr::compression::Compression {
    use exr::compression::Compression as Exr;
    match compression {
        Compression::None => Exr::Uncompressed,
        Compression::Rle => Exr::RLE,
        Compression::Zips => Exr::ZIP1,
        Compression::Zip => Exr::ZIP16,
        Compression::Piz => Exr::PIZ,
        Compression::Pxr24 => Exr::PXR24,
        // The level is that of OpenEXR, 45; the attribute that could say another is deprecated.
        Compression::Dwaa => Exr::DWAA(None),
        Compression::Dwab => Exr::DWAB(None),
    }
}

/// The full image.
pub(super) fn display_window(film: &Film) -> IntegerBounds {
    IntegerBounds::from_dimensions((film.full[0] as usize, film.full[1] as usize))
}

pub(super) fn chromaticities(film: &Film) -> Chromaticities {
    let primaries = film.color_space.primaries();
    let [red, green, blue, white] =
        [primaries.red, primaries.green, primaries.blue, primaries.white].map(|[x, y]| Vec2(x as f32, y as f32));
    Chromaticities { red, green, blue, white }
}

/// Text of any language: the type is made for Latin-1, readers take the bytes for UTF-8.
fn utf8(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

/// The attributes of another part than the first: where it lies and how it was seen.
fn of_data(attributes: &LayerAttributes) -> LayerAttributes {
    let mut own = LayerAttributes {
        layer_position: attributes.layer_position,
        screen_window_width: attributes.screen_window_width,
        screen_window_center: attributes.screen_window_center,
        ..LayerAttributes::default()
    };
    own.other.insert(Text::from("colorInteropID"), AttributeValue::Text(Text::from("data")));
    own
}

/// The attributes of the first part.
pub(super) fn attributes(film: &Film, format: &Format, view: &View, provenance: &Provenance) -> LayerAttributes {
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("Abbe ", env!("CARGO_PKG_VERSION")))),
        owner: format.owner.as_deref().map(utf8),
        white_luminance: format.white_luminance.map(|luminance| luminance as f32),
        comments: format.comments.as_deref().map(utf8),
        // Readers take the data window of an environment for the full sphere, which crops and overscan are not.
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
            Fact::Text(value) => text(value),
            Fact::Count(count) => AttributeValue::I32(i32::try_from(*count).unwrap_or(i32::MAX)),
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

/// Puts the attributes of each part into alphabetical order.
///
/// The encoder keeps them in a hash map, whose order changes from run to run; the headers' length does not depend on
/// it, so no offset in the file changes.
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8; // magic number and version
    const SEVERAL_PARTS: u8 = 0x10; // of the second byte of the version
    let several = file[5] & SEVERAL_PARTS != 0;
    let mut at = START;
    loop {
        at = sort_header(file, at);
        // The list of several headers ends with an empty one.
        if !several || file[at] == 0 {
            return;
        }
    }
}

/// Sorts the attributes of one header, and answers where it ends.
fn sort_header(file: &mut [u8], start: usize) -> usize {
    let text_end = |file: &[u8], from: usize| from + file[from..].iter().position(|&byte| byte == 0).unwrap_or(0) + 1;
    let (mut at, mut entries) = (start, Vec::new());
    while file[at] != 0 {
        let size_at = text_end(file, text_end(file, at));
        let size = u32::from_le_bytes([file[size_at], file[size_at + 1], file[size_at + 2], file[size_at + 3]]);
        let end = size_at + 4 + size as usize;
        entries.push(file[at..end].to_vec());
        at = end;
    }
    entries.sort();
    file[start..at].copy_from_slice(&entries.concat());
    at + 1
}
