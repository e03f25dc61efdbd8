use std::f64::consts::PI;
use std::sync::Arc;

use super::{Beam, BrightPart, LeSample, LightSample, Opening, Panorama};
use crate::math::{DMat3, DVec3, Ray, sample_cosine_about, unit};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::{Curve, CurveKind, Draw, Lanes, Placement, Quantity, Table, Texture};

/// Light from all directions, seen by rays that miss everything: the same from everywhere, or an image.
///
/// ```toml
/// [[light]]
/// environment = { radiance = 1 }
/// [[light]]
/// environment = { radiance = { image = "sky.exr" }, transform = [{ rotate = { axis = [0, 1, 0], degrees = 90 } }] }
/// [[light]]
/// environment = { radiance = 1, polarization = { sun = [0, 1, 1], degree = 0.7 } }
/// ```
#[derive(Clone, Debug)]
pub struct Environment<S> {
    /// The radiance seen by rays that miss everything; a factor on the image, if there is one.
    pub radiance: S,
    /// The image.
    pub image: Option<Sky<S>>,
    /// The polarization of its light, if any.
    pub polarization: Option<SkyPolarization>,
}

/// The polarization of a clear sky: of sunlight scattered once by the air.
///
/// Rayleigh 1871, *On the Light from the Sky, its Polarization and Colour*: the degree is sin^2 g / (1 + cos^2 g) at an
/// angle g from the sun, and the field oscillates at right angles to the plane of the sun and the ray. Real air
/// scatters more than once, and molecules are not spheres, so the largest degree, a quarter turn from the sun, is a
/// parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyPolarization {
    /// Unit vector toward the sun.
    pub sun: DVec3,
    /// Degree of polarization a quarter turn from the sun, 0 to 1.
    pub degree: f64,
}

impl SkyPolarization {
    /// Returns the axis along which light from the unit vector `wi` is polarized, and its degree; `None` toward the sun
    /// and away from it, where light is unpolarized.
    pub fn toward(&self, wi: DVec3) -> Option<(DVec3, f64)> {
        let cos = wi.dot(self.sun);
        let axis = wi.cross(self.sun).try_normalize()?;
        Some((axis, self.degree * (1.0 - cos * cos) / (1.0 + cos * cos)))
    }
}

/// An image around the scene.
#[derive(Clone, Debug)]
pub struct Sky<S> {
    panorama: Arc<Panorama>,
    /// The rotation from world to image.
    to_image: DMat3,
    /// The image's colors as factors on white.
    colors: S,
}

impl Sky<Curve> {
    /// Creates an image that `rotation` turns from its own directions into the world's.
    pub fn new(panorama: Panorama, rotation: DMat3) -> Self {
        let texture = Texture { image: panorama.image.clone(), placement: Placement::default() };
        let colors = CurveKind::Texture(texture).into();
        Self { panorama: Arc::new(panorama), to_image: rotation.transpose(), colors }
    }
}

impl<S> Environment<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Environment<T> {
        let image = self.image.as_ref().map(|sky| Sky {
            panorama: sky.panorama.clone(),
            to_image: sky.to_image,
            colors: convert(Quantity::Emission, &sky.colors),
        });
        let polarization = self.polarization;
        Environment { radiance: convert(Quantity::Emission, &self.radiance), image, polarization }
    }

    /// Samples a direction by the image's brightness; without one, by the cosine, like the irradiance of an even sky.
    pub(super) fn sample_li(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let (direction, pdf) = match &self.image {
            Some(sky) => {
                let (direction, pdf) = sky.panorama.sample(u);
                (unit(sky.to_image.transpose() * direction), pdf)
            }
            None => {
                let direction = sample_cosine_about(normal, u);
                (direction, self.pdf(direction, normal))
            }
        };
        (pdf > 0.0).then(|| LightSample::of_sky(from.leave(direction), Some(pdf), 1.0))
    }

    /// Returns the pdf per steradian with which `sample_li` draws a direction at a surface with the given unit normal.
    pub(super) fn pdf(&self, direction: DVec3, normal: DVec3) -> f64 {
        match &self.image {
            Some(sky) => sky.panorama.pdf(sky.to_image * direction),
            None => direction.dot(normal).max(0.0) / PI,
        }
    }

    /// Returns the bright part of its image, from which photons are sent; `None` for a polarized sky.
    pub fn bright_part(&self) -> Option<&BrightPart> {
        self.image.as_ref().filter(|_| self.polarization.is_none())?.panorama.bright_part.as_ref()
    }

    /// Returns whether a direction lies in the bright part from which photons are sent.
    pub(super) fn is_bright(&self, direction: DVec3) -> bool {
        let is_bright = |sky: &Sky<S>| sky.panorama.is_bright(sky.to_image * direction);
        self.polarization.is_none() && self.image.as_ref().is_some_and(is_bright)
    }

    /// Returns whether its image is not black in a direction.
    pub fn shines_toward(&self, direction: DVec3) -> bool {
        let color = |sky: &Sky<S>| sky.panorama.color(sky.to_image * direction);
        self.image.as_ref().is_none_or(|sky| color(sky).iter().any(|&x| x > 0.0))
    }

    /// Samples a direction toward the bright part, and returns it with its pdf per steradian.
    pub fn sample_bright(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let sky = self.image.as_ref()?;
        let (direction, pdf) = sky.panorama.sample_bright(u)?;
        Some((unit(sky.to_image.transpose() * direction), pdf))
    }

    /// Returns the beam of the bright part.
    pub(super) fn beam(&self, ball: &Ball) -> Option<Beam> {
        Some(Beam::from_sky(ball, self.bright_part()?.irradiance))
    }

    /// Returns the beam through an opening, of all light except that of the bright part; `None` for a polarized sky.
    pub(super) fn beam_through(&self, opening: &Opening, ball: &Ball) -> Option<Beam> {
        self.polarization.is_none().then(|| Beam::through(opening, ball, self.mean()))
    }

    /// Samples a photon: from the bright part, through a disc across the ball; or through the beam's opening, from
    /// everywhere but that part.
    pub(super) fn sample_le(&self, beam: &Beam, guide_uv: [f64; 2], u: [f64; 2]) -> Option<LeSample> {
        let Some(opening) = &beam.opening else {
            let (direction, pdf) = self.sample_bright(u)?;
            let ray = Beam::ray_from_sky(&beam.ball, direction, guide_uv)?;
            return Some(LeSample { ray, factor: 1.0 / pdf, surface: None });
        };
        let ray = opening.ray_toward(&beam.ball, guide_uv, u)?;
        (!self.is_bright(-ray.direction)).then_some(LeSample { ray, factor: 1.0, surface: None })
    }

    /// Returns the pdf with which `sample_le` draws a photon for a beam; 0 for light that the beam does not send.
    pub(super) fn pdf_le(&self, beam: &Beam, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let is_sent = self.is_bright(-ray.direction) == beam.opening.is_none();
        if is_sent { beam.pdf_from_sky(ray, guide) } else { 0.0 }
    }

    /// Returns the mean of the factor on `radiance` over all directions.
    pub fn mean(&self) -> f64 {
        self.image.as_ref().map_or(1.0, |sky| sky.panorama.mean)
    }
}

impl Environment<Table> {
    /// Returns the radiance along a direction.
    pub(super) fn toward<const N: usize>(&self, draw: &Draw<N>, direction: DVec3) -> Lanes<N> {
        let level = draw.read(&self.radiance);
        let Some(sky) = &self.image else { return level };
        level * draw.tint(&sky.colors, rebuild_from_sums(sky.panorama.color(sky.to_image * direction)))
    }
}

/// Rebuilds a color as the sum of white, the excess of two channels over it, and the excess of one channel over those.
/// Images in three bands have the bits of such sums.
fn rebuild_from_sums(color: [f32; 3]) -> [f32; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| color[a].total_cmp(&color[b]));
    let [least, middle, most] = order.map(|channel| color[channel]);
    let second = least + (middle - least);
    let mut sums = color;
    (sums[order[1]], sums[order[2]]) = (second, second + (most - middle));
    sums
}
