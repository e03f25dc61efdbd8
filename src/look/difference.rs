use palette::color_difference::Ciede2000;
use palette::{FromColor, Lab, LinSrgb};

use super::mattes::Mattes;
use super::noise::{FALSE_ALARM_RATE, Noise, NoisyImage};
use super::picture::{Picture, percentile, to_rec709};
use super::tone::shown;
use crate::error::{Error, Result};
use crate::film::{BEAUTY, Channel, ExrFile, ExrLayer, PixelBounds};
use crate::spectrum::{apply, describe_file_colors};

/// Added to the square of a value before it divides the square of a difference, to bound the influence of dark pixels.
const MSE_OFFSET: f64 = 0.01;
/// The largest difference between the matrices of two equal color spaces, written as 32-bit floats.
const MAX_MATRIX_ERROR: f64 = 1e-3;

/// The difference between two images. Pixels with a value that is not finite are left out, except from `torn`.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Difference {
    /// The compared pixels: those that both images have.
    pub bounds: PixelBounds,
    /// Whether one of the images has other pixels as well, for example if the other one is a crop.
    pub is_part: bool,
    /// The compared channels.
    pub channels: Vec<String>,
    /// Whether all values are equal. NaN counts as equal to NaN.
    pub is_equal: bool,
    /// The other layers that differ between the files, if the images are entirely equal.
    pub layers_apart: Vec<String>,
    /// The layers, and channels of common layers, that only the first or second file has, if no layer was requested.
    pub only_in: [Vec<String>; 2],
    /// The number of pixels that are left out.
    pub left_out: usize,
    /// How many left-out pixels differ, for example finite in only one image, or infinite with opposite signs.
    pub torn: usize,
    /// The mean of (a - b)^2 / (b^2 + 0.01) over all values.
    pub relative_mse: f64,
    /// The sum of the first image's values, divided by that of the second image's.
    pub brightness: f64,
    /// The perceived difference of the colors, if the layer has colors.
    pub color: Option<ColorDifference>,
    /// The pixel with the largest sum of (a - b)^2 / (b^2 + 0.01), if any differs.
    pub worst: Option<WorstPixel>,
    /// The first left-out pixel that differs, if any does.
    pub first_torn: Option<WorstPixel>,
    /// The difference in the alpha of the compared colors, if there is any.
    pub alpha: Option<AlphaDifference>,
    /// Whether the difference is noise, if both files state how noisy they are.
    pub noise: Option<Noise>,
    /// The largest |a - b| of each pixel's values. For a left-out pixel, infinity if it differs, else 0.
    pub absolute: Vec<f64>,
}

/// The difference in the alpha of two images. No file states how noisy its alpha is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlphaDifference {
    /// The largest |a - b|. It is infinite if values differ that are not both finite.
    pub largest: f64,
    /// The mean of (a - b)^2 / (b^2 + 0.01).
    pub relative_mse: f64,
    /// Pixels that are empty in one image and full in the other.
    pub opposite: usize,
    /// An upper bound on the mean number of opposite pixels by chance. None unless both files state their noise and
    /// their number of samples. If a fraction p of a pixel is covered, n samples all miss it and n others all hit it
    /// with the probability p^n (1 - p)^n, which is at most 1 / 4^n.
    pub opposite_by_chance: Option<f64>,
}

/// The CIEDE2000 difference (CIE 142:2001) of the colors as a screen shows them: converted to Rec.709 and clipped to
/// 0..1. The film's (1, 1, 1) is L* = 100 under D65.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorDifference {
    /// The mean over all pixels.
    pub mean: f64,
    /// The largest difference.
    pub worst: f64,
    /// The fraction of pixels with a value that was clipped in either image.
    pub clipped: f64,
}

/// The values of both images in one pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstPixel {
    /// Column and row in the full image.
    pub position: [i64; 2],
    /// The values of the first and of the second image.
    pub values: [Vec<f64>; 2],
}

/// Compares a layer of two files, or the beauty if no layer is named. For mattes, compares the coverage. Mattes are
/// named as a whole, by `CryptoObject` or one of their layers such as `CryptoObject00`, or individually by
/// `CryptoObject.ball`. `shown` are the files' names in messages. If one image is cropped or has overscan, compares the
/// pixels that both have.
///
/// # Errors
/// [`Error::Arguments`] if one of the files has no such layer, if sizes, channels or color spaces differ, or if the
/// images have no pixel in common.
pub fn compare(files: [&ExrFile; 2], layer: Option<&str>, shown: [&str; 2]) -> Result<Difference> {
    let mattes = layer.map(|requested| files.map(|file| Mattes::name_of_layer(file, requested)));
    let layer = mattes.and_then(|[a, b]| a.filter(|_| a == b)).or(layer);
    let layers = match [0, 1].map(|i| files[i].layer(layer, shown[i])) {
        [Ok(a), Ok(b)] => [a, b],
        [Err(missing), _] | [_, Err(missing)] => {
            return compare_mattes(files, layer.unwrap_or_default(), shown, missing);
        }
    };
    let bounds = layers.each_ref().map(|layer| layer.part.bounds);
    let mut found = match compare_common(files, bounds, layer, shown) {
        Some(found) => found?,
        None => compare_layers(files, &layers, layer, shown)?,
    };
    if layer.is_none() {
        found.only_in = [only_in(files), only_in([files[1], files[0]])];
    }
    Ok(found)
}

/// Compares mattes. If there is no such matte, the error is `missing`, or lists the mattes of a file that lacks it.
fn compare_mattes(files: [&ExrFile; 2], requested: &str, shown: [&str; 2], missing: Error) -> Result<Difference> {
    let all = files.map(Mattes::all);
    let [Some((a, one)), Some((b, _))] = all.each_ref().map(|all| Mattes::named(all, requested)) else {
        let lacks_layer = |file: &usize| {
            files[*file].layer(Some(requested), "").is_err() && Mattes::named(&all[*file], requested).is_none()
        };
        let names = |file: usize| all[file].iter().map(Mattes::name).collect::<Vec<_>>();
        let listed = (0..2).find(lacks_layer).filter(|file| !all[*file].is_empty());
        return Err(listed.map_or(missing, |file| files[file].no_layer(requested, shown[file], &names(file))));
    };
    if let Some(found) = compare_common(files, [a, b].map(|mattes| mattes.part.bounds), Some(requested), shown) {
        return found;
    }
    let channels = Mattes::coverages([a, b], one, shown)?;
    let layer = |part, channel| ExrLayer { name: requested.to_owned(), part, channels: vec![channel] };
    compare_layers(files, &[layer(a.part, &channels[0]), layer(b.part, &channels[1])], Some(requested), shown)
}

/// Compares the pixels that both files have, if one of the files has others as well.
fn compare_common(
    files: [&ExrFile; 2],
    bounds: [PixelBounds; 2],
    layer: Option<&str>,
    shown: [&str; 2],
) -> Option<Result<Difference>> {
    let common = bounds[0].common(&bounds[1]).filter(|_| files[0].display == files[1].display);
    let common = common.filter(|_| bounds[0] != bounds[1])?;
    let [a, b] = files.map(|file| file.crop(common));
    Some(compare([&a, &b], layer, shown).map(|found| Difference { is_part: true, ..found }))
}

/// Compares two layers that cover the same pixels.
fn compare_layers(
    files: [&ExrFile; 2],
    layers: &[ExrLayer; 2],
    layer: Option<&str>,
    shown: [&str; 2],
) -> Result<Difference> {
    check_comparable(files, layers, shown)?;
    let [a, b] = layers.each_ref().map(ExrLayer::values);
    let bounds = layers[0].part.bounds;
    let mut found = value_difference([&a, &b], bounds);
    if layers.iter().all(|layer| layer.color().is_some()) {
        found.color = Some(color_difference(files, [&a, &b], &found));
        found.alpha = alpha_difference(layers, bounds);
        found.is_equal &= found.alpha.is_none();
    }
    if let [Some(first), Some(second)] = [0, 1].map(|i| NoisyImage::new(files[i], &layers[i]))
        && layers[0].name == BEAUTY
    {
        let finite =
            |index: usize| [&a, &b].iter().all(|channels| channels.iter().all(|one| one.at(index).is_finite()));
        found.noise = Some(Noise::new([&first, &second], |index| !finite(index)));
        let min_samples = |index: usize| Some(first.sample_count(index)?.min(second.sample_count(index)?));
        let by_chance = |index: usize| Some(2.0 * libm::pow(0.25, min_samples(index)?));
        let by_chance = (0..found.absolute.len()).map(by_chance).sum();
        found.alpha = found.alpha.map(|alpha| AlphaDifference { opposite_by_chance: by_chance, ..alpha });
    }
    if layer.is_none() && found.is_equal {
        found.layers_apart = layers_apart(files);
    }
    Ok(found)
}

/// Lists what the first file has and the second one lacks: layers, and channels of common layers.
fn only_in([own, other]: [&ExrFile; 2]) -> Vec<String> {
    let others = other.layers();
    let mut only = Vec::new();
    for layer in own.layers() {
        let Some(same) = others.iter().find(|other| other.name == layer.name) else {
            only.push(layer.name);
            continue;
        };
        let is_missing = |channel: &&&Channel| !same.channels.iter().any(|other| other.name == channel.name);
        only.extend(layer.channels.iter().filter(is_missing).map(|channel| channel.full_name()));
    }
    merge_matte_layers(own, only)
}

/// Replaces the names of matte layers by the names of their mattes.
fn merge_matte_layers(file: &ExrFile, names: Vec<String>) -> Vec<String> {
    let mattes = Mattes::all(file);
    let kind =
        |name: String| mattes.iter().find(|kind| kind.has_layer(&name)).map_or(name, |kind| kind.name().to_owned());
    let mut listed: Vec<String> = names.into_iter().map(kind).collect();
    listed.dedup();
    listed
}

/// Lists the layers that differ between the files, in the channels and pixels that both have.
fn layers_apart(files: [&ExrFile; 2]) -> Vec<String> {
    let [first, second] = files.map(ExrFile::layers);
    let mut differing = Vec::new();
    for a in &first {
        let Some(b) = second.iter().find(|b| b.name == a.name) else { continue };
        let bounds = [a, b].map(|layer| layer.part.bounds);
        let Some(common) = bounds[0].common(&bounds[1]) else { continue };
        let differs = |one: &Channel| {
            let other = b.channels.iter().find(|other| other.name == one.name);
            let mut places = (0..common.pixels()).map(|index| bounds.map(|bounds| bounds.index(common.place(index))));
            other.is_some_and(|other| !places.all(|[a, b]| is_same(one.at(a), other.at(b))))
        };
        if a.channels.iter().any(|one| differs(one)) {
            differing.push(a.name.clone());
        }
    }
    merge_matte_layers(files[0], differing)
}

/// Refuses images that differ in their pixels, their channels or their color space.
fn check_comparable(files: [&ExrFile; 2], layers: &[ExrLayer; 2], shown: [&str; 2]) -> Result<()> {
    let refuse = |what: [String; 2], help: &str| {
        Error::refuse(format!("{} has {}, {} {}", shown[0], what[0], shown[1], what[1]), help)
    };
    let bounds = layers.each_ref().map(|layer| layer.part.bounds);
    if bounds[0] != bounds[1] || files[0].display != files[1].display {
        let place = |i: usize| {
            let ([x, y], [width, height], full) = (bounds[i].corner, bounds[i].size, files[i].display.size);
            format!("{width} x {height} pixels at ({x}, {y}) of {} x {}", full[0], full[1])
        };
        return refuse([0, 1].map(place), "images of the same full size can be compared where both have pixels");
    }
    let names = layers
        .each_ref()
        .map(|layer| layer.values().iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", "));
    if names[0] != names[1] {
        return refuse(names.map(|names| format!("the channels {names}")), "use --layer to compare another layer");
    }
    if layers[0].color().is_some() {
        let matrices = files.map(|file| to_rec709(file).0);
        let pairs = matrices[0].as_flattened().iter().zip(matrices[1].as_flattened());
        if pairs.into_iter().any(|(a, b)| (a - b).abs() > MAX_MATRIX_ERROR) {
            let space = |file: &ExrFile| describe_file_colors(file.attribute("colorInteropID"), file.chromaticities);
            return refuse(files.map(space), "colors of different color spaces cannot be compared");
        }
    }
    Ok(())
}

/// Returns whether two values are equal. NaN counts as equal to NaN.
fn is_same(a: f64, b: f64) -> bool {
    a == b || a.is_nan() && b.is_nan()
}

/// Measures everything that depends on the values alone.
fn value_difference([a, b]: [&[&Channel]; 2], bounds: PixelBounds) -> Difference {
    let (mut sums, mut squares, mut values, mut most) = ([0.0; 2], 0.0, 0usize, 0.0);
    let mut found = Difference {
        bounds,
        is_part: false,
        channels: a.iter().map(|channel| channel.name.clone()).collect(),
        is_equal: true,
        layers_apart: Vec::new(),
        only_in: [Vec::new(), Vec::new()],
        left_out: 0,
        torn: 0,
        relative_mse: 0.0,
        brightness: 1.0,
        color: None,
        alpha: None,
        worst: None,
        first_torn: None,
        noise: None,
        absolute: Vec::with_capacity(bounds.pixels()),
    };
    let place = |index: usize| {
        let values_of = |channels: &[&Channel]| channels.iter().map(|channel| channel.at(index)).collect();
        WorstPixel { position: bounds.place(index), values: [values_of(a), values_of(b)] }
    };
    for index in 0..bounds.pixels() {
        let pairs = || a.iter().zip(b).map(|(a, b)| (a.at(index), b.at(index)));
        let is_equal = pairs().all(|(a, b)| is_same(a, b));
        found.is_equal &= is_equal;
        if pairs().any(|(a, b)| !(a.is_finite() && b.is_finite())) {
            found.left_out += 1;
            found.torn += usize::from(!is_equal);
            if !is_equal && found.first_torn.is_none() {
                found.first_torn = Some(place(index));
            }
            found.absolute.push(if is_equal { 0.0 } else { f64::INFINITY });
            continue;
        }
        let (mut error, mut absolute) = (0.0, 0.0f64);
        for (a, b) in pairs() {
            error += (a - b) * (a - b) / (b * b + MSE_OFFSET);
            absolute = absolute.max((a - b).abs());
            sums = [sums[0] + a, sums[1] + b];
            values += 1;
        }
        squares += error;
        found.absolute.push(absolute);
        if error > most {
            most = error;
            found.worst = Some(place(index));
        }
    }
    found.relative_mse = squares / values.max(1) as f64;
    found.brightness = if sums[0] == sums[1] { 1.0 } else { sums[0] / sums[1] };
    found
}

fn alpha_difference(layers: &[ExrLayer; 2], bounds: PixelBounds) -> Option<AlphaDifference> {
    let [a, b] = layers.each_ref().map(|layer| layer.channel("a"));
    let (a, b) = (a?, b?);
    let found = value_difference([&[a], &[b]], bounds);
    let largest = found.absolute.iter().copied().fold(0.0, f64::max);
    let is_opposite = |index: &usize| [[0.0, 1.0], [1.0, 0.0]].contains(&[a.at(*index), b.at(*index)]);
    let opposite = (0..found.absolute.len()).filter(is_opposite).count();
    let result = AlphaDifference { largest, relative_mse: found.relative_mse, opposite, opposite_by_chance: None };
    (!found.is_equal).then_some(result)
}

fn color_difference(files: [&ExrFile; 2], colors: [&[&Channel]; 2], value_difference: &Difference) -> ColorDifference {
    let matrices = files.map(|file| to_rec709(file).0);
    let (mut sum, mut worst, mut clipped, mut count) = (0.0, 0.0f64, 0usize, 0usize);
    for index in 0..value_difference.absolute.len() {
        let values = [0, 1].map(|i| [0, 1, 2].map(|channel| colors[i][channel].at(index)));
        if !values.as_flattened().iter().all(|x| x.is_finite()) {
            continue;
        }
        let seen = [0, 1].map(|i| apply(&matrices[i], values[i]));
        let difference = delta_e_2000(seen);
        (sum, worst, count) = (sum + difference, worst.max(difference), count + 1);
        // The matrices map white to 1 only up to rounding.
        clipped += usize::from(seen.as_flattened().iter().any(|x| !(-1e-6..=1.0 + 1e-6).contains(x)));
    }
    let count = count.max(1) as f64;
    ColorDifference { mean: sum / count, worst, clipped: clipped as f64 / count }
}

/// Returns the CIEDE2000 difference of two linear Rec.709 colors, which are clipped to 0..1.
fn delta_e_2000(colors: [[f64; 3]; 2]) -> f64 {
    let [a, b] = colors.map(|color| {
        let [red, green, blue] = color.map(shown);
        Lab::from_color(LinSrgb::new(red, green, blue))
    });
    Ciede2000::difference(a, b)
}

impl AlphaDifference {
    /// Returns whether chance makes this many pixels opposite in at most one of a hundred pairs of images. By Markov's
    /// inequality, a nonnegative random number exceeds a hundred times its mean no more often.
    pub fn contradicts(&self) -> bool {
        self.opposite_by_chance.is_some_and(|by_chance| FALSE_ALARM_RATE * self.opposite as f64 > by_chance)
    }
}

impl Difference {
    /// Returns whether the images agree. Equal values do, unless other layers differ. Otherwise the relative mean
    /// squared error must be within the tolerance, if there is one, or else the difference must be within the noise of
    /// both images. Without tolerance and known noise, images that differ do not agree. Without tolerance, they also do
    /// not agree if only alpha differs, as its noise is unknown, or if more pixels are empty in one image and full in
    /// the other than chance makes. Images with torn pixels never agree.
    pub fn agrees(&self, tolerance: Option<f64>) -> bool {
        if self.is_equal {
            return tolerance.is_some() || self.layers_apart.is_empty();
        }
        let alpha_fits = match (&self.alpha, tolerance) {
            (None, _) => true,
            (Some(alpha), Some(tolerance)) => alpha.largest.is_finite() && alpha.relative_mse <= tolerance,
            (Some(alpha), None) => self.relative_mse > 0.0 && !alpha.contradicts(),
        };
        let is_close = match (tolerance, &self.noise) {
            (Some(tolerance), _) => self.relative_mse <= tolerance,
            (None, Some(noise)) => noise.agrees(),
            (None, None) => false,
        };
        is_close && alpha_fits && self.torn == 0
    }

    /// Returns the largest difference of each pixel as a gray picture, and the difference that is shown as white: the
    /// 99th percentile, or the largest one if that is 0. It is 0 if only values that are not finite differ.
    pub fn picture(&self) -> (Picture, f64) {
        let finite: Vec<f64> = self.absolute.iter().copied().filter(|x| x.is_finite()).collect();
        let largest = finite.iter().copied().fold(0.0, f64::max);
        let white = percentile(finite, 99).filter(|white| *white > 0.0).unwrap_or(largest);
        let gray = |x: &f64| if *x > 0.0 { shown(x / white) } else { 0.0 };
        (Picture::of_grays(self.bounds.size[0], self.absolute.iter().map(gray)), white)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sharma, Wu & Dalal 2005, *The CIEDE2000 Color-Difference Formula*, table 1, pairs 1, 7, 13, 17 and 25.
    #[test]
    fn known_pairs_are_as_far_apart_as_published() {
        for (a, b, expected) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, -0.001, 2.49], [50.0, 0.0011, -2.49], 4.7461),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ] {
            let lab = |[l, a, b]: [f64; 3]| Lab::<palette::white_point::D65, f64>::new(l, a, b);
            let found = Ciede2000::difference(lab(a), lab(b));
            assert!((found - expected).abs() < 5e-5, "{found} is not {expected}");
        }
    }

    /// Grays of L* 0, 50 and 100: linear 0, ((50 + 16) / 116)^3 and 1. Of L* 50 and 100, S_L is
    /// 1 + 0.015 * 25^2 / sqrt(20 + 25^2) = 1.36911.
    #[test]
    fn grays_differ_by_their_lightness_alone_and_light_beyond_white_is_white() {
        let gray = libm::pow(66.0 / 116.0, 3.0);
        assert!((delta_e_2000([[1.0; 3], [gray; 3]]) - 50.0 / 1.369_11).abs() < 2e-2);
        assert_eq!(delta_e_2000([[1.0; 3], [1e30, 2.0, f64::INFINITY]]), 0.0);
        assert_eq!(delta_e_2000([[0.0; 3], [-3.0; 3]]), 0.0);
    }
}
