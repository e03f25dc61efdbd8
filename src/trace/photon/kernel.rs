//! How far photons are gathered around a place.

use crate::spectrum::Matching;
use crate::trace::World;
use crate::trace::pass::Pass;
use crate::trace::replicates::REPLICATES;

/// How far photons count, and at which wavelengths: both blur.
pub struct Kernel<const N: usize> {
    /// In widths of a pixel at the distance that the camera path has come.
    pub radius: f64,
    pub matching: Matching<N>,
}

/// Number of parts into which the draws of wavelengths are divided, for a radius of one pixel: two wavelengths in one
/// part count as one. Like the radius, it keeps the blur small where dispersion spreads colors over dozens of pixels.
const WAVELENGTH_PARTS: f64 = 32.0;

impl<const N: usize> Kernel<N> {
    fn new(world: &World, radius: f64) -> Self {
        Self { radius, matching: Matching::new(&world.method.basis, WAVELENGTH_PARTS / radius) }
    }

    /// Returns the kernel of a pass.
    ///
    /// If a stop rule takes more samples than the plan chose the radius for, the radius shrinks as it would for that
    /// many. Bias and noise then vanish together, and a small enough error is reached in the end (Knaus & Zwicker 2011,
    /// *Progressive Photon Mapping: A Probabilistic Approach*).
    pub fn of_pass(world: &World, pass: &Pass) -> Option<Self> {
        let radius = world.method.map()?.radius;
        let samples = pass.replicate.map_or(0.0, |_| REPLICATES as f64 * f64::from(pass.numbers.end));
        let sample_ratio = (samples / f64::from(world.method.samples)).max(1.0);
        Some(Self::new(world, radius * libm::pow(sample_ratio, -1.0 / 6.0)))
    }

    /// Returns a kernel that blurs half as much: with half the area, and half the squared width among wavelengths.
    pub fn half_blur(&self, world: &World) -> Self {
        Self::new(world, self.radius * std::f64::consts::FRAC_1_SQRT_2)
    }
}
