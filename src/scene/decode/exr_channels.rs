//! Which channels of an OpenEXR file make an image.

use exr::meta::header::Header;

use super::texels::Unreadable;
use crate::film::exr_text;

/// Names of red, green, blue and alpha within a layer.
const LETTERS: [[&str; 4]; 2] = [["R", "G", "B", "A"], ["r", "g", "b", "a"]];
/// Maximum number of channel names in a message.
const MAX_NAMES: usize = 12;

/// The channels that are read.
pub(super) struct ChosenChannels {
    /// The part of the file that contains them.
    pub(super) part: usize,
    /// For each number of a texel, the index of its channel in the part; none for an alpha that is 1 everywhere.
    pub(super) numbers: Vec<Option<usize>>,
}

impl ChosenChannels {
    /// Chooses red, green and blue, or a gray, followed by alpha if requested.
    ///
    /// Colors without a layer are preferred, then those of the first layer that has them. If there are no colors
    /// anywhere, the luminance Y is used as a gray, or else the only channel.
    ///
    /// # Errors
    /// If there is neither a color nor a gray.
    pub(super) fn of(headers: &[Header], alpha: bool) -> Result<Self, Unreadable> {
        let flat = headers.iter().enumerate().filter(|(_, header)| !header.deep);
        let parts: Vec<FlatPart> = flat.map(|(number, header)| FlatPart::of(number, header)).collect();
        if parts.is_empty() {
            return Err(Unreadable::Deep);
        }
        let names = || parts.iter().flat_map(|part| &part.names);
        let at_root = parts.iter().map(|part| (part, ""));
        let layers = parts.iter().flat_map(|part| part.layers_with_red().map(move |layer| (part, layer)));
        let (part, channels) = (at_root.chain(layers))
            .find_map(|(part, layer)| Some((part, part.colors(layer)?)))
            .or_else(|| parts.iter().find_map(|part| Some((part, part.luminance()?))))
            .or_else(|| only(names().filter(|name| !is_alpha(name))).and_then(|name| gray(&parts, name)))
            .or_else(|| only(names()).and_then(|name| gray(&parts, name)))
            .ok_or_else(|| Unreadable::Channels(list_names(names())))?;
        let (colors, own_alpha) = (channels.colors, channels.alpha);
        // A lone alpha is the gray itself.
        let alpha_alone = own_alpha.is_some_and(|alpha| colors == [alpha]);
        let behind = (alpha && !alpha_alone).then_some(own_alpha);
        let numbers: Vec<_> = colors.into_iter().map(Some).chain(behind).collect();
        Ok(Self { part: part.number, numbers })
    }

    /// Returns the number of channels of a texel.
    pub(super) fn channels(&self) -> usize {
        self.numbers.len()
    }
}

/// A part with one number per pixel in each channel.
struct FlatPart {
    number: usize,
    /// The names of its channels, in their order.
    names: Vec<String>,
}

/// Indices of channels in a part.
struct Channels {
    colors: Vec<usize>,
    alpha: Option<usize>,
}

impl FlatPart {
    fn of(number: usize, header: &Header) -> Self {
        Self { number, names: header.channels.list.iter().map(|channel| exr_text(&channel.name)).collect() }
    }

    fn find(&self, layer: &str, letter: &str) -> Option<usize> {
        self.names.iter().position(|name| layer_of(name) == layer && letter_of(name) == letter)
    }

    fn layers_with_red(&self) -> impl Iterator<Item = &str> {
        self.names.iter().filter(|name| matches!(letter_of(name), "R" | "r")).map(|name| layer_of(name))
    }

    fn colors(&self, layer: &str) -> Option<Channels> {
        LETTERS.into_iter().find_map(|[r, g, b, a]| {
            let [red, green, blue] = [r, g, b].map(|letter| self.find(layer, letter));
            Some(Channels { colors: vec![red?, green?, blue?], alpha: self.find(layer, a) })
        })
    }

    /// Returns Y, if it is not a coordinate and no chroma belongs to it.
    fn luminance(&self) -> Option<Channels> {
        let is_another = ["X", "RY", "BY"].iter().any(|letters| self.find("", letters).is_some());
        let luminance = self.find("", "Y").filter(|_| !is_another)?;
        Some(Channels { colors: vec![luminance], alpha: self.find("", "A") })
    }
}

/// Returns the channel of a name as a gray, with the alpha of its layer.
fn gray<'p>(parts: &'p [FlatPart], name: &String) -> Option<(&'p FlatPart, Channels)> {
    let part = parts.iter().find(|part| part.names.contains(name))?;
    let alpha = ["A", "a"].into_iter().find_map(|letter| part.find(layer_of(name), letter));
    let color = part.find(layer_of(name), letter_of(name))?;
    Some((part, Channels { colors: vec![color], alpha }))
}

fn only<'n>(mut names: impl Iterator<Item = &'n String>) -> Option<&'n String> {
    names.next().filter(|_| names.next().is_none())
}

fn layer_of(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(layer, _)| layer)
}

fn letter_of(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, letter)| letter)
}

fn is_alpha(name: &str) -> bool {
    matches!(letter_of(name), "A" | "a")
}

/// Lists names as `N.X, N.Y, N.Z`.
fn list_names<'n>(names: impl Iterator<Item = &'n String>) -> String {
    let mut names: Vec<&str> = names.map(String::as_str).collect();
    if names.len() > MAX_NAMES {
        names.truncate(MAX_NAMES);
        names.push("..");
    }
    names.join(", ")
}
