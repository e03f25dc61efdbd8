use std::sync::Arc;

use super::View;
use crate::math::{Bounds, DVec3, Ray};
use crate::shape::{Cap, Choice, Coordinates, Crossing, Emitters, Shape, Sides, Sighting};
use crate::spectrum::Quantity;

/// A surface that shines: an object whose material emits.
#[derive(Clone, Debug)]
pub struct Area<S> {
    /// The surface.
    pub shape: Arc<Shape>,
    /// The object it belongs to.
    pub object: u32,
    /// What it shows.
    pub radiance: S,
    /// The sides that show it.
    pub sides: Sides,
    /// Whether next-event estimation aims at it: finite `emissive` surfaces. Planes and glowing glass are only met.
    pub aimed_at: bool,
    /// Where its points lie in the image that it shows, if it shows one.
    pub coordinates: Option<Arc<Coordinates>>,
    /// The parts of a shape of several, one of which is aimed at.
    parts: Option<Arc<Emitters>>,
    /// The box from whose outside no backs are seen.
    closed: Option<Bounds>,
    /// All that is seen of a sphere, if that is a small part.
    seen: Option<Cap>,
}

/// The part of a sphere below which that part is aimed at, and not the cone in which the whole is seen.
const SMALL: f64 = 0.125;

impl<S> Area<S> {
    /// The light that an object is.
    pub fn new(shape: Arc<Shape>, object: u32, radiance: S, sides: Sides, aimed_at: bool) -> Self {
        let parts = if aimed_at { shape.parts() } else { Vec::new() };
        let parts = (parts.len() > 1).then(|| Arc::new(Emitters::new(&parts)));
        let closed = if shape.is_closed() { shape.bounds() } else { None };
        Self { shape, object, radiance, sides, aimed_at, coordinates: None, parts, closed, seen: None }
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Area<T> {
        Area {
            shape: self.shape.clone(),
            object: self.object,
            radiance: convert(Quantity::Emission, &self.radiance),
            sides: self.sides,
            aimed_at: self.aimed_at,
            coordinates: self.coordinates.clone(),
            parts: self.parts.clone(),
            closed: self.closed,
            seen: self.seen,
        }
    }

    /// Whether knowing where it is really seen could help: of a sphere that may be a tip.
    pub fn may_hide(&self) -> bool {
        self.aimed_at && matches!(*self.shape, Shape::Sphere(_))
    }

    /// Tells the light the unit normals at which paths met it by chance: if they lie close together, it is aimed at there.
    pub fn remember(&mut self, normals: &[DVec3]) {
        self.seen = Cap::around(normals).filter(|cap| cap.share() < SMALL);
    }

    /// Whether one of several parts is chosen to be aimed at, which uses up digits of a random number.
    pub fn has_parts(&self) -> bool {
        self.parts.is_some()
    }

    /// Whether the backs of parts may be met first: never from outside of a closed body.
    fn shows_backs(&self, from: DVec3) -> bool {
        let outside = |bounds: Bounds| from.cmplt(bounds.min).any() || from.cmpgt(bounds.max).any();
        self.sides == Sides::Both && !self.closed.is_some_and(outside)
    }

    pub(super) fn aim(&self, from: DVec3, normal: DVec3, u: [f64; 2]) -> Option<Sighting> {
        if let Some(cap) = &self.seen {
            return self.shape.aim_at_cap(cap, from, u);
        }
        let Some(parts) = &self.parts else { return self.shape.aim(from, u) };
        let Choice { emitter, probability, u: along } = parts.choose(from, normal, self.shows_backs(from), u[0])?;
        let sighting = self.shape.aim_at_part(emitter, from, [along, u[1]])?;
        Some(Sighting { density: sighting.density.map(|density| density.times(probability)), ..sighting })
    }

    /// Looks for the light exactly as a ray that happens to meet it would: no distance needs a tolerance.
    pub(super) fn view(&self, ray: &Ray, normal: DVec3, sighting: &Sighting) -> Option<View> {
        let crossing = self.shape.intersect(ray, f64::INFINITY)?;
        if sighting.part.is_some_and(|part| part != crossing.part) {
            return None;
        }
        let point = self.shape.point(ray, &crossing);
        let cos = point.normal.dot(ray.direction);
        let pdf = match sighting.density {
            Some(density) => usable(density.toward(crossing.t, cos.abs()))?,
            None => self.pdf(ray, normal, &crossing)?,
        };
        let uv = self
            .coordinates
            .as_ref()
            .map_or([0.0; 2], |coordinates| coordinates.at(&self.shape, &crossing, point.position));
        let view = View { distance: crossing.t, object: Some(self.object), pdf: Some(pdf), factor: 1.0, uv };
        self.sides.shine(cos < 0.0).then_some(view)
    }

    /// Density with which the light is aimed at, from a surface of the given normal, along a ray that meets it; none where
    /// it is seen exactly edge-on.
    pub fn pdf(&self, ray: &Ray, normal: DVec3, crossing: &Crossing) -> Option<f64> {
        usable(match (&self.seen, &self.parts) {
            (Some(cap), _) => self.shape.pdf_at_cap(cap, ray, crossing),
            (None, None) => self.shape.pdf_toward(ray, crossing),
            (None, Some(parts)) => {
                let both = self.shows_backs(ray.origin);
                let probability = parts.probability(crossing.part as usize, ray.origin, normal, both);
                if probability == 0.0 { 0.0 } else { probability * self.shape.pdf_of_part(ray, crossing) }
            }
        })
    }
}

fn usable(pdf: f64) -> Option<f64> {
    Some(pdf).filter(|pdf| pdf.is_finite() && *pdf > 0.0)
}
