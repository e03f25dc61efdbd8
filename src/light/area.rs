use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::toward_ball::TowardBall;
use super::{Beam, EmissionMap, EmissionPoint, LeSample, LightBounds, LightParts, LightSample, MeshPartsCache};
use crate::math::{Bounds, Cone, DVec3, DiscreteSample, Distribution2d, Ray};
use crate::shape::{
    Ball, Coordinates, Density, Intersection, Shape, ShapeSample, Sides, Sphere, SurfacePoint, TexturedShape,
};
use crate::spectrum::Quantity;

/// A surface that shines: an object whose material emits.
#[derive(Clone, Debug)]
pub struct Area<S> {
    /// The surface.
    pub shape: Arc<Shape>,
    /// The object whose surface it is.
    pub object: u32,
    /// The radiance of the surface.
    pub radiance: S,
    /// The sides that emit.
    pub sides: Sides,
    /// Whether next-event estimation samples it, as it does finite `emissive` surfaces. Planes and glowing glass are
    /// only found by chance.
    pub is_sampled: bool,
    /// The image that it shows, if any.
    image: Option<ShownImage>,
    /// The parts of a shape that has several. Sampling chooses one of them.
    parts: Option<LightParts>,
    /// The box of a closed shape. From outside of it, no back faces are visible.
    closed_bounds: Option<Bounds>,
    /// The unit normals of all that is visible of a sphere, if that is a small part.
    visible_cap: Option<Cone>,
}

/// An image on a surface that shines.
#[derive(Clone, Debug)]
pub struct ShownImage {
    /// The mapping from points of the surface to the image.
    pub coordinates: Arc<Coordinates>,
    /// The brightness that it gives them; `None` for a surface that is not sampled.
    pub map: Option<Arc<EmissionMap>>,
}

/// Largest 1 - cos of a cap that is sampled instead of the cone to the whole sphere: an eighth of the sphere.
const MAX_CAP: f64 = 0.25;
/// Fewest unit normals from which a cap is known well enough.
const MIN_NORMALS: usize = 64;
/// Probability of sampling a lamp that shows an image by the image's brightness, and not evenly over its visible part.
const IMAGE_PROBABILITY: f64 = 0.75;

impl<S> Area<S> {
    /// Creates the light of an object, with the image that it shows. Parts of known meshes are shared.
    pub fn new(
        shape: Arc<Shape>,
        object: u32,
        radiance: S,
        sides: Sides,
        is_sampled: bool,
        image: Option<ShownImage>,
        cache: &mut MeshPartsCache,
    ) -> Self {
        let parts = match image.as_ref().and_then(|image| image.map.as_ref()) {
            _ if !is_sampled => None,
            Some(map) => LightParts::of(&shape, |part| map.part_weight(part)),
            None => LightParts::of_even_emitter(&shape, cache),
        };
        let closed_bounds = if shape.is_closed() { shape.bounds() } else { None };
        Self { shape, object, radiance, sides, is_sampled, image, parts, closed_bounds, visible_cap: None }
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Area<T> {
        Area {
            shape: self.shape.clone(),
            object: self.object,
            radiance: convert(Quantity::Emission, &self.radiance),
            sides: self.sides,
            is_sampled: self.is_sampled,
            image: self.image.clone(),
            parts: self.parts.clone(),
            closed_bounds: self.closed_bounds,
            visible_cap: self.visible_cap,
        }
    }

    /// Returns whether learning its visible cap could help: for a sampled sphere that emits evenly.
    pub fn can_learn_visible_cap(&self) -> bool {
        self.is_sampled && matches!(*self.shape, Shape::Sphere(_)) && self.image.is_none()
    }

    /// Returns the brightness that its image gives to its places, if that varies.
    pub(super) fn emission_map(&self) -> Option<&EmissionMap> {
        self.image.as_ref()?.map.as_deref()
    }

    /// Returns the shape with its image, and the cells by which a part is sampled, if it has any.
    fn cells(&self, part: u32) -> Option<(TexturedShape<'_>, &Distribution2d)> {
        let image = self.image.as_ref()?;
        let surface = TexturedShape { shape: &self.shape, coordinates: &image.coordinates };
        Some((surface, image.map.as_ref()?.cells(part)?))
    }

    /// Learns the visible cap from the unit normals at which paths hit the light by chance. If they lie close together,
    /// the light is sampled there.
    ///
    /// The cap is larger than these normals require. The margin grows as fewer normals are known: light from beyond the
    /// rim makes rare bright samples, which cost more than some samples that see nothing.
    pub fn learn_visible_cap(&mut self, normals: &[DVec3]) {
        let margin = 1.1 + 4.0 / (normals.len() as f64).sqrt();
        let cap = if normals.len() < MIN_NORMALS { None } else { Cone::around(normals) };
        let wider = cap.map(|cap| Cone { one_minus_cos: cap.one_minus_cos * margin, ..cap });
        self.visible_cap = wider.filter(|cap| cap.one_minus_cos < MAX_CAP);
    }

    /// Returns the sphere and its visible cap, if that is small.
    fn sphere_and_cap(&self) -> Option<(&Sphere, &Cone)> {
        match &*self.shape {
            Shape::Sphere(sphere) => Some((sphere, self.visible_cap.as_ref()?)),
            _ => None,
        }
    }

    /// Returns whether a ray may hit the back of a part first. From outside of a closed body it never does.
    fn has_visible_backs(&self, from: DVec3) -> bool {
        self.sides == Sides::Both && self.closed_bounds.is_none_or(|bounds| bounds.contains(from))
    }

    /// Returns whether a part or a cell is chosen first, which uses up digits of a random number.
    pub(super) fn has_parts(&self) -> bool {
        self.parts.is_some() || self.emission_map().is_some_and(EmissionMap::has_cells)
    }

    fn sample(&self, from: DVec3, normal: DVec3, u: [f64; 2]) -> Option<ShapeSample> {
        if let Some((sphere, cap)) = self.sphere_and_cap() {
            return sphere.sample_cap(cap, from, u);
        }
        let Some(parts) = &self.parts else { return self.sample_part(None, from, u) };
        let part = parts.sample(from, normal, self.has_visible_backs(from), u[0])?;
        Some(self.sample_part(Some(part.index as u32), from, [part.u, u[1]])?.times(part.probability))
    }

    /// Samples a direction toward one part, or toward a shape that has only one.
    fn sample_part(&self, part: Option<u32>, from: DVec3, [u, v]: [f64; 2]) -> Option<ShapeSample> {
        let evenly = |u: f64| match part {
            Some(part) => self.shape.sample_part(part, from, [u, v]),
            None => self.shape.sample(from, [u, v]),
        };
        let Some((surface, cells)) = self.cells(part.unwrap_or(0)) else { return evenly(u) };
        let sample = if u < IMAGE_PROBABILITY {
            let place = cells.sample_point([u / IMAGE_PROBABILITY, v]);
            let point = surface.point_at(part.unwrap_or(0), place)?;
            let is_behind = surface.is_behind(&point, from);
            let sample = ShapeSample::along(point.position - from).filter(|_| !is_behind)?;
            part.map_or(sample, |part| sample.with_part(part))
        } else {
            evenly((u - IMAGE_PROBABILITY) / (1.0 - IMAGE_PROBABILITY))?
        };
        Some(ShapeSample { density: None, ..sample })
    }

    /// Returns the pdf per steradian with which `sample_part` draws the direction of a ray whose first hit is
    /// `intersection`.
    fn pdf_part(&self, ray: &Ray, intersection: &Intersection) -> f64 {
        let evenly = match &self.parts {
            Some(_) => self.shape.pdf_part(ray, intersection),
            None => self.shape.pdf(ray, intersection),
        };
        let Some((surface, cells)) = self.cells(intersection.part) else { return evenly };
        let point = self.shape.point(ray, intersection);
        let image_pdf = surface.place(intersection, point.position).map_or(0.0, |place| {
            Density::Area(cells.density(place.at) / place.area)
                .toward(intersection.t, point.normal.dot(ray.direction).abs())
        });
        IMAGE_PROBABILITY * image_pdf + (1.0 - IMAGE_PROBABILITY) * evenly
    }

    /// Samples the light, and rejects samples that another part of it occludes.
    pub(super) fn sample_li(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let sample = self.sample_li_in_part(from, normal, u)?;
        let is_hidden = |part| self.shape.hides(&sample.ray, part, sample.distance);
        (!sample.part.is_some_and(is_hidden)).then_some(LightSample { part: None, ..sample })
    }

    /// Samples the light, and hits it exactly as a ray that finds it by chance would: no distance needs a tolerance.
    pub(super) fn sample_li_in_part(&self, from: &SurfacePoint, normal: DVec3, u: [f64; 2]) -> Option<LightSample> {
        let sample = self.sample(from.position, normal, u)?;
        // A point in space has no horizon.
        if sample.direction.dot(normal) <= 0.0 && from.normal != DVec3::ZERO {
            return None;
        }
        let ray = from.leave(sample.direction);
        // The tree of a mesh is not searched here: that is left to the test for occlusion.
        let part = sample.part.filter(|_| self.shape.has_triangles());
        let intersection = match part {
            Some(part) => self.shape.intersect_triangle(&ray, part)?,
            None => self.shape.intersect(&ray, f64::INFINITY)?,
        };
        if sample.part.is_some_and(|part| part != intersection.part) {
            return None;
        }
        let cos = self.shape.normal(&ray, &intersection).dot(ray.direction);
        if !self.sides.shine(cos < 0.0) {
            return None;
        }
        let pdf = match sample.density {
            Some(density) => valid_pdf(density.toward(intersection.t, cos.abs()))?,
            None => self.pdf_at(&ray, normal, &intersection)?,
        };
        let uv = self.image.as_ref().map_or([0.0; 2], |image| {
            image.coordinates.at(&self.shape, &intersection, self.shape.point(&ray, &intersection).position)
        });
        let (distance, object) = (intersection.t, Some(self.object));
        Some(LightSample { ray, distance, object, part, pdf: Some(pdf), factor: 1.0, uv })
    }

    /// Returns the pdf per steradian with which the light is sampled from a surface with the given unit normal, along a
    /// ray that first hits it at `intersection`; `None` if the pdf is 0, or if the light is seen exactly edge-on.
    pub(super) fn pdf_at(&self, ray: &Ray, normal: DVec3, intersection: &Intersection) -> Option<f64> {
        valid_pdf(match (self.sphere_and_cap(), &self.parts) {
            (Some((sphere, cap)), _) => sphere.pdf_cap(cap, ray, intersection.t),
            (None, None) => self.pdf_part(ray, intersection),
            (None, Some(parts)) => {
                let two_sided = self.has_visible_backs(ray.origin);
                let probability = parts.probability(intersection.part, ray.origin, normal, two_sided);
                if probability == 0.0 { 0.0 } else { probability * self.pdf_part(ray, intersection) }
            }
        })
    }

    /// Returns the factor of its image on its radiance, a mean weighted by the light of each place; 1 without an image.
    pub fn brightness(&self) -> f64 {
        self.emission_map().map_or(1.0, |map| map.brightness)
    }

    /// Returns the share of its area that would emit as much light at that mean brightness; 1 without an image.
    pub fn bright_share(&self) -> f64 {
        self.emission_map().map_or(1.0, |map| map.mean / map.brightness.max(f64::MIN_POSITIVE))
    }

    /// Returns a ball around the visible part, and the largest area that is seen of it; `None` for an infinite shape.
    pub fn visible_part(&self) -> Option<(Ball, f64)> {
        let own_ball = self.shape.ball()?;
        let size = LightBounds::of_shape(&self.shape, self.sides == Sides::Both)?.intensity;
        let Some(Cone { axis, one_minus_cos }) = self.visible_cap else { return Some((own_ball, size)) };
        let [cos, sin] = [1.0 - one_minus_cos, (one_minus_cos * (2.0 - one_minus_cos)).sqrt()];
        let part = Ball { center: own_ball.center + axis * (own_ball.radius * cos), radius: own_ball.radius * sin };
        Some((part, PI * part.radius * part.radius))
    }

    /// Returns whether photons can be sent from it.
    pub(super) fn sends_photons(&self) -> bool {
        self.image.as_ref().is_none_or(|image| image.map.is_some())
    }

    pub(super) fn beam(&self, ball: &Ball) -> Beam {
        let size = self.visible_part().filter(|_| self.sends_photons()).map_or(0.0, |(_, size)| size);
        let own_ball = self.shape.ball();
        let from = own_ball.map_or(ball.center, |own_ball| own_ball.center);
        let is_outside_ball =
            own_ball.is_some_and(|own_ball| (own_ball.center - ball.center).length() > own_ball.radius + ball.radius);
        let flux = size * TAU * ball.cone_from(from).one_minus_cos;
        Beam { ball: *ball, cone: Cone::ALL, opening: None, flux, is_outside_ball }
    }

    /// Samples a photon from a point to the ball: in the cone that the ball subtends or, from inside, by the cosine.
    pub(super) fn sample_le(&self, ball: &Ball, guide_uv: [f64; 2], u: [f64; 2]) -> Option<LeSample> {
        let surface = self.sample_emission(ball, u)?;
        let point = &surface.point;
        let direction = self.toward(ball, point).sample(guide_uv)?;
        let cos = point.normal.dot(direction);
        let sample = LeSample { ray: point.leave(direction), factor: cos.abs(), surface: Some(surface) };
        self.sides.shine(cos > 0.0).then_some(sample)
    }

    /// Returns the pdf with which `sample_le` draws a photon for a ball, per unit of area and steradian; 0 for a
    /// direction that does not lead there. `guide` is the density of places in the unit square.
    pub(super) fn pdf_le(&self, ball: &Ball, sample: &LeSample, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let Some(EmissionPoint { point, density, .. }) = &sample.surface else { return 0.0 };
        let direction_pdf = self.toward(ball, point).pdf(sample.ray.direction, guide);
        let point_pdf = match (density, self.sphere_and_cap()) {
            (Some(density), _) => *density,
            (None, Some((sphere, cap))) => sphere.pdf_cap_emission(cap, ball, point),
            (None, None) => self.shape.pdf_emission(ball, point),
        };
        direction_pdf * point_pdf
    }

    fn toward<'a>(&self, ball: &'a Ball, point: &SurfacePoint) -> TowardBall<'a> {
        TowardBall { ball, from: point.position, normal: point.normal, front_probability: self.front_probability() }
    }

    /// Samples a point from which light may reach a ball.
    fn sample_emission(&self, ball: &Ball, u: [f64; 2]) -> Option<EmissionPoint> {
        match (&self.image, self.sphere_and_cap()) {
            (Some(image), _) => self.sample_textured(&image.coordinates, u),
            (None, _) if matches!(*self.shape, Shape::Instance(_)) => self.sample_textured(&Coordinates::Mesh, u),
            (None, Some((sphere, cap))) => Some(EmissionPoint::without_image(sphere.sample_cap_emission(cap, ball, u))),
            (None, None) => Some(EmissionPoint::without_image(self.shape.sample_emission(ball, u)?)),
        }
    }

    /// Chooses a part by its flux and samples a point on it: usually where its image is bright, otherwise anywhere.
    fn sample_textured(&self, coordinates: &Coordinates, [u, v]: [f64; 2]) -> Option<EmissionPoint> {
        let surface = TexturedShape { shape: &self.shape, coordinates };
        let whole = DiscreteSample { index: 0, probability: 1.0, u };
        let DiscreteSample { index, probability, u } =
            self.parts.as_ref().map_or(whole, |parts| parts.sample_by_flux(u));
        let (part, cells) = (index as u32, self.cells(index as u32));
        let at = match &cells {
            Some((_, cells)) if u < IMAGE_PROBABILITY => cells.sample_point([u / IMAGE_PROBABILITY, v]),
            Some(_) => [(u - IMAGE_PROBABILITY) / (1.0 - IMAGE_PROBABILITY), v],
            None => [u, v],
        };
        let point = surface.point_at(part, at)?;
        let share = cells.map_or(1.0, |(_, cells)| IMAGE_PROBABILITY * cells.density(at) + 1.0 - IMAGE_PROBABILITY);
        let density = Some(probability * share / surface.area(part, at, point.position)?);
        Some(EmissionPoint { point, uv: surface.coordinates_at(part, at)?, density })
    }

    /// Emits a cosine-distributed light path from a point of the surface, usually of the visible cap of a sphere.
    pub(super) fn emit(&self, [u0, u1, a, b]: [f64; 4]) -> Option<LeSample> {
        let sample = self.sample_le(&INFINITE_BALL, [a, b], [u0, u1])?;
        let factor = sample.factor / self.pdf_le(&INFINITE_BALL, &sample, |_| 1.0);
        (factor > 0.0 && factor.is_finite()).then_some(LeSample { factor, ..sample })
    }

    /// Returns the flux that `emit` sends for a radiance of 1; 0 if it sends none.
    pub(super) fn flux(&self) -> f64 {
        if !self.is_sampled || !self.sends_photons() {
            return 0.0;
        }
        let seen = self.visible_cap.map_or(1.0, |cap| 0.5 * cap.one_minus_cos);
        let sides = if self.sides == Sides::Both && !self.shape.is_closed() { 2.0 } else { 1.0 };
        PI * seen * sides * self.shape.area()
    }

    /// Returns the probability with which a point inside the ball that photons are sent to sends one from its front.
    fn front_probability(&self) -> f64 {
        match (self.sides, self.shape.is_closed()) {
            (Sides::Front, _) => 1.0,
            (Sides::Both, true) => OUTWARD_PROBABILITY,
            (Sides::Both, false) => 0.5,
        }
    }
}

/// A ball that contains everything.
const INFINITE_BALL: Ball = Ball { center: DVec3::ZERO, radius: f64::INFINITY };

/// Probability that a photon leaves a closed lamp from its outer side, where an object is built around the lamp.
const OUTWARD_PROBABILITY: f64 = 0.875;

fn valid_pdf(pdf: f64) -> Option<f64> {
    Some(pdf).filter(|pdf| pdf.is_finite() && *pdf > 0.0)
}
