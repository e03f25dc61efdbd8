//! Estimates from a few photons what photons are worth; in XYZ, so that the result is the same in every color space.

use super::cost::photons_within;
use crate::light::LightId;
use crate::scene::FilmSettings;
use crate::spectrum::apply;
use crate::trace::image::for_each_splat;
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{RAYS_OF_A_LOOK, Smoothness, World};

/// What the photons of one light, or of several, contribute to the whole image.
#[derive(Clone, Debug, PartialEq)]
pub struct PhotonWorth {
    /// The lights that send them.
    pub lights: Vec<LightId>,
    /// How smooth the objects are that they are sent to.
    pub to: Smoothness,
    /// All light that they contribute, in XYZ, summed over all pixels.
    pub brings: [f64; 3],
    /// Variance of an image from n photons, summed over pixels and channels, times n.
    pub variance: f64,
    /// Rays traced per photon.
    pub rays: f64,
    /// What they show in the pixels of each cell of the format.
    pub(super) cells: Vec<CellStatistics>,
}

/// X + Y + Z in an average pixel of a cell: its mean, and its variance in an image from n photons, times n.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CellStatistics {
    pub(super) mean: f64,
    pub(super) variance: f64,
}

/// What camera samples contribute besides photons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleWorth {
    /// Variance of an image of n camera samples, summed over channels and pixels but the noisiest hundredth, times n.
    pub variance: f64,
    /// Rays traced per sample, without shadow rays.
    pub rays: f64,
}

/// Most photons of a group of lights in one image of a pilot, photons of all groups together, and number of images.
const MAX_GROUP_PHOTONS: u64 = 4096;
const MAX_PHOTONS: u64 = 4 * MAX_GROUP_PHOTONS;
const IMAGE_COUNT: u64 = 4;
/// Cells along each side of the format.
pub(super) const CELLS_PER_SIDE: u32 = 24;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x7069_6c6f;

/// Estimates what photons of each of the pass's lights are worth, for lights whose photons are seen. Photons to each
/// kind of smoothness are weighed separately; many lights are weighed in groups.
///
/// Uses the format, even when a crop or overscan is rendered, so that all parts are rendered the same way.
pub fn photons_worth(world: &World) -> Vec<PhotonWorth> {
    in_lanes!(&world.method.basis, N => measure_groups::<N>(world))
}

fn measure_groups<const N: usize>(whole: &World) -> Vec<PhotonWorth> {
    let mut world = whole.of_the_format();
    let Some(targets) = &whole.photon_targets else { return Vec::new() };
    let smooth = Smoothness::ALL.into_iter().filter(|&smooth| targets.has_smoothness(smooth));
    let lights = whole.photon_light_groups();
    let groups: Vec<_> = smooth.flat_map(|smooth| lights.iter().map(move |lights| (lights.clone(), smooth))).collect();
    let photons = (MAX_PHOTONS / groups.len().max(1) as u64).min(MAX_GROUP_PHOTONS);
    let affordable = photons_within(&world, RAYS_OF_A_LOOK as f64 / (IMAGE_COUNT * groups.len().max(1) as u64) as f64);
    let photons = photons.min(affordable);
    groups.into_iter().filter_map(|(lights, to)| measure_group::<N>(whole, &mut world, lights, to, photons)).collect()
}

/// Weighs about `each` photons of some lights to objects of one smoothness. Replaces the targets and seed of `world`.
fn measure_group<const N: usize>(
    whole: &World,
    world: &mut World,
    lights: Vec<LightId>,
    to: Smoothness,
    each: u64,
) -> Option<PhotonWorth> {
    let mut group_targets = whole.photon_targets.clone()?.only(&lights, to);
    let total = group_targets.photons();
    for target in &mut group_targets.targets {
        target.photons = (target.photons as f64 * each as f64 / total as f64).round().max(1.0) as u64;
    }
    world.photon_targets = Some(group_targets);
    let to_xyz = world.scene.film.color_space.to_xyz();
    let (mut values, mut photons, mut rays) = (Vec::new(), 0, 0);
    for image in 0..IMAGE_COUNT {
        world.method.seed = (whole.method.seed ^ SEED).wrapping_add(image);
        let mut splats = Vec::new();
        let sent = for_each_splat::<N, Polarized>(world, &mut |pixel, splat| splats.push((pixel, splat.rgb)));
        (photons, rays) = (photons + sent.photons, rays + sent.stats.rays);
        values.extend(sum_by_pixel(splats).into_iter().map(|(pixel, rgb)| {
            let [x, y, z] = apply(&to_xyz, rgb);
            (pixel, [x, y, z, x + y + z])
        }));
    }
    let images = IMAGE_COUNT as f64;
    let each = photons as f64 / images;
    let squares = values.iter().map(|&(pixel, light)| (pixel, light.map(|x| x * x))).collect();
    let (sums, squares) = (sum_by_pixel(values), sum_by_pixel(squares));
    let scaled_variance = |sum: f64, squares: f64| ((squares - sum * sum / images) / (images - 1.0)).max(0.0) * each;
    let film = world.scene.film;
    let sizes = cell_sizes(film);
    let (mut brings, mut variance, mut cells) = ([0.0; 3], 0.0, vec![CellStatistics::default(); sizes.len()]);
    for ((pixel, sums), (_, squares)) in sums.iter().zip(&squares) {
        let variances: [f64; 4] = std::array::from_fn(|i| scaled_variance(sums[i], squares[i]));
        (0..3).for_each(|i| brings[i] += sums[i] / images);
        variance += variances[..3].iter().sum::<f64>();
        let cell = film.whole().cell_of(CELLS_PER_SIDE, [pixel % film.width, pixel / film.width]);
        cells[cell].mean += sums[3] / (images * sizes[cell]);
        cells[cell].variance += variances[3] / sizes[cell];
    }
    let worth = PhotonWorth { lights, to, brings, variance, rays: rays as f64 / photons as f64, cells };
    brings.iter().any(|&x| x != 0.0).then_some(worth)
}

fn cell_sizes(film: FilmSettings) -> Vec<f64> {
    let cell_lengths = |size: u32| {
        // The first pixel of a cell, defined even where a cell has none.
        let first = move |cell: u32| (u64::from(cell) * u64::from(size)).div_ceil(u64::from(CELLS_PER_SIDE));
        (0..CELLS_PER_SIDE).map(move |cell| (first(cell + 1) - first(cell)) as f64)
    };
    cell_lengths(film.height).flat_map(|rows| cell_lengths(film.width).map(move |columns| rows * columns)).collect()
}

/// Sums the values of each pixel that has any. The result is never longer than the list of values.
fn sum_by_pixel<const COUNT: usize>(mut values: Vec<(u32, [f64; COUNT])>) -> Vec<(u32, [f64; COUNT])> {
    values.sort_by_key(|value| value.0);
    values.dedup_by(|next, sum| {
        let same = next.0 == sum.0;
        if same {
            (0..COUNT).for_each(|i| sum.1[i] += next.1[i]);
        }
        same
    });
    values
}

/// Returns the mean of some values and the variance of one, 0 where there are too few to tell.
pub(super) fn mean_and_variance(values: impl ExactSizeIterator<Item = f64> + Clone) -> [f64; 2] {
    let count = values.len();
    let mean = values.clone().sum::<f64>() / count.max(1) as f64;
    let squares = values.map(|x| (x - mean) * (x - mean));
    [mean, squares.sum::<f64>() / (count.max(2) - 1) as f64]
}

impl SampleWorth {
    /// Combines the variances of single samples, summed over channels, in some of an image's pixels.
    pub fn of(mut variances: Vec<f64>, pixels: f64, rays: f64) -> Self {
        variances.sort_by(f64::total_cmp);
        let kept = variances.len() - variances.len().div_ceil(100);
        // Of n samples, each pixel has n / pixels.
        let variance = variances[..kept].iter().sum::<f64>() / variances.len() as f64 * pixels * pixels;
        Self { variance, rays }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_value_is_its_own_mean_and_has_no_variance() {
        let of = |values: &[f64]| mean_and_variance(values.iter().copied());
        assert_eq!([of(&[]), of(&[3.0]), of(&[3.0, 5.0])], [[0.0, 0.0], [3.0, 0.0], [4.0, 2.0]]);
    }
}
