//! Which of two ways to render a scene takes less time to an equal error, learned from some thousand camera samples of
//! each.

use super::cost::few_photons;
use crate::math::Sampler;
use crate::spectrum::apply;
use crate::trace::World;
use crate::trace::camera::PathTracer;
use crate::trace::photon::{LightPaths, LightVertices, PhotonMap};
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;

/// Pixels along each side of the image whose samples are compared, and how many of each.
const SIDE: u32 = 24;
const SAMPLES: u32 = 8;
/// The vertices that a path looks at take as long as so many rays of the path with all that belongs to them.
pub(super) const LOOKING: f64 = 0.6;
/// Darker pixels than this share of the squared mean count as if they were as bright: errors in them are hardly seen.
pub(super) const DARK: f64 = 0.1;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x7265_7361;

/// The noise of some thousand camera samples all over the image, with few photons, and with light vertices if the
/// method asks for them. All of the image counts, also where only a part of it is made.
pub fn pilot_noise(world: &World) -> PilotNoise {
    in_lanes!(&world.method.basis, N => {
        let vertices = LightPaths::new(world, world.method.seed).map(|light_paths| light_paths.few::<N>());
        let (few, photons) = few_photons::<N, Polarized>(world);
        weigh(&few, photons.as_ref(), vertices.as_ref())
    })
}

/// What some samples of a pixel are: the mean of X + Y + Z, and the variance.
struct Pixel {
    mean: f64,
    variance: f64,
}

/// What samples of pixels all over the image are.
pub struct PilotNoise {
    pixels: Vec<Pixel>,
    rays: f64,
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
    let pixel = |place: u32| {
        let [x, y] = film.whole().middle_of_cell(SIDE, place);
        let taken = (0..SAMPLES).map(|number| {
            let sampler = Sampler::of_pixel(world.method.seed ^ SEED, [x, y], number);
            apply(&to_xyz, tracer.sample(&sampler, [x, y]).rgb).iter().sum::<f64>()
        });
        let taken: Vec<f64> = taken.filter(|light| light.is_finite()).collect();
        let count = taken.len().max(2) as f64;
        let mean = taken.iter().sum::<f64>() / count;
        let squares = taken.iter().map(|light| (light - mean) * (light - mean));
        Pixel { mean, variance: squares.sum::<f64>() / (count - 1.0) }
    };
    let pixels = (0..SIDE * SIDE).map(pixel).collect();
    let stats = tracer.walker.stats;
    PilotNoise { pixels, rays: stats.rays as f64 + LOOKING * stats.resampled as f64 }
}

impl PilotNoise {
    /// How many times as long an equal error takes with other samples; none where there is no noise.
    ///
    /// Variances are relative to the squares of the means, and those of the hundredth of the pixels that has most are
    /// left out. Rays followed stand for time, so that the answer is the same everywhere.
    pub fn gain_over(&self, others: &Self) -> Option<f64> {
        let mean = others.pixels.iter().map(|pixel| pixel.mean).sum::<f64>() / others.pixels.len() as f64;
        let gain = others.error(mean) * others.rays / (self.error(mean) * self.rays);
        gain.is_finite().then_some(gain)
    }

    /// The sum of the relative variances of most pixels.
    fn error(&self, mean: f64) -> f64 {
        let relative = |pixel: &Pixel| pixel.variance / (pixel.mean * pixel.mean + DARK * mean * mean);
        let mut errors: Vec<f64> = self.pixels.iter().map(relative).collect();
        errors.sort_by(f64::total_cmp);
        let most = errors.len() - errors.len().div_ceil(100);
        errors[..most].iter().sum()
    }
}
