//! Reads complete OpenEXR files, written by any program.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{Cursor, ErrorKind, Read};
use std::path::Path;

use exr::meta::attribute::TileDescription;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{
    ChannelDescription, Compression, FlatSamples, LineOrder, ReadChannels, ReadLayers, SampleType, Vec2, read,
};

use super::atomic_file::cannot_read;
use super::decoder_guard::{MAX_PIXELS, catch_panics, check_claimed_sizes, fits, too_large};
use super::exr_attributes::{attributes, primaries, text};
use super::exr_layer::{BEAUTY, ExrLayer};
use super::exr_part::{Channel, Part, PixelBounds};
use crate::error::{Error, Result, has_extension, nearest, nearest_file};
use crate::spectrum::Primaries;

/// The largest file size that is read: 4 GiB.
const MAX_BYTES: u64 = 1 << 32;
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// The signatures of other image formats.
const OTHER_FORMATS: [(&[u8], &str); 3] = [(b"\x89PNG", "PNG"), (b"\xff\xd8\xff", "JPEG"), (b"#?", "Radiance picture")];

/// An OpenEXR file, with all its parts.
#[derive(Clone, Debug)]
pub struct ExrFile {
    /// Size of the file in bytes.
    pub length: usize,
    /// The display window: the full image. The data window of a part may be smaller or larger.
    pub display: PixelBounds,
    /// Width of a pixel divided by its height.
    pub pixel_aspect: f32,
    /// The chromaticities of red, green and blue, if the file specifies them numerically.
    pub chromaticities: Option<Primaries>,
    /// The parts in the order of the file.
    pub parts: Vec<Part>,
}

impl ExrFile {
    /// Reads a file with all its parts and channels. Of several resolution levels, reads the largest.
    ///
    /// # Errors
    /// [`Error::Arguments`] if the file does not exist or is clearly something else, such as a scene or a PNG;
    /// [`Error::Decode`] if it is no OpenEXR file, incomplete, or of an unsupported kind; [`Error::Io`] if reading
    /// fails.
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::of_bytes(&bytes(path)?, path)
    }

    /// Decodes the bytes of a file; `path` is its name in error messages.
    ///
    /// # Errors
    /// [`Error::Decode`] if they are no OpenEXR file, incomplete, or of an unsupported kind.
    pub fn of_bytes(bytes: &[u8], path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        match catch_panics(|| Ok::<_, String>(Self::decode(bytes))) {
            Ok(Ok(file)) => Ok(file),
            Ok(Err(exr::error::Error::NotSupported(what))) => {
                let message = format!("OpenEXR images of this kind are not supported: {what}");
                Err(Error::Decode { path: path.to_owned(), message })
            }
            Ok(Err(error)) => Err(decode_error(path, &error.to_string())),
            Err(reason) => Err(decode_error(path, &reason)),
        }
    }

    fn decode(bytes: &[u8]) -> exr::error::Result<Self> {
        let headers = MetaData::read_from_buffered(Cursor::new(bytes), false)?.headers;
        if let Some(reason) = why_unread(&headers) {
            return Err(exr::error::Error::NotSupported(reason.into()));
        }
        let invalid = |reason: String| exr::error::Error::Invalid(reason.into());
        let mut all = 0u64;
        for header in &headers {
            let [width, height] = [header.layer_size.width(), header.layer_size.height()];
            all = all
                .saturating_add((width as u64 * height as u64).saturating_mul(header.channels.bytes_per_pixel as u64));
            fits(width, height, all, bytes).map_err(invalid)?;
        }
        check_claimed_sizes(bytes)?;
        let reader = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
        let image = reader.non_parallel().from_buffered(Cursor::new(bytes))?;
        let values = image.layer_data.into_iter().map(|layer| {
            let channels = layer.channel_data.list.into_iter();
            channels.map(|channel| channel.sample_data).collect()
        });
        Ok(Self::from_headers(&headers, values, bytes.len()))
    }

    /// Reads the headers of a file of an unsupported kind, and returns them with the reason why its pixels are not
    /// read. The channels have no values. Returns none for a supported file.
    ///
    /// # Errors
    /// The errors of [`read`](Self::read).
    pub fn outline(path: impl AsRef<Path>) -> Result<Option<(Self, String)>> {
        let path = path.as_ref();
        let bytes = bytes(path)?;
        let described = catch_panics(|| MetaData::read_from_buffered(Cursor::new(&bytes), false));
        let headers = described.map_err(|reason| decode_error(path, &reason))?.headers;
        let Some(why) = why_unread(&headers) else { return Ok(None) };
        let no_samples = |channel: &ChannelDescription| match channel.sample_type {
            SampleType::F16 => FlatSamples::F16(Vec::new()),
            SampleType::F32 => FlatSamples::F32(Vec::new()),
            SampleType::U32 => FlatSamples::U32(Vec::new()),
        };
        let values = headers.iter().map(|header| header.channels.list.iter().map(no_samples).collect());
        Ok(Some((Self::from_headers(&headers, values, bytes.len()), why)))
    }

    /// Assembles a file from the headers of its parts and the values of all their channels.
    fn from_headers(headers: &[Header], values: impl Iterator<Item = Vec<FlatSamples>>, length: usize) -> Self {
        let (shared, mut used_names) = (&headers[0].shared_attributes, BTreeSet::new());
        let parts = headers.iter().zip(values).map(|(header, values)| {
            let own = &header.own_attributes;
            let name = own.layer_name.as_ref().map(text);
            Part {
                bounds: PixelBounds::new(own.layer_position, header.layer_size),
                storage: storage(header),
                attributes: attributes(own, &shared.other),
                camera: own.world_to_camera,
                channels: channels(header, values, name.as_deref(), &mut used_names),
                name,
            }
        });
        Self {
            parts: parts.collect(),
            length,
            display: PixelBounds::new(shared.display_window.position, shared.display_window.size),
            pixel_aspect: shared.pixel_aspect,
            chromaticities: shared.chromaticities.map(primaries),
        }
    }

    /// Crops the file to some of its pixels. Keeps only the parts that have all of these.
    pub(crate) fn crop(&self, bounds: PixelBounds) -> Self {
        Self { parts: self.parts.iter().filter_map(|part| part.crop(bounds)).collect(), ..*self }
    }

    /// Lists the layers. The beauty of a part comes before its other layers.
    pub fn layers(&self) -> Vec<ExrLayer<'_>> {
        let mut layers = Vec::new();
        for part in &self.parts {
            let at_root: Vec<&Channel> = part.channels.iter().filter(|channel| channel.layer.is_empty()).collect();
            let find_beauty = |letters: [&str; 4]| {
                let is_color = |channel: &&Channel| letters.contains(&channel.name.as_str());
                let (color, alone): (Vec<&Channel>, Vec<&Channel>) =
                    at_root.iter().partition(|channel| is_color(channel));
                let beauty = ExrLayer::new(BEAUTY, part, color);
                beauty.color().is_some().then_some((beauty, alone))
            };
            let found = find_beauty(["R", "G", "B", "A"]).or_else(|| find_beauty(["r", "g", "b", "a"]));
            let (beauty, mut alone) = found.map_or((None, at_root.clone()), |(beauty, alone)| (Some(beauty), alone));
            layers.extend(beauty);
            // Alpha comes after the channels that it belongs to.
            alone.sort_by_key(|channel| channel.name == "A");
            layers.extend(alone.into_iter().map(|channel| ExrLayer::new(&channel.name, part, vec![channel])));
            let mut names: Vec<&str> = part.channels.iter().map(|channel| channel.layer.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            for name in names.into_iter().filter(|name| !name.is_empty()) {
                let members = part.channels.iter().filter(|channel| channel.layer == name);
                layers.push(ExrLayer::new(name, part, members.collect()));
            }
        }
        layers
    }

    /// Finds a layer by its name, a channel by its full name, or the spectral band around a wavelength, such as `550nm`
    /// or `S1.550nm`. A channel or band is returned as a layer of its own. Without a name, returns the beauty, or the
    /// first layer if there is none. `shown` is the file's name in messages.
    ///
    /// # Errors
    /// [`Error::Arguments`] if there is no such layer. It suggests the closest name and lists all names.
    pub fn layer(&self, requested: Option<&str>, shown: &str) -> Result<ExrLayer<'_>> {
        let mut layers = self.layers();
        if layers.is_empty() {
            return Error::refuse(format!("{shown} has no channels"), "render info lists what a file holds");
        }
        let named = |requested: &str| layers.iter().position(|layer| layer.name == requested);
        let Some(requested) = requested else {
            let first = named(BEAUTY).unwrap_or(0);
            return Ok(layers.swap_remove(first));
        };
        if let Some(index) = named(requested) {
            return Ok(layers.swap_remove(index));
        }
        for part in &self.parts {
            if let Some(channel) = part.channels.iter().find(|channel| channel.full_name() == requested) {
                return Ok(ExrLayer::new(requested, part, vec![channel]));
            }
        }
        self.band(requested).ok_or_else(|| self.no_layer(requested, shown, &[]))
    }

    /// Finds the spectral band that contains a wavelength such as `550nm`, in the named spectrum or else the first one.
    fn band(&self, requested: &str) -> Option<ExrLayer<'_>> {
        let requested = requested.strip_suffix("nm")?.trim().replace(',', ".");
        let (spectrum, nm) = match requested.parse::<f64>() {
            Ok(nm) => (None, nm),
            Err(_) => requested.split_once('.').and_then(|(name, nm)| Some((Some(name), nm.parse().ok()?)))?,
        };
        let is_named = |layer: &ExrLayer| spectrum.is_none_or(|name| name == layer.name);
        let mut spectra = self.layers().into_iter().filter_map(|layer| Some((layer.bands_nm()?, layer)));
        let (centers, layer) = spectra.find(|(_, layer)| is_named(layer))?;
        let distance = |center: f64| (center - nm).abs();
        let index = (0..centers.len()).min_by(|&a, &b| distance(centers[a]).total_cmp(&distance(centers[b])))?;
        let others = centers.iter().filter(|&&other| other != centers[index]);
        let step = others.map(|other| (other - centers[index]).abs()).fold(f64::INFINITY, f64::min);
        let band = layer.channels[index];
        (2.0 * distance(centers[index]) <= step).then(|| ExrLayer::new(&band.full_name(), layer.part, vec![band]))
    }

    /// Returns the error for a missing layer. It suggests the closest name and lists all layers, and `others` that may
    /// be named as well, such as mattes.
    pub fn no_layer(&self, requested: &str, shown: &str, others: &[&str]) -> Error {
        let layers = self.layers();
        let names: Vec<&str> = layers.iter().map(|layer| layer.name.as_str()).chain(others.iter().copied()).collect();
        let translated = own_layer_name(requested).filter(|here| names.contains(here));
        let near = translated.or_else(|| nearest(requested, names.iter().copied()));
        let near = near.map(|near| format!("did you mean {near}? "));
        let help = near.unwrap_or_default() + "it has " + &names.join(", ");
        Error::Arguments { message: format!("{shown} has no layer {requested}"), help: Some(help) }
    }

    /// Returns the value of an attribute in the first part that has it.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        let all = self.parts.iter().flat_map(|part| &part.attributes);
        all.into_iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

/// Returns the name used here for a layer that other renderers call `name`.
fn own_layer_name(name: &str) -> Option<&'static str> {
    match name.to_lowercase().as_str() {
        "depth" => Some("Z"),
        "normal" | "normals" => Some("N"),
        "position" | "positions" => Some("P"),
        "rgb" | "rgba" | "color" | "image" => Some("beauty"),
        _ => None,
    }
}

/// Reads the bytes of a file, if it begins like an OpenEXR file.
fn bytes(path: &Path) -> Result<Vec<u8>> {
    let (shown, an_image) = (path.display(), "an image is an OpenEXR file, such as prism.exr");
    let mut start = Vec::new();
    let read = File::open(path).and_then(|mut file| {
        (&mut file).take(MAGIC.len() as u64).read_to_end(&mut start)?;
        if start == MAGIC {
            file.take(MAX_BYTES - MAGIC.len() as u64 + 1).read_to_end(&mut start)?;
        }
        Ok(())
    });
    match read.map_err(|error| (error.kind(), error)) {
        Ok(()) if start.len() as u64 > MAX_BYTES => {
            let message = "it is larger than 4 GiB, the most that can be read".into();
            Err(Error::Decode { path: path.to_owned(), message })
        }
        Ok(()) if start.starts_with(&MAGIC) => Ok(start),
        Ok(()) if has_extension(path, &["toml"]) => {
            let help = format!("render {shown} makes the image, and render --plan {shown} says how");
            Error::refuse(format!("{shown} is a scene, not an image"), help)
        }
        Ok(()) => match OTHER_FORMATS.iter().find(|(signature, _)| start.starts_with(signature)) {
            Some((_, kind)) => {
                let help = format!("{an_image}; --exr writes one beside the picture");
                Error::refuse(format!("{shown} is a {kind}, not an OpenEXR image"), help)
            }
            None => Err(decode_error(path, "it does not begin like one")),
        },
        Err((ErrorKind::NotFound | ErrorKind::NotADirectory, _)) => {
            let near = nearest_file(path, &["exr"]).map(|near| format!("did you mean {}?", near.display()));
            Error::refuse(format!("there is no image file {shown}"), near.unwrap_or(an_image.into()))
        }
        Err((ErrorKind::IsADirectory, _)) => Error::refuse(format!("{shown} is a folder, not an image"), an_image),
        Err((_, source)) => Err(cannot_read(path, source)),
    }
}

fn decode_error(path: &Path, reason: &str) -> Error {
    Error::Decode { path: path.to_owned(), message: format!("it is not a complete OpenEXR image ({reason})") }
}

/// Returns why the pixels of a file are not read, if that is so.
fn why_unread(headers: &[Header]) -> Option<String> {
    let part_reason = |header: &Header| match header {
        Header { deep: true, .. } => Some("a deep image, which has many values per pixel".into()),
        Header { channels, .. } if channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) => {
            Some("channel subsampling, by which several pixels share a value".into())
        }
        Header { layer_size, .. } => too_large(layer_size.width(), layer_size.height(), MAX_PIXELS),
    };
    headers.iter().find_map(part_reason)
}

/// Returns the channels of a part. If an earlier part has a channel of the same name, prefixes the part's name.
fn channels(
    header: &Header,
    values: Vec<FlatSamples>,
    part: Option<&str>,
    used_names: &mut BTreeSet<String>,
) -> Vec<Channel> {
    let channel = |(described, samples): (&ChannelDescription, FlatSamples)| {
        let full = text(&described.name);
        let (layer, name) = full.rsplit_once('.').unwrap_or(("", &full));
        let sampling = [described.sampling.x(), described.sampling.y()];
        Channel { layer: layer.to_owned(), name: name.to_owned(), sampling, samples }
    };
    let mut channels: Vec<Channel> = header.channels.list.iter().zip(values).map(channel).collect();
    if let Some(part) = part.filter(|_| channels.iter().any(|channel| used_names.contains(&channel.full_name()))) {
        for channel in &mut channels {
            channel.layer =
                if channel.layer.is_empty() { part.to_owned() } else { format!("{part}.{}", channel.layer) };
        }
    }
    used_names.extend(channels.iter().map(Channel::full_name));
    channels
}

fn storage(header: &Header) -> String {
    let packed = match header.compression {
        Compression::Uncompressed => "not compressed",
        Compression::RLE => "rle",
        Compression::ZIP1 => "zips",
        Compression::ZIP16 => "zip",
        Compression::PIZ => "piz",
        Compression::PXR24 => "pxr24",
        Compression::B44 => "b44",
        Compression::B44A => "b44a",
        Compression::DWAA(_) => "dwaa",
        Compression::DWAB(_) => "dwab",
        Compression::HTJ2K32 => "htj2k32",
        Compression::HTJ2K256 => "htj2k256",
    };
    let blocks = match header.blocks {
        BlockDescription::ScanLines => "scan lines".to_owned(),
        BlockDescription::Tiles(TileDescription { tile_size: size, .. }) => {
            format!("tiles of {} x {}", size.width(), size.height())
        }
    };
    let order = match header.line_order {
        LineOrder::Increasing => "from the top",
        LineOrder::Decreasing => "from the bottom",
        LineOrder::Unspecified => "in any order",
    };
    format!("{packed}, {blocks} {order}")
}
