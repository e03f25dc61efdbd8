//! Images and patterns that vary a spectrum over a surface.

use std::sync::Arc;

use serde::{Deserialize, Deserializer};

use super::Image;

/// How an image lies in the coordinates (u, v) of a surface: its bottom left corner at (0, 0), u to the right, v up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// How often it fits into one unit of u and of v, above 0.
    pub repeat: [f64; 2],
    /// What there is beyond it.
    pub wrap: Wrap,
    /// What there is between the middles of its texels.
    pub filter: TexelFilter,
}

impl Default for Placement {
    fn default() -> Self {
        Self { repeat: [1.0; 2], wrap: Wrap::default(), filter: TexelFilter::default() }
    }
}

/// What lies beyond the edges of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Wrap {
    /// The image again.
    #[default]
    Repeat,
    /// Its edge, on and on.
    Clamp,
    /// The image again, every other time as in a mirror.
    Mirror,
}

/// What lies between the middles of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TexelFilter {
    /// A smooth passage, linear in light.
    #[default]
    Linear,
    /// The nearest texel, so that each is an even square.
    Nearest,
}

/// What the numbers of an image file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// Colors as screens show them (IEC 61966-2-1): the default of PNG and JPEG.
    Srgb,
    /// Light itself: the default of OpenEXR and Radiance.
    Linear,
}

/// One number of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum Channel {
    Red,
    Green,
    Blue,
    /// Opacity, which is always linear.
    Alpha,
}

/// An image as a scene file names it.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageText {
    /// Its path, relative to the scene.
    pub file: String,
    /// What its numbers stand for, if not what its kind of file implies.
    pub encoding: Option<Encoding>,
    /// The one number of each texel that is read, as a gray; all three if absent.
    pub channel: Option<Channel>,
    /// Where it lies.
    pub placement: Placement,
}

/// An image on a surface.
///
/// There are no smaller copies for surfaces far away: the samples of a pixel see different texels, and their mean converges
/// to the mean of all that the pixel covers, which a copy would only estimate, and wrongly where the surface is seen in a
/// curved mirror or lies in part in shadow.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The image.
    pub image: Arc<Image>,
    /// Where it lies.
    pub placement: Placement,
}

/// The very same image in the same place.
impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image) && self.placement == other.placement
    }
}

impl Texture {
    /// What is seen at a place of the surface, linear Rec.709.
    pub fn color(&self, [u, v]: [f64; 2]) -> [f32; 3] {
        let Placement { repeat, wrap, filter } = self.placement;
        let (width, height) = (self.image.width(), self.image.height());
        let across = wrap.place(u * repeat[0]) * width as f64;
        let down = (1.0 - wrap.place(v * repeat[1])) * height as f64;
        if filter == TexelFilter::Nearest {
            return self.image.texel((across as usize).min(width - 1), (down as usize).min(height - 1));
        }
        let (x, y) = (across - 0.5, down - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let (right, below) = ((x - left) as f32, (y - above) as f32);
        let columns = [0, 1].map(|i| wrap.entry(left as isize + i, width));
        let rows = [0, 1].map(|i| wrap.entry(above as isize + i, height));
        let [upper, lower] = rows.map(|row| columns.map(|column| self.image.texel(column, row)));
        std::array::from_fn(|c| {
            let mix = |[a, b]: [[f32; 3]; 2]| a[c] + right * (b[c] - a[c]);
            let (upper, lower) = (mix(upper), mix(lower));
            upper + below * (lower - upper)
        })
    }
}

impl Wrap {
    /// Where in the image a place lies, 0 to 1.
    fn place(self, x: f64) -> f64 {
        match self {
            Self::Repeat => x - x.floor(),
            Self::Clamp => x.clamp(0.0, 1.0),
            Self::Mirror => {
                let x = x - 2.0 * (0.5 * x).floor();
                if x > 1.0 { 2.0 - x } else { x }
            }
        }
    }

    /// The texel at a position, which may lie one beyond either end.
    fn entry(self, at: isize, count: usize) -> usize {
        match self {
            Self::Repeat => at.rem_euclid(count as isize) as usize,
            Self::Clamp | Self::Mirror => at.clamp(0, count as isize - 1) as usize,
        }
    }
}

/// Which of two squares of a checkerboard lies at a place; `repeat` squares fill a unit, the first begins at (0, 0).
pub(super) fn square(repeat: [f64; 2], uv: [f64; 2]) -> usize {
    let [x, y] = [0, 1].map(|i| (uv[i] * repeat[i]).floor().rem_euclid(2.0));
    usize::from(x != y)
}

/// A number that stands for both axes, or two numbers.
pub(super) fn number_or_two<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<[f64; 2]>, D::Error> {
    struct Two;
    impl<'de> serde::de::Visitor<'de> for Two {
        type Value = [f64; 2];
        fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
            formatter.write_str("a number or [u, v]")
        }
        fn visit_f64<E>(self, value: f64) -> Result<[f64; 2], E> {
            Ok([value; 2])
        }
        fn visit_i64<E>(self, value: i64) -> Result<[f64; 2], E> {
            Ok([value as f64; 2])
        }
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, sequence: A) -> Result<[f64; 2], A::Error> {
            Deserialize::deserialize(serde::de::value::SeqAccessDeserializer::new(sequence))
        }
    }
    deserializer.deserialize_any(Two).map(Some)
}
