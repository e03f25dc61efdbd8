//! Channels of an OpenEXR file that belong together.

use super::exr_part::{Channel, Part};

/// What red, green and blue at the root of a file are called here.
pub const BEAUTY: &str = "beauty";

/// Channels of one part that belong together.
#[derive(Clone, Debug)]
pub struct ExrLayer<'f> {
    /// Its name: what stands before the dot in those of its channels, [`BEAUTY`] for red, green and blue without one,
    /// or the whole name of a channel that stands alone.
    pub name: String,
    /// The part in which it is.
    pub part: &'f Part,
    /// Red, green, blue and alpha, or x, y and z, in this order; others as in the file.
    pub channels: Vec<&'f Channel>,
}

/// The center in nm of the band of a spectrum that a channel holds, as the name `S0.380,000000nm` has it (Fichet,
/// Pacanowski & Wilkie 2021).
fn center_nm(channel: &Channel) -> Option<f64> {
    channel.name.strip_suffix("nm")?.replace(',', ".").parse().ok()
}

impl<'f> ExrLayer<'f> {
    pub(super) fn new(name: &str, part: &'f Part, mut channels: Vec<&'f Channel>) -> Self {
        channels.sort_by_key(|channel| place(&channel.name));
        Self { name: name.to_owned(), part, channels }
    }

    /// The centers of its bands in nm, in the order of its channels, if they are those of a spectrum.
    pub fn bands_nm(&self) -> Option<Vec<f64>> {
        self.channels.iter().map(|channel| center_nm(channel)).collect()
    }

    /// Red, green and blue, if the layer has them.
    pub fn color(&self) -> Option<[&'f Channel; 3]> {
        let [red, green, blue] = ["r", "g", "b"].map(|name| self.channel(name));
        Some([red?, green?, blue?])
    }

    /// The channel of a name, in small or capital letters.
    pub(crate) fn channel(&self, name: &str) -> Option<&'f Channel> {
        self.channels.iter().find(|channel| channel.name.eq_ignore_ascii_case(name)).copied()
    }

    /// The channels that carry what the layer is: red, green and blue without alpha, or else all.
    pub fn values(&self) -> Vec<&'f Channel> {
        self.color().map_or_else(|| self.channels.clone(), |color| color.to_vec())
    }
}

/// Where a channel stands among those of its layer.
fn place(name: &str) -> usize {
    let known = ["r", "g", "b", "a", "x", "y", "z", "u", "v"];
    known.iter().position(|known| *known == name.to_lowercase()).unwrap_or(known.len())
}
