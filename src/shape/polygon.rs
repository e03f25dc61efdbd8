use super::affine_plane::AffinePlane;
use super::outline::Outline;
use super::triangle::Facet;
use super::{Density, ShapeSample, Triangle};
use crate::math::{Bounds, DVec3};

/// A flat piece of a surface with straight edges: a shape of its own, or a part of a mesh or a cube.
#[derive(Clone, Debug)]
pub struct Polygon<'a>(pub(super) PolygonKind<'a>);

/// The kinds of polygons, by what is known of them in advance.
#[derive(Clone, Debug)]
pub(super) enum PolygonKind<'a> {
    /// A triangle, placed in the world.
    Triangle(Triangle),
    /// A triangle that its mesh keeps, precomputed.
    Facet(&'a Facet),
    /// The parallelogram |a| <= 1, |b| <= 1 of a plane.
    Parallelogram(&'a AffinePlane),
}

impl Polygon<'_> {
    /// Returns the box that the polygon fills.
    pub fn bounds(&self) -> Bounds {
        match &self.0 {
            PolygonKind::Triangle(triangle) | PolygonKind::Facet(Facet { triangle, .. }) => triangle.bounds(),
            PolygonKind::Parallelogram(plane) => plane.bounds(),
        }
    }

    /// Returns the corners of one or two triangles that fill the polygon.
    pub fn triangles(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let (first, second) = match &self.0 {
            PolygonKind::Triangle(triangle) | PolygonKind::Facet(Facet { triangle, .. }) => (triangle.points, None),
            PolygonKind::Parallelogram(AffinePlane { center, u, v, .. }) => {
                let [a, b, c, d] = [*u + *v, *u - *v, -*u - *v, *v - *u].map(|arm| *center + arm);
                ([a, b, c], Some([c, d, a]))
            }
        };
        std::iter::once(first).chain(second)
    }

    /// Returns the unit normal on the front.
    pub fn normal(&self) -> DVec3 {
        match &self.0 {
            PolygonKind::Triangle(triangle) => triangle.normal(),
            PolygonKind::Facet(facet) => facet.normal,
            PolygonKind::Parallelogram(plane) => plane.normal,
        }
    }

    /// Returns the area in square scene units.
    pub fn area(&self) -> f64 {
        match &self.0 {
            PolygonKind::Triangle(triangle) => triangle.area(),
            PolygonKind::Facet(facet) => facet.area,
            PolygonKind::Parallelogram(plane) => plane.area(),
        }
    }

    /// Samples a direction from a point toward the polygon: uniformly in solid angle if it is near, through a point
    /// sampled by area if it is far away.
    pub(super) fn sample(&self, from: DVec3, u: [f64; 2]) -> Option<ShapeSample> {
        if let Some(outline) = self.outline(from) {
            return Some(ShapeSample::of_direction(outline.sample(u), 1.0 / outline.solid_angle));
        }
        let point = match &self.0 {
            PolygonKind::Triangle(triangle) | PolygonKind::Facet(Facet { triangle, .. }) => triangle.sample_area(u),
            PolygonKind::Parallelogram(plane) => plane.sample_area(u),
        };
        Some(ShapeSample::along(point - from)?.with_density(Density::Area(1.0 / self.area())))
    }

    /// Returns the density with which `sample` draws from a point.
    pub(super) fn density(&self, from: DVec3) -> Density {
        match self.outline(from) {
            Some(outline) => Density::SolidAngle(1.0 / outline.solid_angle),
            None => Density::Area(1.0 / self.area()),
        }
    }

    fn outline(&self, from: DVec3) -> Option<Outline> {
        match &self.0 {
            PolygonKind::Triangle(triangle) => triangle.outline(from),
            PolygonKind::Facet(facet) => facet.outline(from),
            PolygonKind::Parallelogram(plane) => plane.outline(from),
        }
    }
}
