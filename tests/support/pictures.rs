//! Picture files of every kind that the renderer reads, written by tests, and PNGs that the program wrote.

use std::fs;
use std::path::Path;

use png::{BitDepth, ColorType};

/// The format of a PNG's numbers.
#[derive(Clone, Copy)]
pub struct Kind {
    pub color: ColorType,
    pub depth: BitDepth,
}

const fn kind(color: ColorType, depth: BitDepth) -> Kind {
    Kind { color, depth }
}

pub const L8: Kind = kind(ColorType::Grayscale, BitDepth::Eight);
pub const L16: Kind = kind(ColorType::Grayscale, BitDepth::Sixteen);
pub const LA8: Kind = kind(ColorType::GrayscaleAlpha, BitDepth::Eight);
pub const LA16: Kind = kind(ColorType::GrayscaleAlpha, BitDepth::Sixteen);
pub const RGB8: Kind = kind(ColorType::Rgb, BitDepth::Eight);
pub const RGB16: Kind = kind(ColorType::Rgb, BitDepth::Sixteen);
pub const RGBA8: Kind = kind(ColorType::Rgba, BitDepth::Eight);
pub const RGBA16: Kind = kind(ColorType::Rgba, BitDepth::Sixteen);

impl Kind {
    /// Bytes per texel.
    pub fn bytes(self) -> usize {
        self.color.samples() * self.depth as usize / 8
    }
}

/// Encodes a PNG. 16-bit numbers are big-endian.
pub fn png(width: u32, kind: Kind, numbers: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let height = numbers.len() / (kind.bytes() * width as usize);
    let mut encoder = png::Encoder::new(&mut file, width, height as u32);
    encoder.set_color(kind.color);
    encoder.set_depth(kind.depth);
    let mut writer = encoder.write_header().expect("a size");
    writer.write_image_data(numbers).expect("its numbers");
    writer.finish().expect("an end");
    file
}

pub fn write_png(folder: &Path, name: &str, width: u32, kind: Kind, numbers: &[u8]) {
    fs::write(folder.join(name), png(width, kind, numbers)).expect("the folder can be written");
}

/// A picture of 8-bit red, green and blue.
pub struct Picture {
    pub width: usize,
    pub pixels: Vec<[u8; 3]>,
}

/// Reads a PNG of 8-bit red, green and blue.
pub fn read_png(path: &Path) -> Picture {
    let file = std::io::BufReader::new(fs::File::open(path).expect("there is a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut bytes).expect("a whole picture");
    assert_eq!((info.color_type, info.bit_depth), (ColorType::Rgb, BitDepth::Eight));
    Picture { width: info.width as usize, pixels: bytes.as_chunks().0.to_vec() }
}

/// Encodes a Radiance picture, rows from the top, rounded down to 8 bits. Rows are run-length encoded where the format
/// allows it.
pub fn radiance(width: usize, texels: &[[f32; 3]]) -> Vec<u8> {
    let rgbe = |rgb: &[f32; 3]| {
        let (_, exponent) = libm::frexpf(rgb.iter().copied().fold(0.0, f32::max));
        let [r, g, b] = rgb.map(|x| libm::ldexpf(x, 8 - exponent) as u8);
        [r, g, b, (exponent + 128) as u8]
    };
    let mut file =
        format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {width}\n", texels.len() / width).into_bytes();
    for row in texels.chunks(width) {
        let row: Vec<[u8; 4]> = row.iter().map(rgbe).collect();
        if !(8..1 << 15).contains(&width) {
            file.extend(row.as_flattened());
            continue;
        }
        file.extend([2, 2, (width >> 8) as u8, width as u8]);
        for channel in 0..4 {
            let bytes: Vec<u8> = row.iter().map(|texel| texel[channel]).collect();
            for equal in bytes.chunk_by(|a, b| a == b).flat_map(|equal| equal.chunks(127)) {
                match equal {
                    [byte, _, _, ..] => file.extend([128 + equal.len() as u8, *byte]),
                    few => file.extend([&[few.len() as u8], few].concat()),
                }
            }
        }
    }
    file
}

/// Encodes a JPEG with 1 or 3 numbers per texel, depending on the length of `numbers`.
pub fn jpeg(size: [u16; 2], quality: u8, progressive: bool, numbers: &[u8]) -> Vec<u8> {
    let [width, height] = size;
    let color = match numbers.len() / (usize::from(width) * usize::from(height)) {
        1 => jpeg_encoder::ColorType::Luma,
        _ => jpeg_encoder::ColorType::Rgb,
    };
    let mut file = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut file, quality);
    encoder.set_progressive(progressive);
    encoder.encode(numbers, width, height, color).expect("a picture");
    file
}
