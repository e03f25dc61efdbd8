use super::affine_plane::AffinePlane;
use super::outline::Outline;
use super::triangle::Facet;
use super::{Density, ShapeSample, Triangle};
use crate::math::{Bounds, DVec3};

/// A flat piece of a surface with straight edges: a shape of its own, or a part of a mesh or a cube.
#[derive(Clone, Debug)]
pub enum Polygon<'a> {
    /// A triangle, where it stands in the world.
    Triangle(Triangle),
    /// The same, kept by its mesh.
    Facet(&'a Facet),
    /// The unit square of a plane.
    Parallelogram(&'a AffinePlane),
}

impl Polygon<'_> {
    /// The box that it fills.
    pub fn bounds(&self) -> Bounds {
        match self {
            Self::Triangle(triangle) | Self::Facet(Facet { triangle, .. }) => triangle.bounds(),
            Self::Parallelogram(plane) => plane.bounds(),
        }
    }

    /// Unit normal of its front.
    pub fn normal(&self) -> DVec3 {
        match self {
            Self::Triangle(triangle) => triangle.normal(),
            Self::Facet(facet) => facet.normal,
            Self::Parallelogram(plane) => plane.normal,
        }
    }

    /// Its area, in square scene units.
    pub fn area(&self) -> f64 {
        match self {
            Self::Triangle(triangle) => triangle.area(),
            Self::Facet(facet) => facet.area,
            Self::Parallelogram(plane) => plane.area(),
        }
    }

    /// A direction from a point toward it: evenly over its solid angle nearby, through a point drawn by area far away.
    pub(super) fn sample(&self, from: DVec3, u: [f64; 2]) -> Option<ShapeSample> {
        if let Some(outline) = self.outline(from) {
            return Some(ShapeSample::of_direction(outline.sample(u), 1.0 / outline.solid_angle));
        }
        let point = match self {
            Self::Triangle(triangle) | Self::Facet(Facet { triangle, .. }) => triangle.sample_area(u),
            Self::Parallelogram(plane) => plane.sample_area(u),
        };
        Some(ShapeSample::along(point - from)?.with_density(Density::Area(1.0 / self.area())))
    }

    /// How densely `sample` draws from a point.
    pub(super) fn density(&self, from: DVec3) -> Density {
        match self.outline(from) {
            Some(outline) => Density::SolidAngle(1.0 / outline.solid_angle),
            None => Density::Area(1.0 / self.area()),
        }
    }

    fn outline(&self, from: DVec3) -> Option<Outline> {
        match self {
            Self::Triangle(triangle) => triangle.outline(from),
            Self::Facet(facet) => facet.outline(from),
            Self::Parallelogram(plane) => plane.outline(from),
        }
    }
}
