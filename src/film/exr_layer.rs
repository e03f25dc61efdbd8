//! Layers of an OpenEXR file: channels that belong together.

use super::exr_part::{Channel, Part};

/// The name used here for red, green and blue at the root of a file.
pub const BEAUTY: &str = "beauty";

/// Channels of one part that belong together.
#[derive(Clone, Debug)]
pub struct ExrLayer<'f> {
    /// The prefix before the dot in the names of its channels, [`BEAUTY`] for red, green and blue without a prefix, or
    /// the full name of a channel that stands alone.
    pub name: String,
    /// The part that contains the layer.
    pub part: &'f Part,
    /// The channels, in the order red, green, blue, alpha, or x, y, z. Others keep the order of the file.
    pub channels: Vec<&'f Channel>,
}

/// Returns the center in nm of the spectral band that a channel holds, parsed from a name such as `S0.380,000000nm`
/// (Fichet, Pacanowski & Wilkie 2021).
fn center_nm(channel: &Channel) -> Option<f64> {
    channel.name.strip_suffix("nm")?.replace(',', ".").parse().ok()
}

impl<'f> ExrLayer<'f> {
    pub(super) fn new(name: &str, part: &'f Part, mut channels: Vec<&'f Channel>) -> Self {
        channels.sort_by_key(|channel| channel_order(&channel.name));
        Self { name: name.to_owned(), part, channels }
    }

    /// Returns the centers of the bands in nm, in the order of the channels, if these are the bands of a spectrum.
    pub fn bands_nm(&self) -> Option<Vec<f64>> {
        self.channels.iter().map(|channel| center_nm(channel)).collect()
    }

    /// Returns red, green and blue, if the layer has them.
    pub fn color(&self) -> Option<[&'f Channel; 3]> {
        let [red, green, blue] = ["r", "g", "b"].map(|name| self.channel(name));
        Some([red?, green?, blue?])
    }

    /// Finds a channel by name, in lower or upper case.
    pub(crate) fn channel(&self, name: &str) -> Option<&'f Channel> {
        self.channels.iter().find(|channel| channel.name.eq_ignore_ascii_case(name)).copied()
    }

    /// Returns the channels with the content of the layer: red, green and blue without alpha, or else all of them.
    pub fn values(&self) -> Vec<&'f Channel> {
        self.color().map_or_else(|| self.channels.clone(), |color| color.to_vec())
    }
}

/// Returns the position of a channel in the order of its layer.
fn channel_order(name: &str) -> usize {
    let order = ["r", "g", "b", "a", "x", "y", "z", "u", "v"];
    order.iter().position(|order| *order == name.to_lowercase()).unwrap_or(order.len())
}
