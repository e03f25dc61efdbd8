//! Shapes as lights: directions toward them, and the parts they are chosen by.

use super::emitters::{Emitter, Facing};
use super::outline::Outline;
use super::{Cap, Crossing, Shape, Triangle};
use crate::math::{DVec3, Ray};

/// A direction in which a shape is seen from a point, drawn at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// Unit vector from the point to the shape.
    pub direction: DVec3,
    /// The part that was drawn, on shapes of several: seen only if the nearest crossing lies on it.
    pub part: Option<u32>,
    /// How densely it was drawn, where that is known before the shape is met.
    pub density: Option<Density>,
}

/// How densely directions toward a shape are drawn from one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Evenly, this many per steradian.
    Angle(f64),
    /// Evenly over the surface, this many per unit of area.
    Area(f64),
}

impl Density {
    /// Per steradian, of a direction that meets the surface at a distance and an angle of this cosine.
    pub fn toward(self, distance: f64, cos: f64) -> f64 {
        match self {
            Self::Angle(density) => density,
            Self::Area(density) => density * distance * distance / cos,
        }
    }

    /// The density of directions drawn only with a probability.
    pub fn times(self, probability: f64) -> Self {
        match self {
            Self::Angle(density) => Self::Angle(density * probability),
            Self::Area(density) => Self::Area(density * probability),
        }
    }

    fn of(outline: Option<&Outline>, area: impl FnOnce() -> f64) -> Self {
        outline.map_or_else(|| Self::Area(1.0 / area()), |outline| Self::Angle(1.0 / outline.solid_angle()))
    }
}

impl Shape {
    /// A direction from a point toward the shape; none where the draw sees it exactly edge-on.
    ///
    /// `pdf_toward` gives its density. Spheres are drawn by the cone they fill, triangles and quads nearby by their solid
    /// angle, other shapes by their area.
    pub fn aim(&self, from: DVec3, u: [f64; 2]) -> Option<Sighting> {
        let (target, part) = match self {
            Self::Plane(_) => return None,
            Self::Sphere(sphere) => {
                let (direction, pdf) = sphere.aim(from, u);
                return Some(Sighting { direction, part: None, density: Some(Density::Angle(pdf)) });
            }
            Self::Triangle(shape) => {
                return sighting(shape.outline(from), || shape.area(), |u| shape.sample(u), from, u);
            }
            Self::Quad(shape) => return sighting(shape.outline(from), || shape.area(), |u| shape.sample(u), from, u),
            Self::Ellipsoid(ellipsoid) => {
                let direction = (ellipsoid.sample(u) - from).try_normalize()?;
                return Some(Sighting { direction, part: None, density: None });
            }
            Self::Disc(disc) => (disc.sample(u), None),
            Self::Cube(cube) => {
                let (target, face) = cube.sample(u);
                (target, Some(face))
            }
            Self::Mesh(mesh) => {
                let (target, triangle) = mesh.sample(u);
                (target, Some(triangle))
            }
            Self::Instance(instance) => {
                let (target, triangle) = instance.sample(u);
                let density = Some(Density::Area(instance.density(triangle)));
                return Some(Sighting { direction: (target - from).try_normalize()?, part: Some(triangle), density });
            }
        };
        let density = Some(Density::Area(1.0 / self.area()));
        Some(Sighting { direction: (target - from).try_normalize()?, part, density })
    }

    /// Density per steradian with which `aim` draws the direction of a ray that first meets the shape at a crossing.
    pub fn pdf_toward(&self, ray: &Ray, crossing: &Crossing) -> f64 {
        let density = match self {
            Self::Plane(_) => return 0.0,
            Self::Sphere(sphere) => return sphere.pdf_toward(ray),
            Self::Ellipsoid(ellipsoid) => return ellipsoid.pdf_toward(ray),
            Self::Triangle(shape) => Density::of(shape.outline(ray.origin).as_ref(), || shape.area()),
            Self::Quad(shape) => Density::of(shape.outline(ray.origin).as_ref(), || shape.area()),
            Self::Disc(_) | Self::Cube(_) | Self::Mesh(_) => Density::Area(1.0 / self.area()),
            Self::Instance(instance) => Density::Area(instance.density(crossing.part)),
        };
        self.pdf(density, ray, crossing)
    }

    /// A direction like `aim`'s, most often toward the cap of a sphere that is likely to be seen; `pdf_at_cap` gives its density.
    pub fn aim_at_cap(&self, cap: &Cap, from: DVec3, u: [f64; 2]) -> Option<Sighting> {
        let Self::Sphere(sphere) = self else { return self.aim(from, u) };
        Some(Sighting { direction: sphere.aim_at_cap(cap, from, u)?, part: None, density: None })
    }

    /// Density per steradian with which `aim_at_cap` draws the direction of a ray that first meets the shape at a crossing.
    pub fn pdf_at_cap(&self, cap: &Cap, ray: &Ray, crossing: &Crossing) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.pdf_at_cap(cap, ray, crossing.t),
            _ => self.pdf_toward(ray, crossing),
        }
    }

    fn pdf(&self, density: Density, ray: &Ray, crossing: &Crossing) -> f64 {
        density.toward(crossing.t, self.point(ray, crossing).normal.dot(ray.direction).abs())
    }

    /// The parts of a shape of several that are aimed at one by one: triangles of a mesh, faces of a cube.
    pub fn parts(&self) -> Vec<Emitter> {
        let part = |bounds, normal, intensity| Emitter { bounds, facing: Facing::one(normal), both: false, intensity };
        match self {
            Self::Cube(cube) => {
                (0..6).map(|i| cube.face(i)).map(|face| part(face.bounds(), face.normal(), face.area())).collect()
            }
            Self::Mesh(mesh) => (0..mesh.len() as u32).map(|i| mesh.triangle(i).emitter()).collect(),
            Self::Instance(instance) => instance.parts(),
            _ => Vec::new(),
        }
    }

    /// A direction from a point toward one of the parts; `pdf_of_part` gives its density.
    pub fn aim_at_part(&self, part: u32, from: DVec3, u: [f64; 2]) -> Option<Sighting> {
        let found = match self {
            Self::Cube(cube) => {
                let face = cube.face(part);
                sighting(face.outline(from), || face.area(), |u| face.sample(u), from, u)
            }
            _ => {
                let shape = self.triangle(part)?;
                sighting(shape.outline(from), || shape.area(), |u| shape.sample(u), from, u)
            }
        };
        found.map(|found| Sighting { part: Some(part), ..found })
    }

    /// Density per steradian with which `aim_at_part` draws the direction of a ray that first meets the part at a crossing.
    pub fn pdf_of_part(&self, ray: &Ray, crossing: &Crossing) -> f64 {
        let density = match self {
            Self::Cube(cube) => {
                let face = cube.face(crossing.part);
                Density::of(face.outline(ray.origin).as_ref(), || face.area())
            }
            _ => match self.triangle(crossing.part) {
                Some(shape) => Density::of(shape.outline(ray.origin).as_ref(), || shape.area()),
                None => return 0.0,
            },
        };
        self.pdf(density, ray, crossing)
    }

    /// A triangle of a mesh, where it stands in the world.
    fn triangle(&self, part: u32) -> Option<Triangle> {
        match self {
            Self::Mesh(mesh) => Some(mesh.triangle(part)),
            Self::Instance(instance) => Some(instance.triangle(part)),
            _ => None,
        }
    }

    /// The shape as one of many that may be aimed at, with its intensity at radiance 1; none if it is infinite.
    ///
    /// A convex body shows a quarter of its area on average (Cauchy 1841).
    pub fn emitter(&self, both: bool) -> Option<Emitter> {
        let facing = match self {
            Self::Triangle(triangle) => Facing::one(triangle.normal()),
            Self::Disc(disc) => Facing::one(disc.normal()),
            Self::Quad(quad) => Facing::one(quad.normal()),
            _ => Facing::ALL,
        };
        let seen = if self.is_closed() { 0.25 } else { 1.0 };
        Some(Emitter { bounds: self.bounds()?, facing, both, intensity: seen * self.area() })
    }
}

/// A direction toward a flat shape, within its outline or through a point drawn by its area.
fn sighting(
    outline: Option<Outline>,
    area: impl FnOnce() -> f64,
    sample: impl FnOnce([f64; 2]) -> DVec3,
    from: DVec3,
    u: [f64; 2],
) -> Option<Sighting> {
    let direction = match &outline {
        Some(outline) => outline.aim(u),
        None => (sample(u) - from).try_normalize()?,
    };
    Some(Sighting { direction, part: None, density: Some(Density::of(outline.as_ref(), area)) })
}
