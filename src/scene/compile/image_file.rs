//! Image files that light or color a scene.

use std::path::Path;

use super::image_numbers::{Meaning, Texels};
use crate::film::catch_panics;
use crate::scene::decode::{
    FloatImage, IntegerImage, IntegerTexels, Unreadable, decode_exr, decode_jpeg, decode_png, decode_radiance,
};
use crate::scene::text::Fault;
use crate::spectrum::{Channel, IDENTITY, Image, Matrix, decode_srgb};

/// Reads an OpenEXR or Radiance file from its bytes. The extension of its name says which it is.
///
/// # Errors
/// What is wrong with it, and what to do.
pub(super) fn read_image(path: &Path, bytes: &[u8]) -> Result<ImageFile, Fault> {
    let light = TextureReader { path, meaning: Meaning::Light(None), channel: None, srgb: false };
    match extension(path).as_str() {
        "exr" | "hdr" => light.of_floats(floats(path, bytes, false)?),
        extension @ ("png" | "jpg" | "jpeg") => {
            let help = "use an OpenEXR (.exr) or Radiance (.hdr) image";
            Err(Fault::new(format!("a .{extension} image holds no light brighter than white"), help))
        }
        _ => Err(unknown_kind(path, "images end in .exr (OpenEXR) or .hdr (Radiance)")),
    }
}

/// An image, and the warnings about its file.
pub(super) struct ImageFile {
    pub(super) image: Image,
    pub(super) warnings: Vec<String>,
}

/// Reads a PNG, JPEG, OpenEXR or Radiance file from its bytes. The extension of its name says which it is.
///
/// # Errors
/// What is wrong with it, and what to do.
pub(super) fn read_texture(
    path: &Path,
    bytes: &[u8],
    meaning: Meaning,
    channel: Option<Channel>,
) -> Result<ImageFile, Fault> {
    let whole = match extension(path).as_str() {
        "exr" | "hdr" => None,
        "png" => Some(decode_with(path, "PNG", bytes, decode_png)?),
        "jpg" | "jpeg" => Some(decode_with(path, "JPEG", bytes, decode_jpeg)?),
        _ => return Err(unknown_kind(path, "images end in .png, .jpg, .exr (OpenEXR) or .hdr (Radiance)")),
    };
    let srgb = channel != Some(Channel::Alpha) && meaning.is_srgb(whole.is_some());
    let texture = TextureReader { path, meaning, channel, srgb };
    match whole {
        Some(whole) => texture.of_whole_numbers(whole),
        None => texture.of_floats(floats(path, bytes, true)?),
    }
}

/// Decodes an OpenEXR or Radiance file, and the alpha of the former if requested.
fn floats(path: &Path, bytes: &[u8], alpha: bool) -> Result<FloatImage, Fault> {
    match extension(path).as_str() {
        "exr" => decode_with(path, "OpenEXR", bytes, |bytes| decode_exr(bytes, alpha)),
        _ => decode_with(path, "Radiance", bytes, decode_radiance),
    }
}

/// The image to read, and what to read it as.
struct TextureReader<'p> {
    path: &'p Path,
    meaning: Meaning,
    channel: Option<Channel>,
    srgb: bool,
}

impl TextureReader<'_> {
    /// Chooses the numbers of texels that are read.
    fn select_channels(&self, channels: usize, has_alpha: bool) -> Result<ChannelSelection, Fault> {
        let selection = ChannelSelection::new(self.path, self.channel, channels, has_alpha)?;
        if self.meaning == Meaning::Directions && selection.channels() == 1 {
            let message = format!("{} is gray, but a normal map has red, green and blue", self.path.display());
            return Err(Fault::new(message, "for heights use `bump_map`"));
        }
        Ok(selection)
    }

    /// Adds the warnings that apply to an image: that alpha is ignored, and that the file says that its colors are not
    /// sRGB.
    fn with_warnings(&self, image: Image, ignores_alpha: bool, not_srgb: Option<&str>) -> ImageFile {
        let file = self.path.display();
        let alpha = ignores_alpha.then(|| format!("the alpha of {file} is ignored; channel = \"alpha\" reads it"));
        let colors = not_srgb.filter(|_| self.srgb).map(|detail| {
            format!("the colors of {file} have {detail}, which is ignored: they are read as sRGB; save them as sRGB")
        });
        ImageFile { image, warnings: alpha.into_iter().chain(colors).collect() }
    }

    fn of_whole_numbers(self, whole: IntegerImage) -> Result<ImageFile, Fault> {
        let (srgb, directions) = (self.srgb, self.meaning == Meaning::Directions);
        let (width, not_srgb) = (whole.width, whole.not_srgb.as_deref());
        let selection = self.select_channels(whole.channels, whole.has_alpha())?;
        let mut file = match whole.steps {
            IntegerTexels::Words(numbers) => {
                let even = |word: u16| f64::from(word) / 65535.0;
                let value = |word: u16| match directions {
                    true => (f64::from(word) - 32768.0) / 32767.0,
                    false if srgb => decode_srgb(even(word)),
                    false => even(word),
                };
                let table: Vec<f32> = (0..=u16::MAX).map(|word| value(word) as f32).collect();
                let ignores_alpha = !directions && selection.ignores(&numbers, u16::MAX);
                let floats = selection.select(&numbers).map(|word| table[usize::from(word)]).collect();
                self.with_warnings(Image::of_floats(width, selection.channels(), floats), ignores_alpha, not_srgb)
            }
            IntegerTexels::Bytes(numbers) => {
                let ignores_alpha = !directions && selection.ignores(&numbers, u8::MAX);
                let (channels, bytes) = (selection.channels(), selection.select(&numbers).collect());
                let image = match directions {
                    true => Image::of_signed_bytes(width, channels, bytes),
                    false => Image::of_bytes(width, channels, bytes, srgb),
                };
                self.with_warnings(image, ignores_alpha, not_srgb)
            }
        };
        let rotated_warning =
            |file| format!("the EXIF orientation of {file} is ignored: save it upright if it looks rotated");
        file.warnings.extend(whole.is_rotated.then(|| rotated_warning(self.path.display())));
        Ok(file)
    }

    fn of_floats(self, image: FloatImage) -> Result<ImageFile, Fault> {
        let directions = self.meaning == Meaning::Directions;
        let selection = self.select_channels(image.channels, image.has_alpha)?;
        let ignores_alpha = !directions && selection.ignores(&image.numbers, 1.0);
        let (width, channels) = (image.width, selection.channels());
        let numbers = if selection.is_all() { image.numbers } else { selection.select(&image.numbers).collect() };
        let mut texels = Texels { path: self.path, width, channels, numbers };
        texels.check(self.meaning, image.is_lossy)?;
        if directions {
            texels.numbers.iter_mut().for_each(|x| *x = 2.0 * *x - 1.0);
        }
        if self.srgb {
            texels.decode_srgb();
        }
        let is_light = matches!(self.meaning, Meaning::Light(_));
        let conversion_warning = if is_light { rec709(&mut texels, &image.to_rec709) } else { None };
        let mut file = self.with_warnings(Image::of_floats(width, channels, texels.numbers), ignores_alpha, None);
        file.warnings.extend(conversion_warning);
        Ok(file)
    }
}

/// Converts an image with colors to linear Rec.709. Returns a warning about the conversion, if there is one.
fn rec709(texels: &mut Texels, to_rec709: &Result<Matrix, String>) -> Option<String> {
    match to_rec709 {
        _ if texels.channels == 1 => None,
        Ok(matrix) if *matrix == IDENTITY => None,
        Ok(matrix) => texels.convert(matrix),
        Err(detail) => Some(format!("{}: {detail}: it is read as linear Rec.709", texels.path.display())),
    }
}

/// The numbers of a texel that are read.
struct ChannelSelection {
    /// Numbers per texel in the file.
    stride: usize,
    first: usize,
    last: usize,
    alpha: Option<usize>,
}

impl ChannelSelection {
    /// Chooses from texels of 1 to 4 numbers: a gray or 3 colors, optionally followed by alpha, or alpha alone.
    fn new(path: &Path, channel: Option<Channel>, stride: usize, has_alpha: bool) -> Result<Self, Fault> {
        let colors = stride - usize::from(has_alpha);
        let last = colors.max(1) - 1;
        let one = |at: usize| (at.min(last), at.min(last));
        let (first, last) = match channel {
            None => (0, last),
            Some(Channel::Red) => one(0),
            Some(Channel::Green) => one(1),
            Some(Channel::Blue) => one(2),
            Some(Channel::Alpha) if has_alpha => (colors, colors),
            Some(Channel::Alpha) => {
                let message = format!("{} has no alpha", path.display());
                return Err(Fault::new(message, "leave `channel` out, or save the image with alpha"));
            }
        };
        let alpha = (has_alpha && channel.is_none() && colors > 0).then_some(colors);
        Ok(Self { stride, first, last, alpha })
    }

    fn channels(&self) -> usize {
        self.last - self.first + 1
    }

    fn is_all(&self) -> bool {
        self.channels() == self.stride
    }

    fn select<'a, T: Copy>(&'a self, numbers: &'a [T]) -> impl Iterator<Item = T> + 'a {
        numbers.chunks_exact(self.stride).flat_map(|texel| texel[self.first..=self.last].iter().copied())
    }

    /// Returns whether an alpha that is not read is below `full`.
    fn ignores<T: Copy + PartialOrd>(&self, numbers: &[T], full: T) -> bool {
        self.alpha.is_some_and(|alpha| numbers.chunks_exact(self.stride).any(|texel| texel[alpha] < full))
    }
}

fn extension(path: &Path) -> String {
    path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The first bytes of files, whatever their names: these bytes, the kind of image, and its extension. The last kinds,
/// which have none, are not read.
const BEGINNINGS: [(&[u8], &str, &str); 9] = [
    (b"\x89PNG", "PNG", "png"),
    (b"\xff\xd8\xff", "JPEG", "jpg"),
    (b"\x76\x2f\x31\x01", "OpenEXR", "exr"),
    (b"#?RADIANCE", "Radiance", "hdr"),
    (b"#?RGBE", "Radiance", "hdr"),
    (b"II*\0", "TIFF", ""),
    (b"MM\0*", "TIFF", ""),
    (b"GIF8", "GIF", ""),
    (b"RIFF", "WebP", ""),
];

/// Returns the kind of image that a file contains, by its first bytes, and the extension that it should have if it is
/// read.
fn detect_kind(bytes: &[u8]) -> Option<(&'static str, &'static str)> {
    let (_, kind, extension) = BEGINNINGS.iter().find(|(beginning, ..)| bytes.starts_with(beginning))?;
    Some((kind, extension))
}

fn unknown_kind(path: &Path, help: &str) -> Fault {
    Fault::new(format!("cannot tell the kind of image from {:?}", path.display()), help)
}

/// Decodes a file, or returns why it cannot be read.
fn decode_with<T>(
    path: &Path,
    kind: &str,
    bytes: &[u8],
    decode: impl FnOnce(&[u8]) -> Result<T, Unreadable>,
) -> Result<T, Fault> {
    if let Some((another, extension)) = detect_kind(bytes).filter(|(another, _)| *another != kind) {
        let article = if another.starts_with('O') { "an" } else { "a" };
        let message = format!("{} is not in {kind} format: it is {article} {another} image", path.display());
        let name = Path::new(path.file_name().unwrap_or_default()).with_extension(extension);
        let help = if extension.is_empty() {
            format!("save it as {kind}")
        } else {
            format!("rename it to {}", name.display())
        };
        return Err(Fault::new(message, help));
    }
    let unreadable = |detail: &str, help: &str| {
        Fault::new(format!("{} is not a valid {kind} image ({})", path.display(), detail.trim_end_matches('.')), help)
    };
    match catch_panics(|| Ok::<_, String>(decode(bytes))) {
        Ok(Ok(read)) => Ok(read),
        Ok(Err(Unreadable::Channels(channels))) => {
            let message = format!("{} has no channels R, G and B: it has the channels {channels}", path.display());
            let has_chroma = ["RY", "BY"].iter().any(|chroma| channels.split(", ").any(|channel| channel == *chroma));
            let help = if has_chroma {
                "save it as red, green and blue"
            } else {
                "save one of them alone to use it as a gray"
            };
            Err(Fault::new(message, help))
        }
        Ok(Err(other)) => Err(match other.remedy() {
            Some(remedy) => Fault::new(format!("cannot read {}: {other}", path.display()), remedy),
            None => unreadable(&other.to_string(), "is the file complete?"),
        }),
        Err(detail) => Err(unreadable(&detail, "is the file complete?")),
    }
}
