use crate::film::{Filter, MAX_PIXELS, Overscan, Window};
use crate::spectrum::ColorSpace;

/// Size and meaning of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmSettings {
    /// Pixels per row of the format.
    pub width: u32,
    /// Rows of the format.
    pub height: u32,
    /// The pixel filter, which decides where in its pixel a sample falls.
    pub filter: Filter,
    /// The color space of the numbers.
    pub color_space: ColorSpace,
    /// Extra pixels around the format.
    pub overscan: Overscan,
    /// The part of the image and its overscan that is rendered; all of it if absent.
    pub crop: Option<Window>,
}

impl FilmSettings {
    /// Maximum number of pixels in a row or column, with the overscan.
    pub const MAX_SIDE: u32 = 65_536;
    /// Maximum number of pixels, with the overscan: 19 GB of sums and values, without layers.
    pub const MAX_PIXELS: u64 = MAX_PIXELS as u64;

    /// Returns the part of the image that is rendered.
    pub fn window(&self) -> Window {
        self.crop.unwrap_or(self.with_overscan())
    }

    /// Returns the format: what the camera frames, and all that the plan looks at.
    pub fn whole(&self) -> Window {
        Window { left: 0, top: 0, width: self.width, height: self.height }
    }

    /// Returns the format with its overscan.
    pub fn with_overscan(&self) -> Window {
        let Overscan { left, top, right, bottom } = self.overscan;
        let (width, height) = (self.width + left + right, self.height + top + bottom);
        Window { left: -(left as i32), top: -(top as i32), width, height }
    }

    /// Returns the same film restricted to the format. The decisions on how pixels are rendered look at no other part
    /// of it, so that all parts are rendered in the same way.
    #[must_use]
    pub fn of_the_format(self) -> Self {
        Self { overscan: Overscan::default(), crop: None, ..self }
    }

    /// Returns what is wrong with the overscan, if anything.
    pub fn objection_to_overscan(&self) -> Option<String> {
        let Overscan { left, top, right, bottom } = self.overscan;
        let side = |size: u32, before: u32, behind: u32| u64::from(size) + u64::from(before) + u64::from(behind);
        let (width, height) = (side(self.width, left, right), side(self.height, top, bottom));
        let (most, fit, size) = (Self::MAX_SIDE, Self::MAX_PIXELS, width.max(height));
        if size > u64::from(most) {
            return Some(format!("an image with its overscan has at most {most} pixels along each side, not {size}"));
        }
        let all = width * height;
        (all > fit).then(|| format!("{width} x {height} with the overscan is {all} pixels; at most {fit} fit"))
    }

    /// Returns what is wrong with the crop, if anything. The overscan must be valid.
    pub fn objection_to_crop(&self) -> Option<String> {
        let crop = self.crop?;
        let Window { width, height, .. } = crop;
        if width == 0 || height == 0 {
            return Some(format!("a crop has at least 1 pixel along each side, not {width} x {height}"));
        }
        let available = self.with_overscan();
        if available.holds(&crop) {
            return None;
        }
        let ([[left, top], [right, bottom]], [first, end]) = (crop.ends(), available.ends());
        let plain = self.overscan == Overscan::default();
        let image = if plain { "the image" } else { "the image with its overscan" };
        Some(if left < first[0] || top < first[1] {
            let begins = format!("this crop begins at column {left}, row {top}");
            format!("{begins}, but {image} begins at column {}, row {}", first[0], first[1])
        } else if plain {
            let ends = format!("this crop ends at column {right}, row {bottom}");
            format!("{ends}, but {image} has {} x {} pixels", self.width, self.height)
        } else {
            let ends = format!("this crop ends before column {right}, row {bottom}");
            format!("{ends}, but {image} before column {}, row {}", end[0], end[1])
        })
    }
}
