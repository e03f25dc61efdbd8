use std::f64::consts::{PI, TAU};
use std::sync::OnceLock;

use super::{Beam, LeSample, LightSample};
use crate::math::{Cone, DVec3, Ray, one_minus_cos_of_cone, unit};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::Quantity;

/// A disc in the sky, seen in the same direction from everywhere: light from a small cone of directions.
///
/// ```toml
/// [[light]]
/// sun = { toward = [1, 2, 1], irradiance = 3 }     # angular_diameter = 0.533 degrees, the sun's; 0: parallel light
/// ```
#[derive(Clone, Debug)]
pub struct Sun<S> {
    /// Direction from the scene to the sun, of any length.
    pub toward: [f64; 3],
    /// Full angle across the disc, in degrees, 0 to 180.
    pub angular_diameter: f64,
    /// Irradiance on a surface that faces the sun: radiance times the disc's projected solid angle.
    pub irradiance: S,
    /// What every ray needs of it, computed once.
    disc: OnceLock<Disc>,
}

/// The disc in the form that rays need.
#[derive(Clone, Copy, Debug)]
struct Disc {
    /// The cone of directions toward it.
    cone: Cone,
    /// Factor from irradiance to the disc's radiance.
    radiance_factor: f64,
}

impl<S> Sun<S> {
    /// Creates a sun in a direction of any length, with its angular diameter in degrees.
    pub fn new(toward: [f64; 3], angular_diameter: f64, irradiance: S) -> Self {
        Self { toward, angular_diameter, irradiance, disc: OnceLock::new() }
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Sun<T> {
        Sun::new(self.toward, self.angular_diameter, convert(Quantity::Emission, &self.irradiance))
    }

    fn disc(&self) -> &Disc {
        self.disc.get_or_init(|| {
            let sin = libm::sin(0.5 * self.angular_diameter.to_radians());
            let axis = unit(DVec3::from(self.toward).normalize());
            let cone = Cone { axis, one_minus_cos: one_minus_cos_of_cone(sin * sin) };
            Disc { cone, radiance_factor: 1.0 / (PI * (sin * sin)) }
        })
    }

    /// Returns the direction toward the center of the disc.
    pub fn center_direction(&self) -> DVec3 {
        self.disc().cone.axis
    }

    /// Samples a direction toward the disc, uniformly over its solid angle.
    fn sample(&self, u: [f64; 2]) -> DVec3 {
        let cone = &self.disc().cone;
        if self.angular_diameter == 0.0 { cone.axis } else { unit(cone.sample_uniform(u)) }
    }

    pub(super) fn sample_li(&self, from: &SurfacePoint, u: [f64; 2]) -> LightSample {
        self.sample_along(from.leave(self.sample(u)))
    }

    fn sample_along(&self, ray: Ray) -> LightSample {
        let (pdf, factor) = match self.angular_diameter {
            0.0 => (None, 1.0),
            // A sampled direction lies in the disc, even if rounding puts it beyond the rim of a very small one.
            _ => (Some(self.disc().cone.uniform_pdf()), self.radiance_factor()),
        };
        LightSample::of_sky(ray, pdf, factor)
    }

    /// Returns the pdf per steradian of drawing a ray's direction; `None` beside the disc and for parallel light.
    pub fn pdf(&self, ray: &Ray) -> Option<f64> {
        let cone = &self.disc().cone;
        // For unit vectors |d - axis|^2 = 2 (1 - cos), without the rounding of 1 - cos.
        let inside = (ray.direction - cone.axis).length_squared() <= 2.0 * cone.one_minus_cos * (1.0 + 1e-12);
        (inside && cone.one_minus_cos > 0.0).then(|| cone.uniform_pdf())
    }

    /// Returns the solid angle of the disc in steradians; 0 for parallel light.
    pub(crate) fn solid_angle(&self) -> f64 {
        TAU * self.disc().cone.one_minus_cos
    }

    /// Returns the factor from irradiance to the disc's radiance.
    pub fn radiance_factor(&self) -> f64 {
        self.disc().radiance_factor
    }

    /// Samples a photon through a disc across the ball.
    pub(super) fn sample_le(&self, ball: &Ball, guide_uv: [f64; 2], u: [f64; 2]) -> Option<LeSample> {
        let ray = Beam::ray_from_sky(ball, self.sample(u), guide_uv)?;
        let light = self.sample_along(Ray { direction: -ray.direction, ..ray });
        Some(LeSample { ray, factor: light.factor / light.pdf.unwrap_or(1.0), surface: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Frame;

    #[test]
    fn a_sun_is_sampled_within_its_disc_and_found_nowhere_else() {
        let toward = [0.3, 0.8, -0.2];
        for angular_diameter in [1e-6, 0.533, 20.0, 120.0, 180.0] {
            let sun = Sun::new(toward, angular_diameter, ());
            let half = 0.5 * angular_diameter.to_radians();
            let density = 1.0 / (2.0 * PI * 2.0 * libm::pow(libm::sin(0.5 * half), 2.0));
            let pdf = |direction: DVec3| sun.pdf(&Ray { origin: DVec3::ZERO, direction });
            for u in (0..64).flat_map(|i| (0..64).map(move |j| [f64::from(i) / 63.001, f64::from(j) / 63.001])) {
                let found = pdf(sun.sample(u)).unwrap_or_else(|| panic!("{angular_diameter} degrees, {u:?}"));
                assert!((found / density - 1.0).abs() < 1e-9, "{angular_diameter} degrees: {found} for {density}");
            }
            let frame = Frame::about(sun.disc().cone.axis);
            let at_angle = |angle: f64| frame.to_world(DVec3::new(libm::sin(angle), 0.0, libm::cos(angle)));
            assert!(pdf(at_angle(half * 0.999)).is_some() && pdf(at_angle(half * 1.001)).is_none());
        }
    }

    /// Rounding puts draws beyond the rim of a disc hardly wider than the rounding: a seventh of the light was lost.
    #[test]
    fn a_very_small_sun_loses_no_light() {
        for angular_diameter in [1e-9, 1e-11, 1e-13, 1e-14, 1e-15] {
            let sun = Sun::new([0.3, 0.8, -0.2], angular_diameter, ());
            for u in (0..64).flat_map(|i| (0..64).map(move |j| [f64::from(i) / 63.001, f64::from(j) / 63.001])) {
                let ray = Ray { origin: DVec3::ZERO, direction: sun.sample(u) };
                let light = sun.sample_along(ray);
                let irradiance = light.factor / light.pdf.unwrap_or(f64::NAN);
                assert!((irradiance - 1.0).abs() < 1e-9, "{angular_diameter} degrees: {u:?}: {irradiance}");
            }
        }
    }
}
