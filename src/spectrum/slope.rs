//! How steep an image is that stands for heights.

use super::{Texture, Wrap};

impl Texture {
    /// The derivatives by u and v of the image as heights, those of colors being their means.
    ///
    /// Between texels the heights are a quadratic B-spline (de Boor 1978, *A Practical Guide to Splines*): a mean over the
    /// three by three texels around, whose slope passes evenly from one to the next where that of linear interpolation
    /// would show each texel as a facet. An even slope stays what it is. The filter of the placement is not asked.
    pub fn slope(&self, [u, v]: [f64; 2]) -> [f64; 2] {
        let (repeat, wrap) = (self.placement.repeat, self.placement.wrap);
        let (width, height) = (self.image.width(), self.image.height());
        let across = Stencil::new(wrap, u * repeat[0], width, false);
        let down = Stencil::new(wrap, v * repeat[1], height, true);
        let level = |column, row| self.image.texel(column, row).into_iter().map(f64::from).sum::<f64>() / 3.0;
        // Heights count from the middle one, so that the slope of an even image is exactly 0.
        let middle = level(across.entries[1], down.entries[1]);
        let mut slope = [0.0; 2];
        for (j, row) in down.entries.into_iter().enumerate() {
            for (i, column) in across.entries.into_iter().enumerate() {
                let over = level(column, row) - middle;
                slope[0] += across.slopes[i] * down.shares[j] * over;
                slope[1] += across.shares[i] * down.slopes[j] * over;
            }
        }
        [slope[0] * repeat[0], slope[1] * repeat[1]]
    }
}

/// The three texels along one axis that a place sees.
struct Stencil {
    entries: [usize; 3],
    /// What each adds to the height.
    shares: [f64; 3],
    /// What each adds to the derivative by the coordinate.
    slopes: [f64; 3],
}

impl Stencil {
    /// At a place in units of the image; `from_top`: entries count against the coordinate.
    fn new(wrap: Wrap, place: f64, count: usize, from_top: bool) -> Self {
        let inside = wrap.place(place);
        let backward = wrap == Wrap::Mirror && (place - 2.0 * (0.5 * place).floor()) > 1.0;
        let along = if from_top { 1.0 - inside } else { inside } * count as f64;
        let middle = (along.floor() as usize).min(count - 1);
        let t = (along - middle as f64 - 0.5).clamp(-0.5, 0.5);
        let (before, behind) = (0.5 - t, 0.5 + t);
        let unit = if from_top == backward { count as f64 } else { -(count as f64) };
        Self {
            entries: [-1, 0, 1].map(|step| wrap.entry(middle as isize + step, count)),
            shares: [0.5 * before * before, 0.75 - t * t, 0.5 * behind * behind],
            slopes: [-before * unit, -2.0 * t * unit, behind * unit],
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::spectrum::{Image, Placement, TexelFilter};

    fn texture(width: usize, heights: Vec<f32>, wrap: Wrap, repeat: [f64; 2]) -> Texture {
        let image = Arc::new(Image::of_floats(width, 1, heights));
        Texture { image, placement: Placement { repeat, wrap, filter: TexelFilter::Linear } }
    }

    #[test]
    fn an_even_slope_is_found_as_it_is_u_to_the_right_and_v_up() {
        // 8 x 4 texels rise by 1 a texel to the right and by 0.25 a row upward.
        let heights: Vec<f32> = (0..32_u8).map(|i| f32::from(i % 8) - 0.25 * f32::from(i / 8)).collect();
        for (wrap, uv, sign) in [
            (Wrap::Clamp, [0.4, 0.52], 1.0),
            (Wrap::Repeat, [2.37, -1.4], 1.0),
            (Wrap::Mirror, [1.6, -0.52], -1.0),
            (Wrap::Mirror, [-1.6, 2.52], 1.0),
        ] {
            let texture = texture(8, heights.clone(), wrap, [1.0, 1.0]);
            let [du, dv] = texture.slope(uv);
            assert!((du - 8.0 * sign).abs() < 1e-12 && (dv - sign).abs() < 1e-12, "{wrap:?} {uv:?}: {du} {dv}");
        }
        let [du, dv] = texture(8, heights.clone(), Wrap::Repeat, [3.0, 0.5]).slope([0.17, 1.04]);
        assert!((du - 24.0).abs() < 1e-12 && (dv - 0.5).abs() < 1e-12, "{du} {dv}");
    }

    #[test]
    fn slopes_are_those_of_one_surface_and_do_not_jump() {
        let heights: Vec<f32> = (0..35_u32).map(|i| ((i * 7919 + 13) % 101) as f32 / 101.0).collect();
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            let texture = texture(7, heights.clone(), wrap, [1.5, 1.0]);
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
                // A slope changes by at most 4 texel steps squared of heights up to 1 a unit.
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
                let texture = texture(1, heights, wrap, [1.0; 2]);
                for u in [-1e300, 1e300, -1e-300, 1e16, -5e-17, f64::MAX, 0.0, 1.0, -1.0, 0.5] {
                    let slope = texture.slope([u, -u]);
                    assert!(slope.iter().all(|x| x.abs() <= 16.0), "{wrap:?} at {u}: {slope:?}");
                }
            }
        }
    }
}
