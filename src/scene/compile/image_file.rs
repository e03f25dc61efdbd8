//! Files of images that light or color a scene.

use std::path::Path;

use crate::film::guarded;
use crate::scene::decode::{Floats, Steps, Unreadable, Whole, decode_exr, decode_jpeg, decode_png, decode_radiance};
use crate::spectrum::{Channel, Encoding, Image, decode_srgb};

/// What is wrong with a file.
pub(super) struct Fault {
    pub(super) message: String,
    /// What to do.
    pub(super) help: Option<String>,
}

impl Fault {
    fn new(message: String, help: impl Into<String>) -> Self {
        Self { message, help: Some(help.into()) }
    }
}

/// Reads an OpenEXR or Radiance file from its bytes; the ending of its name says which it is.
///
/// # Errors
/// What is wrong with it, and what to do.
pub(super) fn read_image(path: &Path, bytes: &[u8]) -> Result<Image, Fault> {
    let image = match ending(path).as_str() {
        "exr" => decoded(path, "OpenEXR", || decode_exr(bytes, false))?,
        "hdr" => decoded(path, "Radiance", || decode_radiance(bytes))?,
        ending @ ("png" | "jpg" | "jpeg") => {
            let help = "use an OpenEXR (.exr) or Radiance (.hdr) image";
            return Err(Fault::new(format!("a .{ending} image holds no light brighter than white"), help));
        }
        _ => return Err(unknown(path, "images end in .exr (OpenEXR) or .hdr (Radiance)")),
    };
    let Floats { width, channels, numbers, .. } = image;
    possible(path, Texels { width, channels, numbers: &numbers }, Meaning::Light(None))?;
    Ok(Image::of_floats(width, channels, numbers))
}

/// What the numbers of an image on a surface stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Meaning {
    /// Light or shares of it, encoded as told or else as the kind of file implies.
    Light(Option<Encoding>),
    /// Thicknesses, encoded as told.
    Thicknesses(Encoding),
    /// Heights, just as they are.
    Heights,
    /// Directions: the middle of the range of whole numbers is 0, of others one half.
    Directions,
}

/// An image for a surface.
pub(super) struct TextureFile {
    pub(super) image: Image,
    /// Whether it has transparent places of which nothing was read.
    pub(super) ignores_alpha: bool,
}

/// Reads a PNG, JPEG, OpenEXR or Radiance file from its bytes; the ending of its name says which it is.
///
/// # Errors
/// What is wrong with it, and what to do.
pub(super) fn read_texture(
    path: &Path,
    bytes: &[u8],
    meaning: Meaning,
    channel: Option<Channel>,
) -> Result<TextureFile, Fault> {
    let (kind, whole): (_, Option<Decoder>) = match ending(path).as_str() {
        "exr" => ("OpenEXR", None),
        "hdr" => ("Radiance", None),
        "png" => ("PNG", Some(decode_png)),
        "jpg" | "jpeg" => ("JPEG", Some(decode_jpeg)),
        _ => return Err(unknown(path, "images end in .png, .jpg, .exr (OpenEXR) or .hdr (Radiance)")),
    };
    let srgb = match (channel, meaning) {
        (Some(Channel::Alpha), _) => false,
        (_, Meaning::Light(encoding)) => encoding.map_or(whole.is_some(), |encoding| encoding == Encoding::Srgb),
        (_, Meaning::Thicknesses(encoding)) => encoding == Encoding::Srgb,
        _ => false,
    };
    let texture = TextureOf { path, kind, meaning, channel, srgb };
    match whole {
        Some(decode) => texture.of_whole_numbers(bytes, decode),
        None => texture.of_floats(bytes),
    }
}

/// Reads a file of whole numbers.
type Decoder = fn(&[u8]) -> Result<Whole, Unreadable>;

/// An image that is read, and as what.
struct TextureOf<'p> {
    path: &'p Path,
    kind: &'static str,
    meaning: Meaning,
    channel: Option<Channel>,
    srgb: bool,
}

impl TextureOf<'_> {
    /// Which numbers of texels are read.
    fn picked(&self, channels: usize, has_alpha: bool) -> Result<Picked, Fault> {
        let picked = Picked::new(self.path, self.channel, channels, has_alpha)?;
        if self.meaning == Meaning::Directions && picked.channels() == 1 {
            let message = format!("{} is gray, and a normal map has red, green and blue", self.path.display());
            return Err(Fault::new(message, "heights are a `bump_map`"));
        }
        Ok(picked)
    }

    fn of_whole_numbers(self, bytes: &[u8], decode: Decoder) -> Result<TextureFile, Fault> {
        let (srgb, directions) = (self.srgb, self.meaning == Meaning::Directions);
        let whole = decoded(self.path, self.kind, || decode(bytes))?;
        let width = whole.width;
        let picked = self.picked(whole.channels, whole.has_alpha())?;
        match whole.steps {
            Steps::Words(numbers) => {
                let even = |word: u16| f64::from(word) / 65535.0;
                let value = |word: u16| match directions {
                    true => (f64::from(word) - 32768.0) / 32767.0,
                    false if srgb => decode_srgb(even(word)),
                    false => even(word),
                };
                let table: Vec<f32> = (0..=u16::MAX).map(|word| value(word) as f32).collect();
                let ignores_alpha = !directions && picked.ignores(&numbers, u16::MAX);
                let floats = picked.of(&numbers).map(|word| table[usize::from(word)]).collect();
                Ok(TextureFile { image: Image::of_floats(width, picked.channels(), floats), ignores_alpha })
            }
            Steps::Bytes(numbers) => {
                let ignores_alpha = !directions && picked.ignores(&numbers, u8::MAX);
                let (channels, bytes) = (picked.channels(), picked.of(&numbers).collect());
                let image = match directions {
                    true => Image::of_signed_bytes(width, channels, bytes),
                    false => Image::of_bytes(width, channels, bytes, srgb),
                };
                Ok(TextureFile { image, ignores_alpha })
            }
        }
    }

    fn of_floats(self, bytes: &[u8]) -> Result<TextureFile, Fault> {
        let (radiance, directions) = (self.kind == "Radiance", self.meaning == Meaning::Directions);
        let read = || if radiance { decode_radiance(bytes) } else { decode_exr(bytes, true) };
        let image = decoded(self.path, self.kind, read)?;
        let picked = self.picked(image.channels, image.has_alpha)?;
        let ignores_alpha = !directions && picked.ignores(&image.numbers, 1.0);
        let mut floats: Vec<f32> = picked.of(&image.numbers).collect();
        let texels = Texels { width: image.width, channels: picked.channels(), numbers: &floats };
        possible(self.path, texels, self.meaning)?;
        if directions {
            floats.iter_mut().for_each(|x| *x = 2.0 * *x - 1.0);
        }
        if self.srgb {
            floats.iter_mut().for_each(|x| *x = decode_srgb(f64::from(*x)) as f32);
        }
        Ok(TextureFile { image: Image::of_floats(image.width, picked.channels(), floats), ignores_alpha })
    }
}

/// Which numbers of a texel are read.
struct Picked {
    /// Numbers of a texel in the file.
    stride: usize,
    first: usize,
    last: usize,
    alpha: Option<usize>,
}

impl Picked {
    /// Of texels of 1 to 4 numbers: a gray or 3 colors, and maybe alpha behind them, or alpha alone.
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
                return Err(Fault { message: format!("{} has no alpha", path.display()), help: None });
            }
        };
        let alpha = (has_alpha && channel.is_none() && colors > 0).then_some(colors);
        Ok(Self { stride, first, last, alpha })
    }

    fn channels(&self) -> usize {
        self.last - self.first + 1
    }

    fn of<'a, T: Copy>(&'a self, numbers: &'a [T]) -> impl Iterator<Item = T> + 'a {
        numbers.chunks_exact(self.stride).flat_map(|texel| texel[self.first..=self.last].iter().copied())
    }

    /// Whether some alpha that is not read is less than `full`.
    fn ignores<T: Copy + PartialOrd>(&self, numbers: &[T], full: T) -> bool {
        self.alpha.is_some_and(|alpha| numbers.chunks_exact(self.stride).any(|texel| texel[alpha] < full))
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

fn unknown(path: &Path, help: &str) -> Fault {
    Fault::new(format!("the kind of image cannot be told from {:?}", path.display()), help)
}

/// What a decoder makes of the file.
fn decoded<T>(path: &Path, kind: &str, decode: impl FnOnce() -> Result<T, Unreadable>) -> Result<T, Fault> {
    let unreadable = |said: &str, help: &str| {
        Fault::new(format!("{} is no {kind} image ({})", path.display(), said.trim_end_matches('.')), help)
    };
    match guarded(|| Ok::<_, String>(decode())) {
        Ok(Ok(read)) => Ok(read),
        Ok(Err(Unreadable::Channels(channels))) => {
            let message = format!("{} has no channels R, G and B: it has the channels {channels}", path.display());
            Err(Fault::new(message, "save one of them alone, and it is a gray"))
        }
        Ok(Err(other)) => Err(unreadable(&other.to_string(), "is the file complete?")),
        Err(said) => Err(unreadable(&said, "is the file complete?")),
    }
}

/// The numbers of an image, rows from the top.
struct Texels<'n> {
    width: usize,
    channels: usize,
    numbers: &'n [f32],
}

/// Refuses numbers that no light and no surface has.
fn possible(path: &Path, texels: Texels, meaning: Meaning) -> Result<(), Fault> {
    let Texels { width, channels, numbers } = texels;
    let (allowed, help) = match meaning {
        Meaning::Light(_) => (0.0..=f32::MAX, "light is finite and not negative"),
        Meaning::Thicknesses(_) => (0.0..=f32::MAX, "thicknesses are finite and not negative"),
        Meaning::Heights => (f32::MIN..=f32::MAX, "heights are finite"),
        Meaning::Directions => (0.0..=1.0, "directions are written as numbers from 0 to 1, one half being none"),
    };
    let mut texels = numbers.chunks_exact(channels);
    match texels.position(|texel| texel.iter().any(|x| !allowed.contains(x))) {
        Some(at) => {
            let (x, y) = (at % width, at / width);
            let texel = &numbers[at * channels..(at + 1) * channels];
            let message = format!("{}: pixel ({x}, {y}) is {texel:?}", path.display());
            Err(Fault::new(message, help))
        }
        None => Ok(()),
    }
}
