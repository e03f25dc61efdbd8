//! Estimates from a few photons what the photons of a map are worth.

use std::cell::Cell;

use super::pilot::SampleWorth;
use super::reached_places::{has_photon_among, has_photon_near, mean_photons_examined};
use crate::math::{DVec3, Sampler};
use crate::spectrum::apply;
use crate::trace::camera::{PathTracer, SensorEvent, take_sample};
use crate::trace::contribution::{Contribution, FoundBy};
use crate::trace::pass::Pass;
use crate::trace::photon::{PhotonMap, photons};
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{MapPasses, RAYS_OF_A_LOOK, World};

/// The noise from a map's photons, and from the camera samples that gather them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GatheredWorth {
    /// Variance of an image from n photons, summed over pixels and channels of XYZ, times n.
    pub variance: f64,
    /// Rays traced per photon.
    pub rays: f64,
    /// Number of photons that a pass needs; more would only cost time.
    pub enough: f64,
    /// Second moment of what a camera sample gathers, scaled like the variance of camera samples.
    pub second_moment: f64,
    /// What else camera samples contribute.
    pub samples: SampleWorth,
}

/// Mean number of photons examined per gathering point in a pass that has enough. Their noise is then small compared
/// with that of paths that lead there, and examining them takes as long as a few rays.
const MAX_EXAMINED: f64 = 16.0;
/// Maps that are compared.
const MAP_COUNT: u64 = 2;
/// Pixels along each side of the image that gather from the maps, and samples of each.
const PIXELS_PER_SIDE: u32 = 20;
const SAMPLES_PER_PIXEL: u32 = 4;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6761_7468;

/// Gathers photons of two maps along the same paths, so that the difference is noise of the photons. It is
/// overestimated where a pixel's many samples gather at more places than these few, which errs toward more photons.
///
/// Uses the whole image even when only a part of it is rendered, so that all parts are rendered the same way. Returns
/// `None` if no photon lies near places that paths from the camera [reach](super::reached_places), or if photons lie
/// only among these places and none is gathered.
pub fn gathered_worth(world: &World, places: &[DVec3]) -> Option<GatheredWorth> {
    in_lanes!(&world.method.basis, N => compare_maps::<N>(world, places))
}

/// Sums of values and of their squares, for each channel.
#[derive(Clone, Copy, Default)]
struct Moments([[f64; 2]; 3]);

impl Moments {
    fn add(&mut self, values: [f64; 3]) {
        if values.iter().all(|x| x.is_finite()) {
            self.0.iter_mut().zip(values).for_each(|(sum, x)| *sum = [sum[0] + x, sum[1] + x * x]);
        }
    }

    /// Returns the variance of `count` values, summed over channels.
    fn variance(&self, count: f64) -> f64 {
        self.0.iter().map(|[sum, squares]| ((squares - sum * sum / count) / (count - 1.0)).max(0.0)).sum()
    }
}

/// A first photon map, and a world whose maps have no more photons than enough.
struct FirstMap<const N: usize> {
    enough: f64,
    /// Whether any photon lies within a coarse pixel of where paths lead.
    is_near: bool,
    world: World,
    /// The map, or `None` if it has more photons than enough.
    photons: Option<PhotonMap<N>>,
}

impl<const N: usize> FirstMap<N> {
    fn new(world: &World, reached: &[DVec3]) -> Option<Self> {
        let photons = photons::<N, Polarized>(world, &Pass::for_photons_only(world, 0))?;
        let is_near = has_photon_near(world, reached, &photons);
        if !is_near && !has_photon_among(reached, &photons) {
            return None;
        }
        let enough = photons.sent as f64 * (MAX_EXAMINED / mean_photons_examined(world, reached, &photons));
        let limit_map = |map: MapPasses| MapPasses { photons: map.photons.min(enough.ceil() as u64), ..map };
        let pass = world.method.light_pass.as_ref().map(|pass| pass.with_map(limit_map));
        let is_enough = photons.sent as f64 <= enough;
        Some(Self { enough, is_near, world: world.with_light_pass(pass), photons: is_enough.then_some(photons) })
    }
}

fn compare_maps<const N: usize>(world: &World, reached: &[DVec3]) -> Option<GatheredWorth> {
    let FirstMap { enough, is_near, ref world, photons: mut first } = FirstMap::<N>::new(world, reached)?;
    let film = world.scene.film;
    let to_xyz = film.color_space.to_xyz();
    let mut places: Vec<_> = film.whole().middles_of_cells(PIXELS_PER_SIDE).collect();
    let mut photon_moments = vec![Moments::default(); places.len()];
    let mut sample_moments = photon_moments.clone();
    let (mut all_sent, mut rays, mut sample_rays, mut second_moment) = (0, 0, 0, 0.0);
    for map in 0..MAP_COUNT {
        let make_map = || photons::<N, Polarized>(world, &Pass::for_photons_only(world, map as u32));
        let photons = first.take().or_else(make_map)?;
        (all_sent, rays) = (all_sent + photons.sent, rays + photons.stats.rays);
        let all_gathered = Cell::new([0.0; 3]);
        let observer = |event: SensorEvent| {
            if let SensorEvent::Light(Contribution { found: FoundBy::Gathered, rgb, .. }) = event {
                let sum: [f64; 3] = all_gathered.get();
                all_gathered.set(std::array::from_fn(|i| sum[i] + rgb[i]));
            }
        };
        let mut tracer = PathTracer::<N>::new(world).with_photons(Some(&photons)).with_observer(&observer);
        let mut looked_at = 0;
        for (place, &[x, y]) in places.iter().enumerate() {
            let before = all_gathered.get();
            for number in 0..SAMPLES_PER_PIXEL {
                let so_far = all_gathered.get();
                let sampler = Sampler::of_pixel((world.method.seed ^ SEED).wrapping_add(u64::from(number)), [x, y], 0);
                let found = take_sample(&mut tracer, &sampler, [x, y]).rgb;
                let gathered = all_gathered.get();
                let sample_gathered: [f64; 3] = std::array::from_fn(|i| gathered[i] - so_far[i]);
                let xyz = apply(&to_xyz, sample_gathered);
                second_moment += xyz.iter().filter(|x| x.is_finite()).map(|x| x * x).sum::<f64>();
                if map == 0 {
                    sample_moments[place].add(apply(&to_xyz, std::array::from_fn(|i| found[i] - sample_gathered[i])));
                }
            }
            let gathered = all_gathered.get();
            let mean = std::array::from_fn(|i| (gathered[i] - before[i]) / f64::from(SAMPLES_PER_PIXEL));
            photon_moments[place].add(apply(&to_xyz, mean));
            looked_at += 1;
            if map == 0 && tracer.walker.stats.rays > RAYS_OF_A_LOOK {
                break;
            }
        }
        places.truncate(looked_at);
        sample_rays += tracer.walker.stats.rays;
    }
    let pixels = film.whole().pixels() as f64;
    let count = places.len() as f64;
    let mean = |variances: &[f64]| variances.iter().sum::<f64>() / count;
    let map_variances: Vec<f64> =
        photon_moments[..places.len()].iter().map(|sums| sums.variance(MAP_COUNT as f64)).collect();
    let variances =
        sample_moments[..places.len()].iter().map(|sums| sums.variance(f64::from(SAMPLES_PER_PIXEL))).collect();
    let sample_count = MAP_COUNT as f64 * count * f64::from(SAMPLES_PER_PIXEL);
    (is_near || second_moment > 0.0).then(|| GatheredWorth {
        variance: mean(&map_variances) * pixels * all_sent as f64 / MAP_COUNT as f64,
        rays: rays as f64 / all_sent as f64,
        enough,
        second_moment: second_moment / sample_count * pixels * pixels,
        samples: SampleWorth::of(variances, pixels, sample_rays as f64 / sample_count),
    })
}
