//! Which of two ways to render a scene takes less time to an equal error, learned from some thousand camera samples of
//! each.
//!
//! An image of n_p camera samples, and n_i photons of light i that it sees, has the variance A / n_p + sum B_i / n_i in
//! the time C_p n_p + sum C_i n_i; their product is least for n_i / n_p = sqrt(B_i C_p / (A C_i)), where it is (sqrt(A
//! C_p) + sum sqrt(B_i C_i))^2. Rays followed stand for time, so that the answer is the same everywhere.

use super::cost::few_photons;
use super::pilot::{PhotonWorth, SIDE, mean_and_variance};
use crate::math::Sampler;
use crate::spectrum::apply;
use crate::trace::camera::PathTracer;
use crate::trace::photon::{LightVertices, PhotonMap, few_vertices};
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{RAYS_OF_A_LOOK, World};

/// Samples of a pixel in the middle of each cell of the format.
const SAMPLES: u32 = 8;
/// The vertices that a path looks at take as long as so many rays of the path with all that belongs to them.
pub(super) const LOOKING: f64 = 0.6;
/// Darker pixels than this share of the squared mean count as if they were as bright: errors in them are hardly seen.
pub(super) const DARK: f64 = 0.1;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x7265_7361;

/// The noise of up to some thousand camera samples all over the image, with few photons, and with light vertices if the
/// method asks for them. All of the image counts, also where only a part of it is made.
pub fn pilot_noise(world: &World) -> PilotNoise {
    in_lanes!(&world.method.basis, N => {
        let vertices = few_vertices::<N>(world);
        let (few, photons) = few_photons::<N, Polarized>(world);
        let of_map = photons.as_ref().zip(world.method.map()).map_or(0.0, |(photons, map)| {
            photons.stats.rays as f64 / photons.sent as f64 * map.photons as f64 * f64::from(map.count)
        });
        let noise = weigh(&few, photons.as_ref(), vertices.as_ref());
        PilotNoise { rays: noise.rays + of_map / world.samples_of_the_format(), ..noise }
    })
}

/// What some samples of a pixel are: the mean of X + Y + Z, and the variance of one. The cell of the format in which it
/// lies.
struct Pixel {
    mean: f64,
    variance: f64,
    cell: usize,
}

/// What samples of pixels all over the image are.
pub struct PilotNoise {
    pixels: Vec<Pixel>,
    /// Pixels of the format.
    format: f64,
    /// Rays of one sample, and its part of those of photons that are gathered.
    rays: f64,
}

/// Variances in the mean of the pixels, times the rays that they take: of a camera sample, and of a photon of each
/// light.
struct Work {
    samples: f64,
    photons: Vec<f64>,
}

fn weigh<const N: usize>(
    world: &World,
    photons: Option<&PhotonMap<N>>,
    vertices: Option<&LightVertices<N>>,
) -> PilotNoise {
    let mut tracer = PathTracer::<N>::new(world).with_photons(photons);
    tracer.light_vertices = vertices;
    let film = world.scene.film;
    let to_xyz = film.color_space.to_xyz();
    let mut pixels = Vec::new();
    for [x, y] in film.whole().middles_of_cells(SIDE) {
        let taken = (0..SAMPLES).map(|number| {
            let sampler = Sampler::of_pixel(world.method.seed ^ SEED, [x, y], number);
            apply(&to_xyz, tracer.sample(&sampler, [x, y]).rgb).iter().sum::<f64>()
        });
        let taken: Vec<f64> = taken.filter(|light| light.is_finite()).collect();
        let [mean, variance] = mean_and_variance(taken.iter().copied());
        pixels.push(Pixel { mean, variance, cell: film.whole().cell_of(SIDE, [x, y].map(|place| place as u32)) });
        if tracer.walker.stats.rays > RAYS_OF_A_LOOK {
            break;
        }
    }
    let stats = tracer.walker.stats;
    let rays = stats.rays as f64 + LOOKING * stats.resampled as f64;
    let format = film.whole().pixels() as f64;
    PilotNoise { format, rays: rays / (pixels.len() as f64 * f64::from(SAMPLES)), pixels }
}

impl PilotNoise {
    /// How many times as long an equal error takes with other samples, both beside as many photons as are best for
    /// them; none where there is no noise. Variances are relative to the squares of the means.
    pub fn gain_over(&self, others: &Self, photons: &[PhotonWorth]) -> Option<f64> {
        let mean = others.mean(photons);
        let least = |noise: &Self| noise.work(photons, |_| 0.0, |pixel| pixel.square(photons, mean)).least();
        let gain = least(others) / least(self);
        gain.is_finite().then_some(gain)
    }

    /// The least product of time and variance where the first few of some photons are sent, and light of the others is
    /// left to chance. A camera sample finds little of it, as spikes: of what photons bring, the second moment is so
    /// many times the mean. Variances are relative to the squares of the means.
    pub fn least_work(&self, photons: &[PhotonWorth], spikes: &[f64], sent: usize) -> f64 {
        let left = || photons.iter().zip(spikes).skip(sent);
        if left().any(|(_, spike)| spike.is_infinite()) {
            return f64::INFINITY;
        }
        let mean = self.mean(photons);
        let by_chance = |pixel: &Pixel| left().map(|(photons, spike)| spike * photons.cells[pixel.cell].mean).sum();
        self.work(&photons[..sent], by_chance, |pixel| pixel.square(photons, mean)).least()
    }

    /// How many photons for each of the samples make the time to an error least. Variances are not relative: else what
    /// photons show, which is bright, would be noisier than all around it.
    pub fn photons_of_a_sample(&self, photons: &[PhotonWorth]) -> f64 {
        let work = self.work(photons, |_| 0.0, |_| 1.0);
        let of_light = |(photons, of_photons): (&PhotonWorth, &f64)| {
            let times = (of_photons / work.samples).sqrt() * self.rays / photons.rays;
            if times.is_nan() { 0.0 } else { times }
        };
        photons.iter().zip(&work.photons).map(of_light).sum()
    }

    /// The mean of the pixels with what photons show.
    fn mean(&self, photons: &[PhotonWorth]) -> f64 {
        self.pixels.iter().map(|pixel| pixel.seen(photons)).sum::<f64>() / self.pixels.len() as f64
    }

    /// Variances over squares of pixels, with what is found by chance in those of samples. The hundredth of the pixels
    /// in which samples vary most beside photons is left out of theirs: no photon mends it.
    fn work(
        &self,
        photons: &[PhotonWorth],
        by_chance: impl Fn(&Pixel) -> f64,
        squares: impl Fn(&Pixel) -> f64,
    ) -> Work {
        let of_pixel = |pixel: &Pixel| [pixel.variance, by_chance(pixel)].map(|variance| variance / squares(pixel));
        let mut of_samples: Vec<[f64; 2]> = self.pixels.iter().map(of_pixel).collect();
        of_samples.sort_by(|[a, _], [b, _]| a.total_cmp(b));
        let most = of_samples.len() - of_samples.len().div_ceil(100);
        // Of n samples, each pixel has as many times fewer as there are pixels.
        let count = of_samples.len() as f64;
        let samples = of_samples[..most].as_flattened().iter().sum::<f64>() / count * self.rays * self.format;
        let of_light = |photons: &PhotonWorth| {
            let of_pixel = |pixel: &Pixel| photons.cells[pixel.cell].variance / squares(pixel);
            self.pixels.iter().map(of_pixel).sum::<f64>() / count * photons.rays
        };
        Work { samples, photons: photons.iter().map(of_light).collect() }
    }
}

impl Work {
    /// The least product of time and variance.
    fn least(&self) -> f64 {
        let of_photons: f64 = self.photons.iter().map(|of_light| of_light.sqrt()).sum();
        (self.samples.sqrt() + of_photons).powi(2)
    }
}

impl Pixel {
    /// What variances are relative to, in an image of such a mean.
    fn square(&self, photons: &[PhotonWorth], mean: f64) -> f64 {
        self.seen(photons).powi(2) + DARK * mean * mean
    }

    /// Its mean with what photons show.
    fn seen(&self, photons: &[PhotonWorth]) -> f64 {
        self.mean + photons.iter().map(|photons| photons.cells[self.cell].mean).sum::<f64>()
    }
}
