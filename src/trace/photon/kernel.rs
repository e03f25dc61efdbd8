//! How far photons are gathered around a place.

use crate::spectrum::Matching;
use crate::trace::World;
use crate::trace::pass::Pass;
use crate::trace::replicates::REPLICATES;

/// How far photons count, and in which wavelengths: what blurs.
pub struct Kernel<const N: usize> {
    /// In pixels as wide as the path from the camera is long.
    pub radius: f64,
    pub matching: Matching<N>,
}

/// Parts of the draws in one of which two wavelengths count as one, where the radius is a pixel. They are chosen, as
/// radii are, so that the blur is small where dispersion spreads colors over dozens of pixels.
const PARTS: f64 = 32.0;

impl<const N: usize> Kernel<N> {
    fn new(world: &World, radius: f64) -> Self {
        Self { radius, matching: Matching::new(&world.method.basis, PARTS / radius) }
    }

    /// That of a pass.
    ///
    /// Where a stop rule takes more samples than the plan's radius is for, it shrinks as it would for as many: bias and
    /// noise then vanish together, and an error that is small enough comes (Knaus & Zwicker 2011, *Progressive Photon
    /// Mapping: A Probabilistic Approach*).
    pub fn of_pass(world: &World, pass: &Pass) -> Option<Self> {
        let radius = world.method.map()?.radius;
        let samples = pass.replicate.map_or(0.0, |_| REPLICATES as f64 * f64::from(pass.numbers.end));
        let more = (samples / f64::from(world.method.samples)).max(1.0);
        Some(Self::new(world, radius * libm::pow(more, -1.0 / 6.0)))
    }

    /// One that blurs half as much: of half the area, and of half the square of a width among wavelengths.
    pub fn half(&self, world: &World) -> Self {
        Self::new(world, self.radius * std::f64::consts::FRAC_1_SQRT_2)
    }
}
