//! Images and patterns that vary a spectrum over a surface.

use std::sync::Arc;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// A smooth passage, linear in light.
    #[default]
    Linear,
    /// The nearest texel, so that each is an even square.
    Nearest,
}

/// What the numbers of an image file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Encoding {
    /// Colors as screens show them (IEC 61966-2-1): the default of PNG and JPEG.
    Srgb,
    /// Light itself: the default of OpenEXR and Radiance.
    Linear,
}

/// One number of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[allow(missing_docs)]
pub enum Channel {
    Red,
    Green,
    Blue,
    /// Opacity, which is always linear.
    Alpha,
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
    pub(super) fn place(self, x: f64) -> f64 {
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
    pub(super) fn entry(self, at: isize, count: usize) -> usize {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three texels, each its own number.
    fn texture(wrap: Wrap, filter: TexelFilter, repeat: f64) -> Texture {
        let image = Arc::new(Image::of_floats(3, 1, vec![0.0, 1.0, 2.0, 10.0, 11.0, 12.0]));
        Texture { image, placement: Placement { repeat: [repeat; 2], wrap, filter } }
    }

    #[test]
    fn the_first_row_is_on_top_and_every_texel_has_its_value_in_its_middle() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for filter in [TexelFilter::Linear, TexelFilter::Nearest] {
                let texture = texture(wrap, filter, 2.0);
                for (i, v) in [0.375, 0.125].into_iter().enumerate() {
                    for j in 0..3 {
                        let found = texture.color([(j as f64 + 0.5) / 6.0, v])[0];
                        assert!((found - (10 * i + j) as f32).abs() < 1e-5, "{wrap:?} {filter:?} {i} {j}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn beyond_its_edges_an_image_goes_on_as_it_is_told() {
        let at = |wrap, filter, u: f64| texture(wrap, filter, 1.0).color([u, 0.75])[0];
        let nearest = |wrap, u| at(wrap, TexelFilter::Nearest, u);
        assert_eq!([-0.9, -0.1, 1.1, 7.5].map(|u| nearest(Wrap::Repeat, u)), [0.0, 2.0, 0.0, 1.0]);
        assert_eq!([-0.9, -0.1, 1.1, 7.5].map(|u| nearest(Wrap::Clamp, u)), [0.0, 0.0, 2.0, 2.0]);
        assert_eq!([-0.9, -0.1, 1.1, 1.9].map(|u| nearest(Wrap::Mirror, u)), [2.0, 0.0, 2.0, 0.0]);
        // At a seam the neighbors are averaged: the last and the first texel, or one with itself.
        let seam = |wrap| at(wrap, TexelFilter::Linear, 1.0);
        assert_eq!([Wrap::Repeat, Wrap::Clamp, Wrap::Mirror].map(seam), [1.0, 2.0, 2.0]);
    }

    #[test]
    fn the_image_is_continuous_but_for_its_nearest_texels() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            let texture = texture(wrap, TexelFilter::Linear, 1.5);
            // No two neighbors differ by more than 12, and 3 x 1.5 of them fill a unit.
            let mut last = texture.color([-2.0, -2.0])[0];
            for i in 1..40_000 {
                let place = -2.0 + 1e-4 * f64::from(i);
                let next = texture.color([place, place])[0];
                assert!((next - last).abs() <= 24.0 * 4.5 * 1.1e-4, "{wrap:?} at {place}: {last} to {next}");
                last = next;
            }
        }
    }

    #[test]
    fn far_away_places_lie_within_the_image() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for filter in [TexelFilter::Linear, TexelFilter::Nearest] {
                for u in [-1e300, 1e300, -1e-300, 1e16, -5e-17, f64::MAX, f64::MIN_POSITIVE] {
                    let found = texture(wrap, filter, 1.0).color([u, -u])[0];
                    assert!((0.0..=12.0).contains(&found), "{wrap:?} {filter:?} at {u}: {found}");
                }
            }
        }
    }

    #[test]
    fn every_8_bit_srgb_value_is_decoded_to_the_light_that_encodes_to_it() {
        let image = Image::of_bytes(256, 1, (0..=255).collect(), true);
        for byte in 0..=255_u8 {
            assert_eq!(crate::spectrum::encode_srgb(image.texel(usize::from(byte), 0)), [byte; 3]);
        }
    }
}
