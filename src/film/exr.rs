//! The film as an OpenEXR file: one part, scan lines, ZIP, float; the same bytes for the same film.

use std::io::Cursor;
use std::path::Path;

use exr::meta::attribute::{Chromaticities, EnvironmentMap};
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image, IntegerBounds, Layer,
    LayerAttributes, LineOrder, SmallVec, Text, Vec2, WritableImage,
};

use super::file::replace_file;
use super::image::{Film, Pixel};
use crate::error::{Error, Result};

/// How the camera saw, as the file records it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// World to camera for row vectors, left-handed: +x right, +y up, +z forward (OpenEXR standard attributes).
    pub world_to_camera: [[f64; 4]; 4],
    /// Width of the image in the plane one unit before the camera.
    pub screen_window_width: f64,
    /// The middle of the image there, to the right and up.
    pub screen_window_center: [f64; 2],
    /// Whether the image shows all directions by longitude and latitude.
    pub latlong: bool,
}

/// Where the image comes from: everything that another run needs to make the same bytes, and no time of day.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Provenance {
    /// Key and value of each attribute; keys are written below `render/`.
    pub facts: Vec<(&'static str, Fact)>,
}

/// One value of the provenance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fact {
    /// A string attribute.
    Text(String),
    /// An int attribute; counts beyond 2^31 - 1 are written as that.
    Count(u64),
}

/// Writes channels R, G, B, A, Z and samples.V, linear, in 32-bit float.
///
/// A crop is the data window, the full image the display window, which is also what the screen window spans:
/// compositors lay the crop over the image at its place.
///
/// # Errors
/// If the file cannot be encoded or written; a file that was there before is then untouched.
pub fn write_exr(film: &Film, view: &View, provenance: &Provenance, path: &Path) -> Result<()> {
    let encode = |error: exr::error::Error| Error::Encode { path: path.to_owned(), message: error.to_string() };
    let size = Vec2(film.width as usize, film.height as usize);
    let channel = |name: &str, value: &dyn Fn(&Pixel) -> f32| {
        let samples = FlatSamples::F32(film.pixels.iter().map(value).collect());
        AnyChannel { name: Text::from(name), sample_data: samples, quantize_linearly: false, sampling: Vec2(1, 1) }
    };
    let mut list = SmallVec::new();
    list.push(channel("A", &|pixel| pixel.alpha));
    list.push(channel("B", &|pixel| pixel.rgb[2]));
    list.push(channel("G", &|pixel| pixel.rgb[1]));
    list.push(channel("R", &|pixel| pixel.rgb[0]));
    list.push(channel("Z", &|pixel| pixel.depth));
    // A channel in a layer of its own is also what makes Blender offer the depth to its compositor.
    list.push(channel("samples.V", &|pixel| pixel.samples));
    let encoding =
        Encoding { compression: Compression::ZIP16, line_order: LineOrder::Increasing, ..Encoding::UNCOMPRESSED };
    let layer = Layer::new(size, attributes(film, view, provenance), encoding, AnyChannels::sort(list));
    let mut image = Image::from_layer(layer);
    image.attributes.display_window = IntegerBounds::from_dimensions((film.full[0] as usize, film.full[1] as usize));
    let primaries = film.color_space.primaries();
    let [red, green, blue, white] =
        [primaries.red, primaries.green, primaries.blue, primaries.white].map(|[x, y]| Vec2(x as f32, y as f32));
    image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(encode)?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    replace_file(path, &bytes)
}

fn attributes(film: &Film, view: &View, provenance: &Provenance) -> LayerAttributes {
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("Abbe ", env!("CARGO_PKG_VERSION")))),
        // Readers take the data window of an environment for the full sphere, which a crop is not.
        environment_map: (view.latlong && film.full == [film.width, film.height])
            .then_some(EnvironmentMap::LatitudeLongitude),
        layer_position: Vec2(film.corner[0] as i32, film.corner[1] as i32),
        screen_window_width: view.screen_window_width as f32,
        screen_window_center: Vec2(view.screen_window_center[0] as f32, view.screen_window_center[1] as f32),
        world_to_camera: Some(std::array::from_fn(|i| view.world_to_camera[i / 4][i % 4] as f32)),
        ..LayerAttributes::default()
    };
    let text = |value: &str| AttributeValue::Text(Text::new_or_panic(value));
    attributes.other.insert(Text::from("colorInteropID"), text(film.color_space.interop_id()));
    for (key, fact) in &provenance.facts {
        let value = match fact {
            Fact::Text(value) => text(value),
            Fact::Count(count) => AttributeValue::I32(i32::try_from(*count).unwrap_or(i32::MAX)),
        };
        attributes.other.insert(Text::new_or_panic(format!("render/{key}")), value);
    }
    attributes
}

/// Puts the attributes of a single-part file into alphabetical order.
///
/// The encoder keeps them in a hash map, whose order changes from run to run; the header's length does not depend on
/// it, so no offset in the file changes.
fn sort_attributes(file: &mut [u8]) {
    const START: usize = 8; // magic number and version
    let text_end = |from: usize| from + file[from..].iter().position(|&byte| byte == 0).unwrap_or(0) + 1;
    let (mut at, mut entries) = (START, Vec::new());
    while file[at] != 0 {
        let size_at = text_end(text_end(at));
        let size = u32::from_le_bytes([file[size_at], file[size_at + 1], file[size_at + 2], file[size_at + 3]]);
        let end = size_at + 4 + size as usize;
        entries.push(file[at..end].to_vec());
        at = end;
    }
    entries.sort();
    file[START..at].copy_from_slice(&entries.concat());
}
