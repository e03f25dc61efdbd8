//! Light from all around as an image, drawn where it is bright.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::math::{DVec3, Distribution2d};
use crate::spectrum::Image;

/// An image of all directions: latitude and longitude, +y on top, +z in the center, +x at the left quarter.
///
/// Between the middles of its texels it is linear. Directions are drawn by texel, each by its mean brightness and the
/// exact solid angle of its row, and evenly within it.
#[derive(Clone, Debug)]
pub struct Panorama {
    image: Arc<Image>,
    texels: Distribution2d,
    /// Cosine of the angle from the top to the upper edge of each row, and to the lower edge of the last.
    edges: Vec<f64>,
}

impl Panorama {
    /// Of an image in which no number is negative or not finite.
    pub fn new(image: Arc<Image>) -> Self {
        let size @ [_, height] = [image.width(), image.height()];
        let edges: Vec<f64> = (0..=height).map(|row| libm::cos(PI * row as f64 / height as f64)).collect();
        let by_row = |row| edges[row] - edges[row + 1];
        let texels = Distribution2d::new(size, |place| brightness(&image, place), by_row);
        Self { image, texels, edges }
    }

    /// The image.
    pub fn image(&self) -> &Arc<Image> {
        &self.image
    }

    /// The mean of its brightness, a third of red, green and blue, over all directions.
    pub fn mean(&self) -> f64 {
        self.texels.total() / (2 * self.image.width()) as f64
    }

    /// Where a direction lies in the image, in texels from its upper left corner.
    fn place(&self, direction: DVec3) -> [f64; 2] {
        let DVec3 { x, y, z } = direction;
        let u = 0.5 - libm::atan2(x, z) / TAU;
        // The polar angle by its tangent keeps its digits at the poles.
        let v = libm::atan2((x * x + z * z).sqrt(), y) / PI;
        [u * self.image.width() as f64, v * self.image.height() as f64]
    }

    /// What is seen in a direction, linear Rec.709.
    pub fn color(&self, direction: DVec3) -> [f32; 3] {
        let [x, y] = self.place(direction).map(|x| x - 0.5);
        let (left, above) = (x.floor(), y.floor());
        let (right, below) = ((x - left) as f32, (y - above) as f32);
        let texel = |i: isize, j: isize| texel(&self.image, left as isize + i, above as isize + j);
        let [a, b, c, d] = [texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1)];
        std::array::from_fn(|i| {
            let (upper, lower) = (a[i] + right * (b[i] - a[i]), c[i] + right * (d[i] - c[i]));
            upper + below * (lower - upper)
        })
    }

    /// A direction for two random numbers, not turned into the world, and its density per steradian.
    pub(super) fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let [column, row] = self.texels.sample(u);
        let (top, bottom) = (self.edges[row.index], self.edges[row.index + 1]);
        let y = top + row.u * (bottom - top);
        let angle = TAU * (0.5 - (column.index as f64 + column.u) / self.image.width() as f64);
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(angle);
        (DVec3::new(radius * sin, y, radius * cos), self.density([column.index, row.index]))
    }

    /// Density per steradian with which `sample` draws a direction.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        self.density(self.texel_of(direction))
    }

    fn density(&self, texel: [usize; 2]) -> f64 {
        let solid_angle = TAU / self.image.width() as f64 * (self.edges[texel[1]] - self.edges[texel[1] + 1]);
        self.texels.probability(texel) / solid_angle
    }

    /// Column and row of the texel in which a direction lies.
    fn texel_of(&self, direction: DVec3) -> [usize; 2] {
        let [x, y] = self.place(direction);
        [(x as usize).min(self.image.width() - 1), (y as usize).min(self.image.height() - 1)]
    }
}

/// The mean over a texel of what is shown there: it and its neighbors, weighed as linear interpolation does.
fn brightness(image: &Image, [column, row]: [usize; 2]) -> f64 {
    const SHARES: [f64; 3] = [0.125, 0.75, 0.125];
    let mut sum = 0.0;
    for (i, by_row) in SHARES.iter().enumerate() {
        for (j, by_column) in SHARES.iter().enumerate() {
            let texel = texel(image, column as isize + j as isize - 1, row as isize + i as isize - 1);
            sum += by_row * by_column * texel.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
        }
    }
    sum
}

/// A texel; columns go around, and beyond the top and bottom row come those rows again.
fn texel(image: &Image, column: isize, row: isize) -> [f32; 3] {
    let column = column.rem_euclid(image.width() as isize) as usize;
    image.texel(column, row.clamp(0, image.height() as isize - 1) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panorama(width: usize, texels: &[[f32; 3]]) -> Panorama {
        Panorama::new(Arc::new(Image::of_floats(width, 3, texels.as_flattened().to_vec())))
    }

    fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
        let at = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n).flat_map(move |i| (0..n).map(move |j| [at(i), at(j)]))
    }

    #[test]
    fn directions_lie_where_the_convention_says() {
        let panorama = panorama(4, &[[1.0; 3]; 8]);
        let near = |direction: DVec3, expected: [f64; 2]| {
            let [x, y] = panorama.place(direction);
            assert!((x - expected[0]).abs() < 1e-12 && (y - expected[1]).abs() < 1e-12, "{direction}: {x} {y}");
        };
        near(DVec3::Z, [2.0, 1.0]);
        near(DVec3::X, [1.0, 1.0]);
        near(-DVec3::X, [3.0, 1.0]);
        near(DVec3::Y, [2.0, 0.0]);
    }

    /// Row G3 of the stability catalog.
    #[test]
    fn g3_every_sample_of_an_even_image_stands_for_the_whole_sphere() {
        let panorama = panorama(64, &[[1.0; 3]; 64 * 32]);
        for u in grid(200).chain([[0.0, 0.0], [1.0 - 1e-16, 1.0 - 1e-16], [0.5, 1e-18]]) {
            let (direction, pdf) = panorama.sample(u);
            let weight = f64::from(panorama.color(direction)[0]) / pdf;
            assert!((weight / (4.0 * PI) - 1.0).abs() < 1e-6, "{u:?}: {weight}");
        }
    }

    /// Row G2 of the stability catalog.
    #[test]
    fn g2_the_seam_and_the_poles_are_within_the_image() {
        let panorama = panorama(7, &(0..21_u8).map(|i| [f32::from(i) + 1.0; 3]).collect::<Vec<_>>());
        for tiny in [0.0, -0.0, 1e-300, -1e-300, 1e-17, -1e-17, 1e-8, -1e-8] {
            for direction in [DVec3::new(tiny, 0.0, -1.0), DVec3::new(tiny, 1.0, 0.0), DVec3::new(0.0, -1.0, tiny)] {
                assert!(panorama.pdf(direction) > 0.0 && panorama.color(direction)[0] >= 1.0, "{direction}");
            }
        }
    }

    /// The density is that of the drawn directions: sums over solid angle, and each texel's share of the draws.
    #[test]
    fn directions_follow_their_density() {
        let (width, height) = (12, 6);
        let texels: Vec<[f32; 3]> =
            (0..width * height).map(|i| if i == 17 { [90.0, 20.0, 5.0] } else { [(i % 5) as f32; 3] }).collect();
        let panorama = panorama(width, &texels);
        let mut total = 0.0;
        for at in 0..width * height {
            let (row, column) = (at / width, at % width);
            let (top, bottom) = (panorama.edges[row], panorama.edges[row + 1]);
            for [u, v] in grid(3) {
                let (y, angle) = (top + v * (bottom - top), TAU * (0.5 - (column as f64 + u) / width as f64));
                let radius = (1.0 - y * y).sqrt();
                let direction = DVec3::new(radius * libm::sin(angle), y, radius * libm::cos(angle));
                total += panorama.pdf(direction) * (top - bottom) * TAU / (9 * width) as f64;
            }
        }
        assert!((total - 1.0).abs() < 1e-12, "the density sums to {total}");
        // Draws on a fine grid fall into each texel as often as its probability says.
        let mut counts = vec![0_u32; width * height];
        for u in grid(1000) {
            let (direction, pdf) = panorama.sample(u);
            assert_eq!(pdf, panorama.pdf(direction), "{u:?}");
            let [column, row] = panorama.texel_of(direction);
            counts[row * width + column] += 1;
        }
        for (at, &count) in counts.iter().enumerate() {
            let expected = panorama.texels.probability([at % width, at / width]);
            assert!((f64::from(count) / 1e6 - expected).abs() < 1.5e-3, "texel {at}: {count} for {expected}");
        }
    }
}
