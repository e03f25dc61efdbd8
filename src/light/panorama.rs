//! Light from all around as an image, sampled where it is bright.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rayon::prelude::*;

use crate::math::{DVec3, Distribution, Distribution2d};
use crate::spectrum::{Image, Wrap};

/// An image of all directions: latitude and longitude, +y on top, +z in the center, +x at the left quarter.
///
/// It is linear between the centers of its texels. Sampling draws a texel, by the exact solid angle of its row and by
/// how much its mean brightness exceeds that of the image, and then a direction evenly within it. What is dimmer is
/// found by bounces. Karlík, Šik, Vévoda, Skřivan & Křivánek 2019, *MIS Compensation: Optimizing Sampling Techniques in
/// Multiple Importance Sampling*.
#[derive(Clone, Debug)]
pub struct Panorama {
    pub(super) image: Arc<Image>,
    /// Mean brightness over all directions, where brightness is the mean of red, green and blue.
    pub(super) mean: f64,
    texels: Distribution2d,
    /// Cosine of the polar angle of the upper edge of each row, and of the lower edge of the last.
    edges: Vec<f64>,
    /// The brightest part, if it is much brighter than the rest.
    pub(super) bright_part: Option<BrightPart>,
}

/// The texels of an image far brighter than its mean, such as a sun or lamps, if they fill a small part of the sky.
#[derive(Clone, Debug)]
pub struct BrightPart {
    /// The brightness that all of them exceed.
    threshold: f64,
    texels: Vec<u32>,
    by_light: Distribution,
    /// Irradiance at normal incidence, in units of the image.
    pub(super) irradiance: f64,
    /// Solid angle in steradians.
    pub solid_angle: f64,
    /// Mean radiance with each direction weighted by its light, in units of the image.
    pub radiance: f64,
}

/// Least weight of a texel, relative to sampling by brightness alone. Texels dimmer than the mean are not left out,
/// because bounces do not find them everywhere.
const MIN_WEIGHT: f64 = 0.1;
/// Least brightness of a texel of the bright part, as a multiple of the mean.
const BRIGHT_OVER_MEAN: f64 = 8.0;
/// Columns wrap around. Beyond the top and bottom rows lie those rows again.
const EDGE_WRAP: [Wrap; 2] = [Wrap::Repeat, Wrap::Clamp];
/// The largest solid angle of the bright part, and the share of the light below which it is not treated apart.
const MAX_SOLID_ANGLE: f64 = 0.5;
const MIN_SHARE: f64 = 0.02;

impl BrightPart {
    /// Finds the bright part among texels of known brightness and solid angle; `None` if it sends too little of the
    /// light.
    fn new(levels: &[f64], mean: f64, solid_angle: impl Fn(u32) -> f64) -> Option<Self> {
        let level = |texel: u32| levels[texel as usize];
        let mut texels: Vec<u32> =
            (0..levels.len() as u32).filter(|&texel| level(texel) > BRIGHT_OVER_MEAN * mean).collect();
        let mut brightest_first = texels.clone();
        brightest_first.sort_by(|&a, &b| level(b).total_cmp(&level(a)));
        let mut covered = 0.0;
        let too_many = brightest_first.into_iter().find(|&texel| {
            covered += solid_angle(texel);
            covered > MAX_SOLID_ANGLE
        });
        let threshold = too_many.map_or(BRIGHT_OVER_MEAN * mean, level);
        texels.retain(|&texel| level(texel) > threshold);
        let [mut irradiance, mut squares, mut total_solid_angle] = [0.0; 3];
        for &texel in &texels {
            let (level, solid_angle) = (level(texel), solid_angle(texel));
            irradiance += level * solid_angle;
            squares += level * level * solid_angle;
            total_solid_angle += solid_angle;
        }
        if irradiance <= MIN_SHARE * 4.0 * PI * mean {
            return None;
        }
        let by_light = Distribution::new(texels.iter().map(|&texel| level(texel) * solid_angle(texel)));
        let radiance = squares / irradiance;
        Some(Self { threshold, texels, by_light, irradiance, solid_angle: total_solid_angle, radiance })
    }
}

impl Panorama {
    /// Creates the panorama of an image whose numbers are finite and not negative. With `few_bounces`, bounces find
    /// little of its light, so directions are drawn by brightness alone.
    pub fn new(image: Arc<Image>, few_bounces: bool) -> Self {
        let min_weight = if few_bounces { 1.0 } else { MIN_WEIGHT };
        let size @ [width, height] = [image.width(), image.height()];
        let edges: Vec<f64> = (0..=height).map(|row| libm::cos(PI * row as f64 / height as f64)).collect();
        let row_weight = |row: usize| edges[row] - edges[row + 1];
        let level = |texel: usize| brightness(&image, [texel % width, texel / width]);
        let levels: Vec<f64> = (0..width * height).into_par_iter().with_min_len(1024).map(level).collect();
        let rows = levels.chunks(width).enumerate();
        let total: f64 = rows.map(|(row, levels)| levels.iter().sum::<f64>() * row_weight(row)).sum();
        let mean = total / (2 * width) as f64;
        let weight = |[x, y]: [usize; 2]| {
            let level = levels[y * width + x];
            (level - mean).max(min_weight * level)
        };
        let texels = Distribution2d::new(size, weight, row_weight);
        let bright_part =
            BrightPart::new(&levels, mean, |texel| TAU / width as f64 * row_weight(texel as usize / width));
        Self { image, mean, texels, edges, bright_part }
    }

    /// Returns where a direction lies in the image, in texels from its upper left corner.
    fn texel_position(&self, direction: DVec3) -> [f64; 2] {
        let DVec3 { x, y, z } = direction;
        let u = 0.5 - libm::atan2(x, z) / TAU;
        // Taken from its tangent, the polar angle keeps its digits at the poles.
        let v = libm::atan2((x * x + z * z).sqrt(), y) / PI;
        [u * self.image.width() as f64, v * self.image.height() as f64]
    }

    /// Returns what is seen in a direction, in linear Rec.709.
    pub fn color(&self, direction: DVec3) -> [f32; 3] {
        self.image.bilinear(self.texel_position(direction), EDGE_WRAP)
    }

    /// Samples a direction that is not yet turned into the world, and returns it with its pdf per steradian.
    pub(super) fn sample(&self, u: [f64; 2]) -> (DVec3, f64) {
        let [column, row] = self.texels.sample(u);
        let texel = [column.index, row.index];
        (self.direction(texel, [column.u, row.u]), self.texel_pdf(texel))
    }

    /// Returns the direction at a place of a texel.
    fn direction(&self, [column, row]: [usize; 2], [u, v]: [f64; 2]) -> DVec3 {
        let (top, bottom) = (self.edges[row], self.edges[row + 1]);
        let y = top + v * (bottom - top);
        let angle = TAU * (0.5 - (column as f64 + u) / self.image.width() as f64);
        let radius = (1.0 - y * y).max(0.0).sqrt();
        let (sin, cos) = libm::sincos(angle);
        DVec3::new(radius * sin, y, radius * cos)
    }

    /// Returns whether a direction lies in the bright part.
    pub(super) fn is_bright(&self, direction: DVec3) -> bool {
        let level = || brightness(&self.image, self.texel_of(direction));
        self.bright_part.as_ref().is_some_and(|bright_part| level() > bright_part.threshold)
    }

    /// Samples a direction toward the bright part, and returns it with its pdf per steradian.
    pub(super) fn sample_bright(&self, [u, v]: [f64; 2]) -> Option<(DVec3, f64)> {
        let bright_part = self.bright_part.as_ref()?;
        let drawn = bright_part.by_light.sample(u);
        let (texel, width) = (bright_part.texels[drawn.index] as usize, self.image.width());
        let texel = [texel % width, texel / width];
        Some((self.direction(texel, [drawn.u, v]), brightness(&self.image, texel) / bright_part.irradiance))
    }

    /// Returns the pdf per steradian with which `sample` draws a direction.
    pub(super) fn pdf(&self, direction: DVec3) -> f64 {
        self.texel_pdf(self.texel_of(direction))
    }

    fn texel_pdf(&self, texel: [usize; 2]) -> f64 {
        self.texels.probability(texel) / self.solid_angle(texel[1])
    }

    /// Returns the solid angle of a texel in a row, in steradians.
    fn solid_angle(&self, row: usize) -> f64 {
        TAU / self.image.width() as f64 * (self.edges[row] - self.edges[row + 1])
    }

    /// Returns column and row of the texel that contains a direction.
    fn texel_of(&self, direction: DVec3) -> [usize; 2] {
        let [x, y] = self.texel_position(direction);
        [(x as usize).min(self.image.width() - 1), (y as usize).min(self.image.height() - 1)]
    }
}

/// Returns the mean over a texel of what it shows: it and its neighbors, weighted as by linear interpolation.
fn brightness(image: &Image, [column, row]: [usize; 2]) -> f64 {
    const SHARES: [f64; 3] = [0.125, 0.75, 0.125];
    let ([across, down], mut sum) = (EDGE_WRAP, 0.0);
    for (i, row_weight) in SHARES.iter().enumerate() {
        let row = down.index((row + i) as isize - 1, image.height());
        for (j, column_weight) in SHARES.iter().enumerate() {
            let texel = image.texel(across.index((column + j) as isize - 1, image.width()), row);
            sum += row_weight * column_weight * texel.iter().map(|&x| f64::from(x)).sum::<f64>() / 3.0;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panorama(width: usize, texels: &[[f32; 3]]) -> Panorama {
        Panorama::new(Arc::new(Image::of_floats(width, 3, texels.as_flattened().to_vec())), false)
    }

    fn grid(n: u32) -> impl Iterator<Item = [f64; 2]> {
        let at = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n).flat_map(move |i| (0..n).map(move |j| [at(i), at(j)]))
    }

    #[test]
    fn directions_lie_where_the_convention_says() {
        let panorama = panorama(4, &[[1.0; 3]; 8]);
        let near = |direction: DVec3, expected: [f64; 2]| {
            let [x, y] = panorama.texel_position(direction);
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

    /// The pdf matches the drawn directions: both its integral over solid angle, and each texel's share of the draws.
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

    /// Row L11 of the stability catalog.
    #[test]
    fn l11_the_bright_part_is_sampled_by_its_light_and_found_where_it_is() {
        let (width, height) = (24, 12);
        let of = |i: usize| if i == 17 || i == 100 { 900.0 } else { (i % 5) as f32 };
        let texels: Vec<[f32; 3]> = (0..width * height).map(|i| [of(i); 3]).collect();
        let panorama = panorama(width, &texels);
        let bright_part = panorama.bright_part.as_ref().expect("two texels are bright");
        let (mut irradiance, mut solid_angle) = (0.0, 0.0);
        for texel in (0..width * height).map(|i| [i % width, i / width]) {
            let here = panorama.solid_angle(texel[1]);
            if panorama.is_bright(panorama.direction(texel, [0.5, 0.5])) {
                irradiance += here * brightness(&panorama.image, texel);
                solid_angle += here;
            }
        }
        assert!((bright_part.irradiance / irradiance - 1.0).abs() < 1e-12, "{irradiance}");
        assert!((bright_part.solid_angle / solid_angle - 1.0).abs() < 1e-12 && solid_angle < MAX_SOLID_ANGLE);
        assert!(bright_part.radiance > 300.0 && bright_part.radiance < 900.0, "{}", bright_part.radiance);
        // Every draw stands for the same irradiance, except for variation within a texel. Rows are 15 degrees high
        // here: their mean is that of linear interpolation by solid angle, while that of the table is by latitude.
        let mut sum = 0.0;
        for u in grid(400) {
            let (direction, pdf) = panorama.sample_bright(u).expect("there is a bright part");
            assert!(panorama.is_bright(direction), "{direction}");
            sum += f64::from(panorama.color(direction)[0]) / pdf / 160_000.0;
        }
        assert!((sum / irradiance - 1.0).abs() < 0.02, "{sum} for {irradiance}");
        assert!(self::panorama(width, &vec![[1.0; 3]; width * height]).bright_part.is_none());
    }
}
