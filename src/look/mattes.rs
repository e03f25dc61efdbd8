use std::collections::BTreeMap;

use super::picture::Picture;
use crate::error::{Error, Result, nearest};
use crate::film::{Channel, ExrFile, ExrLayer, Part, id};

/// The maximum number of names that are listed if one is unknown.
const MAX_LISTED: usize = 20;

/// The mattes of one kind in a file, such as `CryptoObject`: the names that each pixel shows, and the coverage of each.
///
/// Cryptomatte specification 1.2.0: layers `CryptoObject00`, `CryptoObject01` .. hold pairs of a name's ID and its
/// coverage, and an attribute holds the names.
#[derive(Clone, Debug)]
pub struct Mattes<'f> {
    name: &'f str,
    /// The part that contains the mattes.
    pub(super) part: &'f Part,
    /// Pairs of channels with the ID of a name, and its coverage.
    ranks: Vec<[&'f Channel; 2]>,
    /// The names and their IDs. Empty if the file keeps them elsewhere.
    names: BTreeMap<String, u32>,
}

impl<'f> Mattes<'f> {
    /// Returns all kinds of mattes in a file.
    pub fn all(file: &'f ExrFile) -> Vec<Self> {
        let mut all: Vec<Self> = Vec::new();
        let layers = file.layers();
        for (key, name) in file.parts.iter().flat_map(|part| &part.attributes) {
            let Some(start) = key.strip_suffix("/name").filter(|start| start.starts_with("cryptomatte/")) else {
                continue;
            };
            if all.iter().any(|known| known.name == name) {
                continue;
            }
            let numbered = |number: usize| layers.iter().find(|layer| layer.name == format!("{name}{number:02}"));
            let found: Vec<&ExrLayer> = (0..).map_while(numbered).filter(|layer| layer.channels.len() == 4).collect();
            let ranks: Vec<_> = found.iter().flat_map(|layer| pairs(layer)).collect();
            if let Some(first) = found.first().filter(|first| found.iter().all(|layer| same_size(first, layer))) {
                let names = file.attribute(&format!("{start}/manifest")).map_or_else(BTreeMap::new, names);
                all.push(Self { name, part: first.part, ranks, names });
            }
        }
        all
    }

    /// Returns the name of the kind, such as `CryptoObject`.
    pub fn name(&self) -> &'f str {
        self.name
    }

    /// Returns whether a layer, such as `CryptoObject00`, holds some of these mattes.
    pub(super) fn has_layer(&self, layer: &str) -> bool {
        let number = layer.strip_prefix(self.name);
        number.is_some_and(|number| number.len() == 2 && number.bytes().all(|digit| digit.is_ascii_digit()))
    }

    /// Returns the kind of mattes that a layer of a file holds, such as `CryptoObject` for `CryptoObject00`. The values
    /// of such a layer are IDs of names, not colors.
    pub fn name_of_layer(file: &'f ExrFile, layer: &str) -> Option<&'f str> {
        Self::all(file).iter().find(|mattes| mattes.has_layer(layer)).map(Self::name)
    }

    /// Returns a picture of every name in its own color, weighted by its coverage, and black where there is nothing.
    pub fn picture(&self) -> Picture {
        let pixel = |index: usize| {
            self.ranks.iter().fold([0.0; 3], |sum: [f64; 3], [numbers, covered]| {
                let (color, covered) = (color(number(numbers, index)), coverage(covered, index));
                std::array::from_fn(|i| sum[i] + covered * color[i])
            })
        };
        Picture::of_light(self.width(), (0..self.part.bounds.pixels()).map(pixel))
    }

    /// Returns a picture of one name's coverage, black where it is absent and white where nothing else is.
    ///
    /// # Errors
    /// [`Error::Arguments`] if there is no such name, suggesting the closest one. `shown` names the file in messages.
    pub fn matte(&self, requested: &str, shown: &str) -> Result<Picture> {
        let known = match self.names.get(requested) {
            Some(number) => *number,
            None if self.names.is_empty() => id(requested),
            None => return Err(self.unknown_name(requested, shown)),
        };
        Ok(Picture::of_grays(self.width(), (0..self.part.bounds.pixels()).map(|index| self.coverage_of(known, index))))
    }

    /// Finds the requested kind of mattes, and the name of a single matte: for `CryptoObject.ball` it is `ball`.
    pub fn named<'m, 'w>(all: &'m [Self], requested: &'w str) -> Option<(&'m Self, Option<&'w str>)> {
        all.iter().find_map(|mattes| {
            let rest = requested.strip_prefix(mattes.name)?;
            (rest.is_empty() || rest.starts_with('.')).then_some((mattes, rest.get(1..)))
        })
    }

    /// Returns the coverage of a name in each pixel of two images of the same size. Without a name, uses for each pixel
    /// the name whose coverage differs most.
    ///
    /// # Errors
    /// [`Error::Arguments`] if neither image has such a name.
    pub(super) fn coverages([a, b]: [&Self; 2], one: Option<&str>, shown: [&str; 2]) -> Result<[Channel; 2]> {
        if let Some(requested) = one
            && [a, b].iter().all(|own| !own.names.is_empty() && !own.names.contains_key(requested))
        {
            return Err(a.unknown_name(requested, shown[0]));
        }
        let both = |known: u32, index: usize| [a, b].map(|own| own.coverage_of(known, index));
        let furthest = |index: usize| {
            let numbers =
                [a, b].into_iter().flat_map(|own| own.ranks.iter().map(|[numbers, _]| number(numbers, index)));
            let pairs = numbers.filter(|known| *known != 0).map(|known| both(known, index));
            let distance = |[a, b]: [f64; 2]| (a - b).abs();
            pairs.reduce(|most, next| if distance(next) > distance(most) { next } else { most }).unwrap_or_default()
        };
        let known = one.map(id);
        let pairs =
            (0..a.part.bounds.pixels()).map(|index| known.map_or_else(|| furthest(index), |known| both(known, index)));
        let (first, second) = pairs.map(|pair| pair.map(|covered| covered as f32)).map(Into::into).unzip();
        Ok([first, second].map(|values| Channel::of_values(one.unwrap_or("coverage"), values)))
    }

    /// Returns the coverage of an ID in a pixel.
    fn coverage_of(&self, known: u32, index: usize) -> f64 {
        let matching = self.ranks.iter().filter(|[numbers, _]| number(numbers, index) == known);
        matching.map(|[_, covered]| coverage(covered, index)).sum::<f64>().min(1.0)
    }

    fn width(&self) -> usize {
        self.part.bounds.size[0]
    }

    fn unknown_name(&self, requested: &str, shown: &str) -> Error {
        let names = || self.names.keys().map(String::as_str);
        let near = nearest(requested, names()).map_or(String::new(), |near| format!("did you mean {near}? "));
        let listed = names().take(MAX_LISTED).collect::<Vec<_>>().join(", ");
        let more = match self.names.len().saturating_sub(MAX_LISTED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Error::Arguments {
            message: format!("{shown} has no {requested} in {}", self.name),
            help: Some(format!("{near}it has {listed}{more}")),
        }
    }
}

/// Returns the two pairs of ID and coverage in a layer.
fn pairs<'f>(layer: &ExrLayer<'f>) -> [[&'f Channel; 2]; 2] {
    let channels = &layer.channels;
    [[channels[0], channels[1]], [channels[2], channels[3]]]
}

fn same_size(a: &ExrLayer, b: &ExrLayer) -> bool {
    a.part.bounds.size == b.part.bounds.size
}

/// Parses a manifest: a JSON object of names and IDs of eight hexadecimal digits.
fn names(manifest: &str) -> BTreeMap<String, u32> {
    let entries: BTreeMap<String, String> = serde_json::from_str(manifest).unwrap_or_default();
    let number = |(name, digits): (String, String)| Some((name, u32::from_str_radix(&digits, 16).ok()?));
    entries.into_iter().filter_map(number).collect()
}

/// Returns the ID of a name. 0 stands for nothing.
fn number(channel: &Channel, index: usize) -> u32 {
    (channel.at(index) as f32).to_bits()
}

fn coverage(channel: &Channel, index: usize) -> f64 {
    let covered = channel.at(index);
    if covered.is_nan() { 0.0 } else { covered.clamp(0.0, 1.0) }
}

/// Returns a color in linear light that hardly any other ID has. IDs are hashes of names, so their bits are as good as
/// random: the upper half is the hue, the lower half the brightness.
fn color(number: u32) -> [f64; 3] {
    if number == 0 {
        return [0.0; 3];
    }
    let [hue, bright] = [number >> 16, number & 0xffff].map(|bits| f64::from(bits) / 65536.0);
    // The hue goes from red through green and blue back to red.
    [0.0, 2.0, 4.0].map(|peak| {
        let distance = (6.0 * hue - peak).rem_euclid(6.0);
        let distance = distance.min(6.0 - distance);
        (0.15 + 0.85 * bright) * (0.1 + 0.9 * (2.0 - distance).clamp(0.0, 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thousand_names_have_a_thousand_colors() {
        let mut colors: Vec<_> = (0..1000).map(|i| color(id(&format!("bead [{i}]"))).map(f64::to_bits)).collect();
        colors.sort_unstable();
        colors.dedup();
        assert_eq!(colors.len(), 1000);
        let bright = |i: usize| color(id(&format!("bead [{i}]"))).into_iter().fold(0.0, f64::max);
        assert!((0..1000).all(|i| (0.15..=1.0).contains(&bright(i))));
        assert_eq!(color(0), [0.0; 3]);
    }
}
