use std::f64::consts::PI;
use std::sync::Arc;

use super::{Panorama, View};
use crate::math::{DMat3, DVec3, Frame, Ray, cosine_hemisphere, unit};
use crate::shape::Sighting;
use crate::spectrum::{Curve, CurveKind, Draw, Lanes, Placement, Quantity, Table, Texture};

/// Light from all directions, where rays miss everything: the same from everywhere, or an image.
///
/// ```toml
/// [[light]]
/// environment = { radiance = 1 }
/// [[light]]
/// environment = { radiance = { image = "sky.exr", scale = 2 }, transform = [{ rotate = { axis = [0, 1, 0], degrees = 90 } }] }
/// ```
#[derive(Clone, Debug)]
pub struct Environment<S> {
    /// What rays show that miss everything; a factor on the image, where there is one.
    pub radiance: S,
    /// The image.
    pub image: Option<Sky<S>>,
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
        let texture = Texture { image: panorama.image().clone(), placement: Placement::default() };
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
        Environment { radiance: convert(Quantity::Emission, &self.radiance), image }
    }

    /// Draws directions by the image's brightness; without one by their cosine to the normal, as the irradiance of an even
    /// sky weighs them.
    pub(super) fn aim(&self, normal: DVec3, u: [f64; 2]) -> Sighting {
        let direction = match &self.image {
            Some(sky) => sky.turn.transpose() * sky.panorama.sample(u).0,
            None => Frame::about(normal).to_world(cosine_hemisphere(u)),
        };
        Sighting { direction: unit(direction), part: None, density: None }
    }

    /// Density with which `aim` draws the direction of a ray, at a surface of the given normal.
    pub fn pdf(&self, ray: &Ray, normal: DVec3) -> f64 {
        match &self.image {
            Some(sky) => sky.panorama.pdf(sky.turn * ray.direction),
            None => ray.direction.dot(normal).max(0.0) / PI,
        }
    }

    pub(super) fn view(&self, ray: &Ray, normal: DVec3) -> Option<View> {
        let pdf = Some(self.pdf(ray, normal)).filter(|pdf| *pdf > 0.0)?;
        Some(View { distance: f64::INFINITY, object: None, pdf: Some(pdf), factor: 1.0, uv: [0.0; 2] })
    }

    /// The mean over all directions of the factor on `radiance`.
    pub fn mean(&self) -> f64 {
        self.image.as_ref().map_or(1.0, |sky| sky.panorama.mean())
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

/// A color made up as white, what two channels have beyond it, and what one has beyond those: the bits of images in three
/// bands are those of such sums.
fn summed(color: [f32; 3]) -> [f32; 3] {
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| color[a].total_cmp(&color[b]));
    let [least, middle, most] = order.map(|channel| color[channel]);
    let second = least + (middle - least);
    let mut sums = color;
    (sums[order[1]], sums[order[2]]) = (second, second + (most - middle));
    sums
}
