//! Small OpenEXR files of every kind.

use std::io::Cursor;
use std::path::Path;

use exr::meta::attribute::Chromaticities;
use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Compression, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds,
    Layer, LayerAttributes, Layers, Text, Vec2, WritableImage, f16,
};

/// Names of channels, with their values.
type Channels = Vec<(&'static str, Vec<f32>)>;

/// A file to be written.
#[derive(Clone)]
pub struct Exr {
    pub size: [usize; 2],
    pub corner: [i32; 2],
    /// Corner of the parts after the first one.
    pub later_corner: [i32; 2],
    pub full: [usize; 2],
    pub half: bool,
    pub compression: Compression,
    pub chromaticities: Option<Chromaticities>,
    pub texts: Vec<(&'static str, String)>,
    /// Name of each part, with its channels.
    pub parts: Vec<(&'static str, Channels)>,
}

impl Exr {
    /// Creates a file with one part of 32-bit floats.
    pub fn new(size: [usize; 2], channels: Channels) -> Self {
        let (texts, parts) = (Vec::new(), vec![("", channels)]);
        Self {
            size,
            corner: [0, 0],
            later_corner: [0, 0],
            full: size,
            half: false,
            compression: Compression::Uncompressed,
            chromaticities: None,
            texts,
            parts,
        }
    }

    /// Returns the values of a channel.
    pub fn channel(&mut self, name: &str) -> &mut Vec<f32> {
        let mut channels = self.parts.iter_mut().flat_map(|(_, channels)| channels);
        &mut channels.find(|(own, _)| *own == name).expect("there is such a channel").1
    }

    pub fn write(&self, path: &Path) {
        std::fs::write(path, self.bytes()).expect("an image can be written");
    }

    /// Encodes the file.
    pub fn bytes(&self) -> Vec<u8> {
        let layers = self.parts.iter().enumerate().map(|(number, (name, channels))| {
            let list = channels.iter().map(|(name, values)| AnyChannel {
                name: Text::from(*name),
                sample_data: if self.half {
                    FlatSamples::F16(values.iter().map(|x| f16::from_f32(*x)).collect())
                } else {
                    FlatSamples::F32(values.clone())
                },
                quantize_linearly: false,
                sampling: Vec2(1, 1),
            });
            let corner = if number == 0 { self.corner } else { self.later_corner };
            let mut attributes = LayerAttributes {
                layer_name: (!name.is_empty()).then(|| Text::from(*name)),
                layer_position: Vec2(corner[0], corner[1]),
                ..LayerAttributes::default()
            };
            for (key, value) in &self.texts {
                let value = AttributeValue::Text(Text::from_slice_unchecked(value.as_bytes()));
                attributes.other.insert(Text::from(*key), value);
            }
            let size = Vec2(self.size[0], self.size[1]);
            let encoding = Encoding { compression: self.compression, ..Encoding::UNCOMPRESSED };
            Layer::new(size, attributes, encoding, AnyChannels::sort(list.collect()))
        });
        let display = IntegerBounds::from_dimensions((self.full[0], self.full[1]));
        let mut image = Image::from_layers(ImageAttributes::new(display), layers.collect::<Layers<_>>());
        image.attributes.chromaticities = self.chromaticities;
        let mut bytes = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut bytes).expect("an image can be written");
        bytes.into_inner()
    }
}

/// Returns a gray ramp of 4 x 2 pixels from 0 to 0.7.
pub fn ramp() -> Exr {
    let values: Vec<f32> = (0..8).map(|i| i as f32 / 10.0).collect();
    Exr::new([4, 2], ["R", "G", "B"].map(|name| (name, values.clone())).to_vec())
}
