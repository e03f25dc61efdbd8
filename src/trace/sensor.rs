//! Where the light of camera samples arrives.

use super::World;
use super::stats::Stats;
use crate::light::LightId;
use crate::math::DVec3;

/// Light that reaches the sensor by one path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contribution {
    /// The light it comes from; none where photons of several were gathered.
    pub(super) light: Option<LightId>,
    pub(super) found: Found,
    /// How much, in the film's color space.
    pub(super) rgb: [f64; 3],
    /// How much of it polarization may change, as X + Y + Z.
    pub(super) moved: f64,
}

/// How light was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Found {
    /// A path hit the light: a surface, with its unit normal on the front, or none of a sky; and whether the direction
    /// was drawn where lights were sampled as well.
    Hit { normal: Option<DVec3>, scattered: bool },
    /// The light was sampled.
    Sampled,
    /// A path from the light was met.
    Connected,
    /// Photons were gathered.
    Gathered,
}

/// What a path found in a direction that was drawn where lights were sampled as well.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounce {
    pub(super) from: DVec3,
    /// The surface's unit normal there, on the side it left.
    pub(super) normal: DVec3,
    pub(super) direction: DVec3,
    /// How far it went; infinite where it hit nothing.
    pub(super) distance: f64,
    /// What the sensor got of the light found at its end, as X + Y + Z.
    pub(super) light: f64,
    /// The path's weight.
    pub(super) weight: f64,
}

/// Somebody who wants to know what the camera's paths find, beside the image.
pub(super) trait Observer {
    /// Light reached the sensor.
    fn receive(&self, _contribution: &Contribution) {}
    /// A path has come, by way of other surfaces, to a place that scatters widely.
    fn reach(&self, _place: DVec3) {}
    /// All light at the end of a bounce was received.
    fn bounce(&self, _bounce: Bounce) {}
}

/// The sink of all light that one camera sample after another finds.
pub(super) struct Sensor<'a> {
    /// What the sample at hand has received.
    pub(super) rgb: [f64; 3],
    /// How much of that polarization may change.
    moved: f64,
    pub(super) observer: Option<&'a dyn Observer>,
}

impl<'a> Sensor<'a> {
    pub(super) fn new() -> Self {
        Self { rgb: [0.0; 3], moved: 0.0, observer: None }
    }

    /// Receives light.
    #[inline]
    pub(super) fn receive(&mut self, contribution: Contribution) {
        add(&mut self.rgb, contribution.rgb);
        self.moved += contribution.moved;
        if let Some(observer) = self.observer {
            observer.receive(&contribution);
        }
    }

    /// What the sample received; the next one starts with nothing.
    ///
    /// One that is not finite is left out of the image, and so of the light that is counted.
    pub(super) fn read_out(&mut self, world: &World, stats: &mut Stats) -> [f64; 3] {
        let light = amount(world, self.rgb);
        if light.is_finite() && self.moved.is_finite() {
            stats.light += light;
            stats.polarization += self.moved;
        }
        self.moved = 0.0;
        std::mem::take(&mut self.rgb)
    }
}

/// How much light there is in a film color: X + Y + Z.
pub(super) fn amount(world: &World, rgb: [f64; 3]) -> f64 {
    (0..3).map(|channel| rgb[channel] * world.xyz_of_channel[channel]).sum::<f64>().abs()
}

pub(super) fn add(sum: &mut [f64; 3], more: [f64; 3]) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += more;
    }
}
