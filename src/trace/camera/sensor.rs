//! Where the light of camera samples arrives.

use super::layer_sample::LayerSample;
use crate::math::DVec3;
use crate::spectrum::Draw;
use crate::trace::World;
use crate::trace::contribution::{Contribution, add};
use crate::trace::counted::Counted;
use crate::trace::photon::Gathered;
use crate::trace::stats::Stats;
use crate::trace::walk::{FoundLight, Path, Polarization, ScatterSample};

/// What a path found in a direction that was sampled where lights were sampled as well.
#[derive(Clone, Copy, Debug)]
pub struct Bounce {
    pub from: DVec3,
    /// The surface's unit normal there, on the side that the path left.
    pub normal: DVec3,
    pub direction: DVec3,
    /// Distance to what it hit; infinite if it hit nothing.
    pub distance: f64,
    /// The light found at its end that the sensor received, as X + Y + Z.
    pub light: f64,
    pub weight: f64,
}

/// What the camera's paths find, for an observer who wants to know more than the image.
pub enum SensorEvent<'a> {
    Light(&'a Contribution),
    /// A path has reached a place that scatters widely, by way of other surfaces.
    Place(DVec3),
    /// All light at the end of a bounce was received.
    Bounce(Bounce),
}

/// The sensor that receives all light that camera samples find, one sample after another.
pub struct Sensor<'a, const N: usize> {
    /// Whether it ignores what arrives.
    pub ignores_light: bool,
    /// Which light counts, and how much.
    pub counted: Counted<'a>,
    /// What the current sample has received.
    pub rgb: [f64; 3],
    /// The amount of the received light that polarization may change.
    polarization_change: f64,
    /// How much kernels blur what it has received.
    pub blur: [f64; 3],
    pub observer: Option<&'a dyn Fn(SensorEvent)>,
    /// What it leaves in the layers, if any are requested.
    pub layers: Option<LayerSample<'a, N>>,
}

impl<'a, const N: usize> Sensor<'a, N> {
    pub fn new() -> Self {
        let (rgb, polarization_change, blur) = ([0.0; 3], 0.0, [0.0; 3]);
        Self {
            ignores_light: false,
            counted: Counted::ALL,
            rgb,
            polarization_change,
            blur,
            observer: None,
            layers: None,
        }
    }

    /// Decides which light of the next paths counts.
    pub fn set_counted(&mut self, counted: Counted<'a>) {
        self.counted = counted;
        self.layers.iter_mut().for_each(|layers| layers.is_aimed = counted.is_aimed());
    }

    /// Receives light, the lanes by which it arrives, and the polarization of the path where it hits the light.
    #[inline]
    pub fn receive<P: Polarization<N>>(&mut self, contribution: Contribution, light: &FoundLight<N, P>, polarized: &P) {
        let factor = self.counted.factor(contribution.light, contribution.bounces);
        if self.ignores_light || factor == 0.0 {
            return;
        }
        let contribution = if factor == 1.0 { contribution } else { contribution.scaled(factor) };
        if let Some(layers) = &mut self.layers {
            let FoundLight { world, received, excitation, .. } = *light;
            match excitation {
                None => layers.receive(&contribution, received, polarized.stokes(), factor),
                Some(dye) => {
                    let stokes = dye.polarization.stokes();
                    dye.with_received(world, received, |seen| layers.receive(&contribution, seen, stokes, factor));
                }
            }
        }
        self.receive_contribution(&contribution);
    }

    /// Receives the light of gathered photons.
    pub fn receive_gathered(&mut self, gathered: &Gathered<N>, draw: &Draw<N>) {
        if self.ignores_light || self.counted.is_aimed() {
            return;
        }
        if let Some(layers) = &mut self.layers {
            layers.receive_gathered(gathered, draw);
        }
        self.receive_contribution(&gathered.all);
    }

    /// Estimates the blur of gathered light, by comparison with a kernel that blurs half as much.
    pub fn add_blur(&mut self, gathered: [f64; 3], by_half: [f64; 3]) {
        if self.ignores_light || self.counted.is_aimed() {
            return;
        }
        add(&mut self.blur, std::array::from_fn(|i| 2.0 * (gathered[i] - by_half[i])));
    }

    #[inline]
    fn receive_contribution(&mut self, all: &Contribution) {
        add(&mut self.rgb, all.rgb);
        self.polarization_change += all.polarization_change;
        if let Some(observer) = self.observer {
            observer(SensorEvent::Light(all));
        }
    }

    /// Tells an observer what a bounce found at a distance; `before` is what the sensor had received before.
    #[inline]
    pub fn report_bounce<P: Polarization<N>>(
        &self,
        world: &World,
        path: &Path<N, P>,
        draw: &Draw<N>,
        distance: f64,
        before: [f64; 3],
    ) {
        if let (Some(observer), Some(ScatterSample { from, normal, .. })) = (self.observer, path.scatter)
            && !self.counted.is_aimed()
        {
            let light = world.amount(std::array::from_fn(|i| self.rgb[i] - before[i]));
            let (direction, distance) = (path.ray.direction, distance + (path.ray.origin - from).length());
            let weight = path.weight(draw) * f64::from(path.aiming_factor);
            observer(SensorEvent::Bounce(Bounce { from, normal, direction, distance, light, weight }));
        }
    }

    pub fn reset(&mut self) {
        (self.rgb, self.polarization_change, self.blur) = ([0.0; 3], 0.0, [0.0; 3]);
    }

    /// Returns what the sample has received, and resets it for the next one.
    ///
    /// A sample that is not finite is left out of the image, and so of the light that is counted.
    pub fn read_out(&mut self, world: &World, stats: &mut Stats) -> [f64; 3] {
        let light = world.amount(self.rgb);
        if light.is_finite() && self.polarization_change.is_finite() {
            stats.light += light;
            stats.polarization += self.polarization_change;
        }
        self.polarization_change = 0.0;
        std::mem::take(&mut self.rgb)
    }
}
