use std::f64::consts::PI;
use std::sync::Arc;

use super::{Beam, BrightPart, LeSample, LightSample, Opening, Panorama};
use crate::math::{DMat3, DVec3, Ray, cosine_about, unit};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::{Curve, CurveKind, Draw, Lanes, Placement, Quantity, Table, Texture};

/// Light from all directions, where rays miss everything: the same from everywhere, or an image.
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
    /// What rays show that miss everything; a factor on the image, where there is one.
    pub radiance: S,
    /// The image.
    pub image: Option<Sky<S>>,
    /// How it is polarized, if it is.
    pub polarization: Option<SkyPolarization>,
}

/// The polarization of a clear sky: of sunlight that air has scattered once.
///
/// Rayleigh 1871, *On the Light from the Sky, its Polarization and Colour*: the degree is sin^2 g / (1 + cos^2 g) at an
/// angle g from the sun, and fields swing across the plane of the sun and the ray. Air scatters more than once, and
/// molecules are no spheres: so the most there is, a quarter turn from the sun, is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyPolarization {
    /// Unit vector toward the sun.
    pub sun: DVec3,
    /// The degree a quarter turn from it, 0 to 1.
    pub degree: f64,
}

impl SkyPolarization {
    /// Along which direction light is polarized that comes from the unit vector `wi`, and to which degree; none toward
    /// the sun and away from it, where it is not.
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
    /// World to image.
    turn: DMat3,
    /// The image's colors as factors on white.
    colors: S,
}

impl Sky<Curve> {
    /// An image, turned from its own directions into the world's by a rotation.
    pub fn new(panorama: Panorama, rotation: DMat3) -> Self {
        let texture = Texture { image: panorama.image.clone(), placement: Placement::default() };
        let colors = CurveKind::Texture(texture).into();
        Self { panorama: Arc::new(panorama), turn: rotation.transpose(), colors }
    }
}

impl<S> Environment<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Environment<T> {
        let image = self.image.as_ref().map(|sky| Sky {
            panorama: sky.panorama.clone(),
            turn: sky.turn,
            colors: convert(Quantity::Emission, &sky.colors),
        });
        let polarization = self.polarization;
        Environment { radiance: convert(Quantity::Emission, &self.radiance), image, polarization }
    }

    /// Draws directions by the image's brightness; without one by the cosine, as the irradiance of an even sky.
    pub(super) fn sample_li(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let (direction, pdf) = match &self.image {
            Some(sky) => {
                let (direction, pdf) = sky.panorama.sample(u);
                (unit(sky.turn.transpose() * direction), pdf)
            }
            None => {
                let direction = cosine_about(normal, u);
                (direction, self.pdf(direction, normal))
            }
        };
        (pdf > 0.0).then(|| LightSample::of_sky(from.leave(direction), Some(pdf), 1.0))
    }

    /// Density per steradian with which `sample_li` draws a direction, at a surface of the given unit normal.
    pub(super) fn pdf(&self, direction: DVec3, normal: DVec3) -> f64 {
        match &self.image {
            Some(sky) => sky.panorama.pdf(sky.turn * direction),
            None => direction.dot(normal).max(0.0) / PI,
        }
    }

    /// The bright part of its image, from which photons are sent; none of a polarized sky.
    pub fn bright(&self) -> Option<&BrightPart> {
        self.image.as_ref().filter(|_| self.polarization.is_none())?.panorama.bright.as_ref()
    }

    /// Whether a direction lies in that part.
    pub(super) fn is_bright(&self, direction: DVec3) -> bool {
        let is_bright = |sky: &Sky<S>| sky.panorama.is_bright(sky.turn * direction);
        self.polarization.is_none() && self.image.as_ref().is_some_and(is_bright)
    }

    /// Whether its image is not black in a direction.
    pub fn shines_toward(&self, direction: DVec3) -> bool {
        let color = |sky: &Sky<S>| sky.panorama.color(sky.turn * direction);
        self.image.as_ref().is_none_or(|sky| color(sky).iter().any(|&x| x > 0.0))
    }

    /// A direction toward the bright part for two random numbers, and its density per steradian.
    pub fn sample_bright(&self, u: [f64; 2]) -> Option<(DVec3, f64)> {
        let sky = self.image.as_ref()?;
        let (direction, pdf) = sky.panorama.sample_bright(u)?;
        Some((unit(sky.turn.transpose() * direction), pdf))
    }

    /// Photons of the bright part.
    pub(super) fn beam(&self, ball: &Ball) -> Option<Beam> {
        Some(Beam::from_sky(ball, self.bright()?.irradiance))
    }

    /// Photons of all its light that comes through an opening, but that of the bright part; none of a polarized sky.
    pub(super) fn beam_through(&self, opening: &Opening, ball: &Ball) -> Option<Beam> {
        self.polarization.is_none().then(|| Beam::through(opening, ball, self.mean()))
    }

    /// A photon of the bright part, through a disc across the ball; of a beam through an opening, of all but that part.
    pub(super) fn sample_le(&self, beam: &Beam, guide_uv: [f64; 2], u: [f64; 2]) -> Option<LeSample> {
        let Some(opening) = &beam.opening else {
            let (direction, pdf) = self.sample_bright(u)?;
            let ray = Beam::ray_from_sky(&beam.ball, direction, guide_uv)?;
            return Some(LeSample { ray, factor: 1.0 / pdf, surface: None });
        };
        let ray = opening.ray_toward(&beam.ball, guide_uv, u)?;
        (!self.is_bright(-ray.direction)).then_some(LeSample { ray, factor: 1.0, surface: None })
    }

    /// How densely `sample_le` draws a photon for a beam; 0 of a direction whose light the beam does not send.
    pub(super) fn pdf_le(&self, beam: &Beam, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let is_sent = self.is_bright(-ray.direction) == beam.opening.is_none();
        if is_sent { beam.pdf_from_sky(ray, guide) } else { 0.0 }
    }

    /// The mean over all directions of the factor on `radiance`.
    pub fn mean(&self) -> f64 {
        self.image.as_ref().map_or(1.0, |sky| sky.panorama.mean)
    }
}

impl Environment<Table> {
    /// The radiance along a direction.
    pub(super) fn toward<const N: usize>(&self, draw: &Draw<N>, direction: DVec3) -> Lanes<N> {
        let level = draw.read(&self.radiance);
        let Some(sky) = &self.image else { return level };
        level * draw.tint(&sky.colors, summed(sky.panorama.color(sky.turn * direction)))
    }
}

/// A color made up as white, what two channels have beyond it, and what one has beyond those: the bits of images in
/// three bands are those of such sums.
fn summed(color: [f32; 3]) -> [f32; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| color[a].total_cmp(&color[b]));
    let [least, middle, most] = order.map(|channel| color[channel]);
    let second = least + (middle - least);
    let mut sums = color;
    (sums[order[1]], sums[order[2]]) = (second, second + (most - middle));
    sums
}
