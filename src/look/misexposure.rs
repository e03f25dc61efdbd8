use super::picture::{Exposure, to_rec709};
use crate::film::{ExrFile, ExrLayer, Film};
use crate::spectrum::apply;

/// A picture that is nearly all white or nearly all black, although there is light in the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Misexposure {
    /// What the picture shows.
    pub shows: Shows,
    /// The exposure, in stops, at which most of the picture is neither white nor black.
    pub stops: i32,
}

/// What an overexposed or underexposed picture shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shows {
    /// Only white.
    White,
    /// Only white where there are objects, in front of a sky that is not white.
    WhiteObjects,
    /// Only black, although there is light.
    Black,
}

impl Shows {
    /// Describes what is wrong with a picture of the given name, as the beginning of a sentence.
    pub fn told_of(self, picture: &str) -> String {
        match self {
            Self::White => format!("nearly all of {picture} is brighter than white"),
            Self::WhiteObjects => format!("nearly everything on the objects in {picture} is brighter than white"),
            Self::Black => format!("nearly all of {picture} is too dark to be seen"),
        }
    }
}

/// The multiple of white from which a pixel counts as clipped. Noise around white does not.
const CLIP_LEVEL: f64 = 1.02;
/// Light that a screen shows less than five steps of 255 above black.
const MIN_VISIBLE: f64 = 0.0015;
/// The brightness that most of a picture should have, in stops: about that of middle gray, 0.18.
const MIDDLE_GRAY_STOPS: i32 = -2;
/// The range of a pixel's luminance, in stops, that is distinguished.
const STOP_RANGE: std::ops::RangeInclusive<i32> = -126..=127;

impl Misexposure {
    /// Checks the picture that is written of a film, brightened by 2^`stops` and clipped at white. Returns none for a
    /// film that is only a part of an image.
    pub fn of_film(film: &Film, stops: f64) -> Option<Self> {
        if film.width < film.full[0] || film.height < film.full[1] {
            return None;
        }
        let to_rec709 = film.color_space.to_rec709();
        let exposure = Exposure { stops, ..Exposure::default() };
        Counts::count(
            exposure,
            film.pixels.iter().map(|pixel| (apply(&to_rec709, pixel.rgb.map(f64::from)), pixel.alpha)),
        )
        .misexposure()
    }

    /// Checks a picture of a layer of a file. Returns none if the layer has no colors.
    pub fn of_layer(file: &ExrFile, layer: &ExrLayer, exposure: Exposure) -> Option<Self> {
        let (color, (to_rec709, _)) = (layer.color()?, to_rec709(file));
        let alpha = layer.channel("a");
        let alpha = |index: usize| alpha.map_or(0.0, |alpha| alpha.at(index) as f32);
        let pixels = (0..layer.part.bounds.pixels())
            .map(|index| (apply(&to_rec709, color.map(|channel| channel.at(index))), alpha(index)));
        Counts::count(exposure, pixels).misexposure()
    }
}

/// The number of pixels of each kind.
struct Counts {
    all: u64,
    lit: LitCounts,
    /// The lit pixels that show objects.
    covered: LitCounts,
    /// Pixels in which a screen shows light.
    seen: u64,
}

/// The number of pixels with light.
struct LitCounts {
    all: u64,
    white: u64,
    /// The number of pixels at each luminance.
    by_stops: Vec<u64>,
}

impl LitCounts {
    fn new() -> Self {
        Self { all: 0, white: 0, by_stops: vec![0; STOP_RANGE.clone().count()] }
    }

    fn add(&mut self, is_white: bool, stops: i32) {
        (self.all, self.white) = (self.all + 1, self.white + u64::from(is_white));
        self.by_stops[(stops - STOP_RANGE.start()) as usize] += 1;
    }

    fn is_white(&self) -> bool {
        100 * self.white >= 85 * self.all
    }

    /// Returns the exposure at which three quarters of the pixels have at most middle gray.
    fn fitting_stops(&self) -> i32 {
        let darker = self.by_stops.iter().scan(0, |sum, count| {
            *sum += count;
            Some(*sum)
        });
        MIDDLE_GRAY_STOPS
            - STOP_RANGE.zip(darker).find(|(_, darker)| 4 * darker >= 3 * self.all).map_or(0, |(stops, _)| stops)
    }
}

impl Counts {
    /// Counts pixels, given in linear Rec.709 with alpha.
    fn count(exposure: Exposure, pixels: impl Iterator<Item = ([f64; 3], f32)>) -> Self {
        let mut counts = Self { all: 0, lit: LitCounts::new(), covered: LitCounts::new(), seen: 0 };
        let gain = libm::exp2(exposure.stops);
        for (rgb, alpha) in pixels {
            counts.all += 1;
            let luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
            if !luminance.is_finite() || luminance <= 0.0 {
                continue;
            }
            let is_white = rgb.iter().all(|x| exposure.tone.shown(x * gain / CLIP_LEVEL) >= 1.0);
            let stops = (libm::round(libm::log2(luminance)) as i32).clamp(*STOP_RANGE.start(), *STOP_RANGE.end());
            counts.lit.add(is_white, stops);
            if alpha > 0.5 {
                counts.covered.add(is_white, stops);
            }
            counts.seen += u64::from(rgb.iter().any(|x| exposure.tone.shown(x * gain) >= MIN_VISIBLE));
        }
        counts
    }

    /// Returns what is wrong with the picture, if that is clear. If a white sky is intended, the objects in front of it
    /// are not white. If black is intended, something is visible.
    fn misexposure(&self) -> Option<Misexposure> {
        let (lit, covered) = (&self.lit, &self.covered);
        let (shows, counts) = match covered.is_white() {
            true if lit.is_white() && 2 * lit.white > self.all => (Shows::White, lit),
            true if 3 * covered.all > self.all => (Shows::WhiteObjects, covered),
            _ if 20 * lit.all > self.all && 1000 * self.seen <= self.all => (Shows::Black, lit),
            _ => return None,
        };
        Some(Misexposure { shows, stops: counts.fitting_stops() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks a picture of grays, each with its alpha.
    fn misexposure_of(grays: &[(f64, f32)], stops: f64) -> Option<Misexposure> {
        let exposure = Exposure { stops, ..Exposure::default() };
        Counts::count(exposure, grays.iter().map(|&(gray, alpha)| ([gray; 3], alpha))).misexposure()
    }

    #[test]
    fn a_picture_that_is_all_white_or_all_black_is_reported_with_the_exposure_of_middle_gray() {
        let [white, objects, black] = [Shows::White, Shows::WhiteObjects, Shows::Black]
            .map(|shows| move |stops| Some(Misexposure { shows, stops }));
        assert_eq!(misexposure_of(&[(8.0, 1.0), (16.0, 1.0), (8.0, 0.0), (4.0, 0.0)], 0.0), white(-5));
        assert_eq!(misexposure_of(&[(1.5, 1.0)], 0.0), white(-3));
        assert_eq!(misexposure_of(&[(0.2, 1.0)], 4.0), white(0));
        assert_eq!(misexposure_of(&[(64.0, 1.0), (64.0, 1.0), (0.3, 0.0), (0.4, 0.0)], 0.0), objects(-8));
        assert_eq!(misexposure_of(&[(1e-5, 1.0), (2e-5, 1.0), (0.0, 0.0)], 0.0), black(14));
        assert_eq!(misexposure_of(&[(0.2, 1.0)], -10.0), black(0));
    }

    #[test]
    fn white_and_black_that_may_be_intended_are_not_reported() {
        let mostly = |gray: f64, (other, alpha): (f64, f32)| {
            let mut all = vec![(gray, 0.0); 99];
            all.push((other, alpha));
            misexposure_of(&all, 0.0)
        };
        // An object in front of a white sky, a white furnace, a lamp and a star in the dark, no light at all.
        assert_eq!(mostly(3.0, (0.4, 1.0)), None);
        assert_eq!(misexposure_of(&[(1.01, 1.0), (1.0, 1.0)], 0.0), None);
        assert_eq!(mostly(0.0, (50.0, 1.0)), None);
        assert_eq!(mostly(1e-5, (0.5, 0.0)), None);
        assert_eq!(misexposure_of(&[(0.0, 1.0), (f64::NAN, 1.0), (-1.0, 0.0)], 0.0), None);
    }
}
