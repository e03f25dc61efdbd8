//! Images and patterns that vary a spectrum over a surface.

use std::sync::Arc;

use super::{Image, Wrap};

/// How an image lies in the coordinates (u, v) of a surface: its bottom left corner at (0, 0), u to the right, v up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Number of repetitions per unit of u and of v, above 0.
    pub repeat: [f64; 2],
    /// What lies beyond the image.
    pub wrap: Wrap,
    /// What lies between the centers of its texels.
    pub filter: TexelFilter,
}

impl Default for Placement {
    fn default() -> Self {
        Self { repeat: [1.0; 2], wrap: Wrap::default(), filter: TexelFilter::default() }
    }
}

/// What lies between the centers of texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TexelFilter {
    /// Interpolation that is linear in light.
    #[default]
    Linear,
    /// The nearest texel, so that each is a uniform square.
    Nearest,
}

/// What the numbers of an image file stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Encoding {
    /// Colors encoded for screens (IEC 61966-2-1): the default of PNG and JPEG.
    Srgb,
    /// Linear light: the default of OpenEXR and Radiance.
    Linear,
}

/// One channel of a texel.
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
/// There are no mipmaps for distant surfaces. The samples of a pixel see different texels, and their mean converges to
/// the mean of all that the pixel covers. A mipmap would only estimate that, and wrongly where the surface is seen in a
/// curved mirror or lies partly in shadow.
#[derive(Clone, Debug)]
pub struct Texture {
    /// The image.
    pub image: Arc<Image>,
    /// Its placement.
    pub placement: Placement,
}

/// Equality means the very same image in the same place.
impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.image, &other.image) && self.placement == other.placement
    }
}

impl Texture {
    /// Returns the color at a place of the surface, in linear Rec.709.
    pub fn color(&self, [u, v]: [f64; 2]) -> [f32; 3] {
        let Placement { repeat, wrap, filter } = self.placement;
        let (width, height) = (self.image.width(), self.image.height());
        let across = wrap.coordinate(u * repeat[0]) * width as f64;
        let down = (1.0 - wrap.coordinate(v * repeat[1])) * height as f64;
        if filter == TexelFilter::Nearest {
            return self.image.texel((across as usize).min(width - 1), (down as usize).min(height - 1));
        }
        self.image.bilinear([across, down], [wrap; 2])
    }

    /// Returns the derivatives of the image's heights by u and v. The height of a color is the mean of its numbers.
    ///
    /// Between texels, heights are a quadratic B-spline (de Boor 1978, *A Practical Guide to Splines*): a mean over the
    /// three by three texels around. Its slope changes continuously, where that of linear interpolation would show each
    /// texel as a facet. An even slope is preserved. The filter of the placement is ignored.
    pub fn slope(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (repeat, wrap) = (self.placement.repeat, self.placement.wrap);
        let (width, height) = (self.image.width(), self.image.height());
        let across = Stencil::new(wrap, u * repeat[0], width, false);
        let down = Stencil::new(wrap, v * repeat[1], height, true);
        let level = |column, row| self.image.texel(column, row).into_iter().map(f64::from).sum::<f64>() / 3.0;
        // Heights are relative to the middle texel, so that the slope of an even image is exactly 0.
        let middle = level(across.entries[1], down.entries[1]);
        let mut slope = [0.0; 2];
        for (j, row) in down.entries.into_iter().enumerate() {
            for (i, column) in across.entries.into_iter().enumerate() {
                let over = level(column, row) - middle;
                slope[0] += across.slopes[i] * down.weights[j] * over;
                slope[1] += across.weights[i] * down.slopes[j] * over;
            }
        }
        [slope[0] * repeat[0], slope[1] * repeat[1]]
    }
}

/// Returns which of two squares of a checkerboard lies at a place. `repeat` is the number of squares per unit, of which
/// the first begins at (0, 0).
pub(super) fn checker_cell(repeat: [f64; 2], uv: [f64; 2]) -> usize {
    let [x, y] = [0, 1].map(|i| (uv[i] * repeat[i]).floor().rem_euclid(2.0));
    usize::from(x != y)
}

/// The three texels along one axis that a place depends on.
struct Stencil {
    entries: [usize; 3],
    /// Weight of each texel in the height.
    weights: [f64; 3],
    /// Weight of each texel in the derivative by the coordinate.
    slopes: [f64; 3],
}

impl Stencil {
    /// Creates the stencil of a place, in units of the image. With `from_top`, entries count against the coordinate.
    fn new(wrap: Wrap, place: f64, count: usize, from_top: bool) -> Self {
        let inside = wrap.coordinate(place);
        let backward = wrap == Wrap::Mirror && (place - 2.0 * (0.5 * place).floor()) > 1.0;
        let along = if from_top { 1.0 - inside } else { inside } * count as f64;
        let middle = (along.floor() as usize).min(count - 1);
        let t = (along - middle as f64 - 0.5).clamp(-0.5, 0.5);
        let (before, behind) = (0.5 - t, 0.5 + t);
        let unit = if from_top == backward { count as f64 } else { -(count as f64) };
        Self {
            entries: [-1, 0, 1].map(|step| wrap.index(middle as isize + step, count)),
            weights: [0.5 * before * before, 0.75 - t * t, 0.5 * behind * behind],
            slopes: [-before * unit, -2.0 * t * unit, behind * unit],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rows of three texels, each with its own number.
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
    fn beyond_its_edges_an_image_continues_as_its_wrap_says() {
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
    fn a_linearly_filtered_image_is_continuous() {
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

    fn height_texture(width: usize, heights: Vec<f32>, wrap: Wrap, repeat: [f64; 2]) -> Texture {
        let image = Arc::new(Image::of_floats(width, 1, heights));
        Texture { image, placement: Placement { repeat, wrap, filter: TexelFilter::Linear } }
    }

    #[test]
    fn an_even_slope_is_exact_with_u_to_the_right_and_v_up() {
        // 8 x 4 texels rise by 1 per texel to the right and by 0.25 per row upward.
        let heights: Vec<f32> = (0..32_u8).map(|i| f32::from(i % 8) - 0.25 * f32::from(i / 8)).collect();
        for (wrap, uv, sign) in [
            (Wrap::Clamp, [0.4, 0.52], 1.0),
            (Wrap::Repeat, [2.37, -1.4], 1.0),
            (Wrap::Mirror, [1.6, -0.52], -1.0),
            (Wrap::Mirror, [-1.6, 2.52], 1.0),
        ] {
            let texture = height_texture(8, heights.clone(), wrap, [1.0, 1.0]);
            let [du, dv] = texture.slope(uv);
            assert!((du - 8.0 * sign).abs() < 1e-12 && (dv - sign).abs() < 1e-12, "{wrap:?} {uv:?}: {du} {dv}");
        }
        let [du, dv] = height_texture(8, heights.clone(), Wrap::Repeat, [3.0, 0.5]).slope([0.17, 1.04]);
        assert!((du - 24.0).abs() < 1e-12 && (dv - 0.5).abs() < 1e-12, "{du} {dv}");
    }

    #[test]
    fn slopes_are_those_of_one_surface_and_do_not_jump() {
        let heights: Vec<f32> = (0..35_u32).map(|i| ((i * 7919 + 13) % 101) as f32 / 101.0).collect();
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            let texture = height_texture(7, heights.clone(), wrap, [1.5, 1.0]);
            // Around a loop one comes back to the same height, and a way is as high as its mirror image is low.
            let mut last = texture.slope([-1.0, -1.0]);
            let mut around = 0.0;
            const STEPS: u32 = 40_000;
            let place = |i: u32| {
                let angle = std::f64::consts::TAU * f64::from(i) / f64::from(STEPS);
                [0.3 + 1.3 * libm::cos(angle), 0.2 + 1.1 * libm::sin(angle)]
            };
            for i in 0..STEPS {
                let ([a, b], [c, d]) = (place(i), place(i + 1));
                let [du, dv] = texture.slope([0.5 * (a + c), 0.5 * (b + d)]);
                around += du * (c - a) + dv * (d - b);
                // Per unit, the slope of heights up to 1 changes by at most 4 times the squared number of texels.
                let most = 4.0 * 10.5 * 10.5 * 3e-4;
                assert!(i == 0 || ((du - last[0]).abs() < most && (dv - last[1]).abs() < most), "{wrap:?} at {i}");
                last = [du, dv];
            }
            assert!(around.abs() < 1e-4, "{wrap:?}: {around}");
        }
    }

    #[test]
    fn every_place_has_a_finite_slope() {
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for heights in [vec![1.0], vec![0.0, 1.0], vec![0.0, 1.0, 2.0, 3.0]] {
                let texture = height_texture(1, heights, wrap, [1.0; 2]);
                for u in [-1e300, 1e300, -1e-300, 1e16, -5e-17, f64::MAX, 0.0, 1.0, -1.0, 0.5] {
                    let slope = texture.slope([u, -u]);
                    assert!(slope.iter().all(|x| x.abs() <= 16.0), "{wrap:?} at {u}: {slope:?}");
                }
            }
        }
    }
}
