//! Learns which of two ways to render a scene takes less time to the same error, from a few thousand samples of each.
//!
//! An image of n_p camera samples, and n_i photons of each light i that it sees, has the variance A / n_p + sum B_i /
//! n_i and takes the time C_p n_p + sum C_i n_i. Their product is least for n_i / n_p = sqrt(B_i C_p / (A C_i)), where
//! it is (sqrt(A C_p) + sum sqrt(B_i C_i))^2. Rays stand for time, so that the answer is the same on every machine.

use super::cost::with_few_photons;
use super::pilot::{CELLS_PER_SIDE, PhotonWorth, mean_and_variance};
use crate::math::Sampler;
use crate::spectrum::apply;
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::photon::{LightVertices, PhotonMap, pilot_vertices};
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{RAYS_OF_A_LOOK, World};

/// Samples of the pixel in the middle of each cell of the format.
const SAMPLES_PER_PIXEL: u32 = 8;
/// Cost of looking at light vertices from one surface, in rays of a path with all that belongs to them.
pub(super) const RESAMPLING_COST: f64 = 0.6;
/// Share of the squared mean that is added to the square of a pixel: errors in darker pixels are hardly seen.
pub(super) const DARK_OFFSET: f64 = 0.1;
/// A smaller gain counts as none: a pilot is not more precise, and a photon map may come with photons.
const MIN_GAIN: f64 = 1.25;
/// A way may take this many times as long to the error of the whole, and still be better for its error in each pixel.
const MAX_SLOWDOWN: f64 = 1.1;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x7265_7361;

/// Measures the noise of up to a few thousand camera samples all over the image, with few photons, and with light
/// vertices if the method has them. Uses the whole image even when only a part of it is rendered.
pub fn pilot_noise(world: &World) -> PilotNoise {
    in_lanes!(&world.method.basis, N => {
        let vertices = pilot_vertices::<N>(world);
        let (few, photons) = with_few_photons::<N, Polarized>(world);
        let map_rays = photons.as_ref().zip(world.method.map()).map_or(0.0, |(photons, map)| {
            photons.stats.rays as f64 / photons.sent as f64 * map.photons as f64 * f64::from(map.count)
        });
        let noise = measure_noise(&few, photons.as_ref(), vertices.as_ref());
        PilotNoise { rays: noise.rays + map_rays / world.samples_of_the_format(), ..noise }
    })
}

/// For some samples of a pixel: the mean of X + Y + Z, the variance of one, and the pixel's cell of the format.
#[derive(Clone, Copy, Debug)]
struct PixelNoise {
    mean: f64,
    variance: f64,
    cell: usize,
}

/// The work to reach an error, or the ratio of the work of two ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// For an error of each pixel, relative to its brightness.
    pub of_pixels: f64,
    /// For an error of the whole image, where the method judges it.
    pub of_whole: Option<f64>,
}

impl Effort {
    /// Returns the value that decides. Where the error of the whole is judged, both count: that error arises mostly
    /// where the image is bright, and the image is looked at as well.
    pub fn judged(self) -> f64 {
        self.of_whole.map_or(self.of_pixels, |of_whole| (of_whole * self.of_pixels).sqrt())
    }

    /// Whether this ratio of one way to another shows that the other is clearly better: well over 1, and hardly less
    /// than 1 to the error of the whole.
    pub fn is_clear(self) -> bool {
        self.judged() > MIN_GAIN && self.of_whole.is_none_or(|of_whole| of_whole * MAX_SLOWDOWN > 1.0)
    }

    /// Whether the two ways take the same work, up to a share of `but`.
    pub fn is_equal(self, but: f64) -> bool {
        [Some(self.of_pixels), self.of_whole].into_iter().flatten().all(|times| (times - 1.0).abs() <= but)
    }

    /// Returns the ratio with the two ways exchanged.
    #[must_use]
    pub fn inverse(self) -> Self {
        Self { of_pixels: self.of_pixels.recip(), of_whole: self.of_whole.map(f64::recip) }
    }

    /// Returns the ratio of this work to another.
    #[must_use]
    pub fn over(self, other: Self) -> Self {
        let of_whole = self.of_whole.zip(other.of_whole).map(|(own, other)| own / other);
        Self { of_pixels: self.of_pixels / other.of_pixels, of_whole }
    }
}

/// The noise of sampled pixels all over the image.
#[derive(Clone, Debug)]
pub struct PilotNoise {
    pixels: Vec<PixelNoise>,
    judges_whole: bool,
    /// Number of pixels of the format.
    format_pixels: f64,
    /// Rays per sample, including its part of those of gathered photons.
    rays: f64,
}

/// Variances, averaged over the pixels, times the rays they take: of a camera sample, and of a photon of each light.
struct Work {
    samples: f64,
    photons: Vec<f64>,
}

fn measure_noise<const N: usize>(
    world: &World,
    photons: Option<&PhotonMap<N>>,
    vertices: Option<&LightVertices<N>>,
) -> PilotNoise {
    let mut tracer = PathTracer::<N>::new(world).with_photons(photons);
    tracer.light_vertices = vertices;
    let film = world.scene.film;
    let to_xyz = film.color_space.to_xyz();
    let mut pixels = Vec::new();
    for [x, y] in film.whole().middles_of_cells(CELLS_PER_SIDE) {
        let values = (0..SAMPLES_PER_PIXEL).map(|number| {
            let sampler = Sampler::of_pixel(world.method.seed ^ SEED, [x, y], number);
            apply(&to_xyz, take_sample(&mut tracer, &sampler, [x, y]).rgb).iter().sum::<f64>()
        });
        let values: Vec<f64> = values.filter(|light| light.is_finite()).collect();
        let [mean, variance] = mean_and_variance(values.iter().copied());
        pixels.push(PixelNoise {
            mean,
            variance,
            cell: film.whole().cell_of(CELLS_PER_SIDE, [x, y].map(|place| place as u32)),
        });
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    let stats = tracer.walker.stats;
    let rays = stats.rays as f64 + RESAMPLING_COST * stats.resampled as f64;
    let format_pixels = film.whole().pixels() as f64;
    let rays = rays / (pixels.len() as f64 * f64::from(SAMPLES_PER_PIXEL));
    PilotNoise { pixels, judges_whole: world.method.judges_the_whole(), format_pixels, rays }
}

impl PilotNoise {
    /// Returns how many times as long other samples take to the same error, both with their best photons. Returns
    /// `None` without noise.
    pub fn gain_over(&self, others: &Self, photons: &[PhotonWorth]) -> Option<Effort> {
        let mean = others.mean(photons);
        let least_effort = |noise: &Self| noise.effort(photons, photons.len(), |_| 0.0, mean);
        let gain = least_effort(others).over(least_effort(self));
        gain.judged().is_finite().then_some(gain)
    }

    /// Returns the least product of time and variance where only the first `sent` photons are sent. Camera samples find
    /// the light of the others by chance, in spikes, whose second moment is `spikes` times the mean of these photons.
    pub fn least_work(&self, photons: &[PhotonWorth], spikes: &[f64], sent: usize) -> Effort {
        let unsent = || photons.iter().zip(spikes).skip(sent);
        if unsent().any(|(_, spike)| spike.is_infinite()) {
            return Effort { of_pixels: f64::INFINITY, of_whole: self.judges_whole.then_some(f64::INFINITY) };
        }
        let by_chance =
            |pixel: &PixelNoise| unsent().map(|(photons, spike)| spike * photons.cells[pixel.cell].mean).sum();
        self.effort(photons, sent, by_chance, self.mean(photons))
    }

    /// Returns the least product of time and variance where the first `sent` photons are sent, given the image's mean.
    ///
    /// Errors of pixels leave out the hundredth of them in which samples vary most: no photon improves that.
    fn effort(&self, photons: &[PhotonWorth], sent: usize, chance: impl Fn(&PixelNoise) -> f64, mean: f64) -> Effort {
        let per_pixel = |pixel: &PixelNoise| pixel.mean_with(photons).powi(2) + DARK_OFFSET * mean * mean;
        let of_whole = |_: &PixelNoise| mean * mean;
        let photons = &photons[..sent];
        Effort {
            of_pixels: self.work(photons, &chance, per_pixel, self.outlier_count()).least_product(),
            of_whole: self.judges_whole.then(|| self.work(photons, &chance, of_whole, 0).least_product()),
        }
    }

    /// Returns the number of photons per sample that takes the least time to an error. Variances are never relative:
    /// otherwise, what photons show, which is bright, would be noisier than its surroundings.
    pub fn photons_per_sample(&self, photons: &[PhotonWorth]) -> f64 {
        let work_without = |left_out: usize| self.work(photons, |_| 0.0, |_| 1.0, left_out);
        let work = work_without(self.outlier_count());
        let samples = if self.judges_whole { (work.samples * work_without(0).samples).sqrt() } else { work.samples };
        let per_light = |(photons, photon_work): (&PhotonWorth, &f64)| {
            let times = (photon_work / samples).sqrt() * self.rays / photons.rays;
            if times.is_nan() { 0.0 } else { times }
        };
        photons.iter().zip(&work.photons).map(per_light).sum()
    }

    /// The number of pixels that are left out, a hundredth of all.
    fn outlier_count(&self) -> usize {
        self.pixels.len().div_ceil(100)
    }

    /// Returns the mean of the pixels, including what photons show.
    fn mean(&self, photons: &[PhotonWorth]) -> f64 {
        self.pixels.iter().map(|pixel| pixel.mean_with(photons)).sum::<f64>() / self.pixels.len() as f64
    }

    /// Sums up variances relative to the squares of pixels, those of samples including what they find by chance. Leaves
    /// out the `left_out` pixels in which samples vary most, but only from the variance of samples.
    fn work(
        &self,
        photons: &[PhotonWorth],
        by_chance: impl Fn(&PixelNoise) -> f64,
        squares: impl Fn(&PixelNoise) -> f64,
        left_out: usize,
    ) -> Work {
        let per_pixel =
            |pixel: &PixelNoise| [pixel.variance, by_chance(pixel)].map(|variance| variance / squares(pixel));
        let mut variances: Vec<[f64; 2]> = self.pixels.iter().map(per_pixel).collect();
        variances.sort_by(|[a, _], [b, _]| a.total_cmp(b));
        let kept = variances.len() - left_out;
        // Of n samples, each pixel gets n divided by the number of pixels.
        let count = variances.len() as f64;
        let samples = variances[..kept].as_flattened().iter().sum::<f64>() / count * self.rays * self.format_pixels;
        let per_light = |photons: &PhotonWorth| {
            let per_pixel = |pixel: &PixelNoise| photons.cells[pixel.cell].variance / squares(pixel);
            self.pixels.iter().map(per_pixel).sum::<f64>() / count * photons.rays
        };
        Work { samples, photons: photons.iter().map(per_light).collect() }
    }
}

impl Work {
    /// Returns the least product of time and variance.
    fn least_product(&self) -> f64 {
        let photon_work: f64 = self.photons.iter().map(|per_light| per_light.sqrt()).sum();
        (self.samples.sqrt() + photon_work).powi(2)
    }
}

impl PixelNoise {
    /// Returns its mean, including what photons show.
    fn mean_with(&self, photons: &[PhotonWorth]) -> f64 {
        self.mean + photons.iter().map(|photons| photons.cells[self.cell].mean).sum::<f64>()
    }
}
