//! A shape of any kind.

use std::sync::Arc;

use super::hull::Hull;
use super::polygon::PolygonKind;
use super::{
    Ball, Cube, Density, Disc, Ellipsoid, Instance, Intersection, Mesh, Plane, Polygon, Quad, ShapeSample, Sphere,
    SurfacePoint, Triangle,
};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma, sample_disk, sample_sphere, sample_triangle};

/// A surface.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Shape {
    /// An infinite plane.
    Plane(Plane),
    /// One triangle.
    Triangle(Triangle),
    /// A sphere.
    Sphere(Sphere),
    /// A sphere after a non-uniform scale.
    Ellipsoid(Ellipsoid),
    /// A flat disc or ellipse.
    Disc(Disc),
    /// A parallelogram.
    Quad(Quad),
    /// A box or parallelepiped.
    Cube(Cube),
    /// Many triangles.
    Mesh(Arc<Mesh>),
    /// Many triangles that other instances share.
    Instance(Box<Instance>),
}

impl Shape {
    /// Returns the nearest crossing with 0 < t <= `t_max`.
    pub fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        self.intersect_from(ray, t_max, None)
    }

    /// Returns the nearest crossing with 0 < t <= `t_max` of a ray that may leave the triangle `from` of the shape.
    pub fn intersect_from(&self, ray: &Ray, t_max: f64, from: Option<u32>) -> Option<Intersection> {
        match self {
            Self::Plane(plane) => plane.intersect(ray, t_max),
            Self::Triangle(triangle) => triangle.intersect(ray, t_max),
            Self::Sphere(sphere) => sphere.intersect(ray, t_max),
            Self::Ellipsoid(ellipsoid) => ellipsoid.intersect(ray, t_max),
            Self::Disc(disc) => disc.intersect(ray, t_max),
            Self::Quad(quad) => quad.intersect(ray, t_max),
            Self::Cube(cube) => cube.intersect(ray, t_max),
            Self::Mesh(mesh) => mesh.intersect(ray, t_max, from),
            Self::Instance(instance) => instance.intersect(ray, t_max, from),
        }
    }

    /// Returns whether a ray has a crossing with 0 < t <= `t_max`. The ray may leave the triangle `from` of the shape.
    pub fn is_crossed(&self, ray: &Ray, t_max: f64, from: Option<u32>) -> bool {
        if self.has_triangles() {
            self.are_triangles_crossed(ray, t_max, from, |_, _| true)
        } else {
            self.intersect_from(ray, t_max, None).is_some()
        }
    }

    #[inline(never)]
    fn are_triangles_crossed(
        &self,
        ray: &Ray,
        t_max: f64,
        from: Option<u32>,
        accept: impl Fn(u32, f64) -> bool,
    ) -> bool {
        match self {
            Self::Mesh(mesh) => mesh.is_crossed(ray, t_max, from, accept),
            Self::Instance(instance) => instance.is_crossed(ray, t_max, from, accept),
            _ => false,
        }
    }

    /// Returns the crossing with one triangle of a mesh alone, whatever lies before it. Returns `None` for other
    /// shapes.
    pub fn intersect_triangle(&self, ray: &Ray, part: u32) -> Option<Intersection> {
        let intersection = match self {
            Self::Mesh(mesh) => mesh.triangle(part).intersect(ray, f64::INFINITY),
            Self::Instance(instance) => instance.intersect_part(ray, part),
            _ => None,
        };
        Some(Intersection { part, ..intersection? })
    }

    /// Returns whether `intersect` finds another triangle than `part`, which the ray crosses at t.
    pub fn hides(&self, ray: &Ray, part: u32, t: f64) -> bool {
        self.are_triangles_crossed(ray, t, None, |other, nearer| is_before([other, part], [nearer, t]))
    }

    /// Returns whether the shape is made of triangles, which can be tested one by one.
    pub fn has_triangles(&self) -> bool {
        self.mesh().is_some()
    }

    /// Returns the mesh that the shape is or places.
    pub fn mesh(&self) -> Option<&Arc<Mesh>> {
        match self {
            Self::Mesh(mesh) => Some(mesh),
            Self::Instance(instance) => Some(instance.mesh()),
            _ => None,
        }
    }

    /// Returns the surface point at a crossing that `intersect` found on this ray.
    pub fn point(&self, ray: &Ray, intersection: &Intersection) -> SurfacePoint {
        match self {
            Self::Plane(plane) => plane.point(ray.at(intersection.t)),
            Self::Triangle(triangle) => triangle.point(intersection.uv),
            Self::Sphere(sphere) => sphere.point(ray.at(intersection.t)),
            Self::Ellipsoid(ellipsoid) => ellipsoid.point(ray.at(intersection.t)),
            Self::Disc(Disc { plane }) | Self::Quad(Quad { plane }) => plane.point(intersection.uv),
            Self::Cube(cube) => cube.point(intersection),
            Self::Mesh(mesh) => mesh.point(intersection),
            Self::Instance(instance) => instance.point(intersection),
        }
    }

    /// Returns the geometric unit normal at a crossing.
    pub fn normal(&self, ray: &Ray, intersection: &Intersection) -> DVec3 {
        if let Self::Mesh(mesh) = self {
            mesh.polygon(intersection.part).normal()
        } else {
            self.point(ray, intersection).normal
        }
    }

    /// Returns whether the shape is finite. All shapes except planes are.
    pub fn is_bounded(&self) -> bool {
        !matches!(self, Self::Plane(_))
    }

    /// Returns the box that the shape fills, or `None` for an infinite shape.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Plane(_) => None,
            Self::Triangle(triangle) => Some(triangle.bounds()),
            Self::Sphere(sphere) => Some(sphere.bounds()),
            Self::Ellipsoid(ellipsoid) => Some(ellipsoid.bounds()),
            Self::Disc(disc) => Some(disc.bounds()),
            Self::Quad(quad) => Some(quad.plane.bounds()),
            Self::Cube(cube) => Some(cube.bounds()),
            Self::Mesh(mesh) => Some(mesh.bounds()),
            Self::Instance(instance) => Some(instance.bounds()),
        }
    }

    /// Calls `add` with boxes that together contain the whole shape, if it is finite. There is one box, or several if
    /// the shape is long and diagonal. `shapes` is the number of shapes in the scene.
    pub fn boxes(&self, shapes: usize, mut add: impl FnMut(Bounds)) {
        let Some(whole) = self.bounds() else { return };
        // Points have up to 12 roundings, as many as the boxes.
        let pad = whole.min.abs().max(whole.max.abs()) * gamma(32);
        let hull = match self {
            Self::Ellipsoid(ellipsoid) => Hull::new(ellipsoid.center, ellipsoid.half_axes(), true, pad),
            Self::Disc(Disc { plane }) => Hull::new(plane.center, [plane.u, plane.v, DVec3::ZERO], true, pad),
            Self::Quad(Quad { plane }) => Hull::new(plane.center, [plane.u, plane.v, DVec3::ZERO], false, pad),
            Self::Cube(cube) => Hull::new(cube.center, cube.half_edges, false, pad),
            Self::Instance(instance) => instance.hull(pad),
            Self::Plane(_) | Self::Triangle(_) | Self::Sphere(_) | Self::Mesh(_) => return add(whole),
        };
        match hull.count(shapes) {
            1 => add(whole),
            count => {
                hull.pieces(count)
                    .map(|piece| piece.intersection(whole))
                    .filter(|piece| !piece.is_empty())
                    .for_each(add);
            }
        }
    }

    /// Returns the shape after an invertible affine map.
    #[must_use]
    pub fn transformed(&self, map: &Transform) -> Self {
        if *map == Transform::IDENTITY {
            return self.clone();
        }
        match self {
            Self::Plane(plane) => Self::Plane(plane.transformed(map)),
            Self::Triangle(triangle) => Self::Triangle(triangle.transformed(map)),
            Self::Sphere(sphere) => match sphere.transformed(map) {
                Some(sphere) => Self::Sphere(sphere),
                None => Self::Ellipsoid(sphere.ellipsoid().transformed(map)),
            },
            Self::Ellipsoid(ellipsoid) => Self::Ellipsoid(ellipsoid.transformed(map)),
            Self::Disc(Disc { plane }) => Self::Disc(Disc { plane: plane.transformed(map) }),
            Self::Quad(Quad { plane }) => Self::Quad(Quad { plane: plane.transformed(map) }),
            Self::Cube(cube) => Self::Cube(cube.transformed(map)),
            Self::Mesh(mesh) => Self::Mesh(Arc::new(mesh.transformed(map))),
            Self::Instance(instance) => match instance.transformed(map) {
                Some(instance) => Self::Instance(Box::new(instance)),
                None => Self::Mesh(Arc::new(instance.baked().transformed(map))),
            },
        }
    }

    /// Returns a copy of the shape after an invertible affine map. Copies of a mesh share its triangles.
    #[must_use]
    pub fn copied(&self, map: &Transform) -> Self {
        let shared = match self {
            Self::Mesh(mesh) if *map != Transform::IDENTITY => Instance::new(mesh.clone(), *map),
            _ => None,
        };
        shared.map_or_else(|| self.transformed(map), |instance| Self::Instance(Box::new(instance)))
    }

    /// Returns whether the shape has an inside. A dielectric fills the inside, or the half space behind a plane.
    pub fn is_closed(&self) -> bool {
        match self {
            Self::Plane(_) | Self::Sphere(_) | Self::Ellipsoid(_) | Self::Cube(_) => true,
            Self::Triangle(_) | Self::Disc(_) | Self::Quad(_) => false,
            Self::Mesh(mesh) => mesh.is_closed(),
            Self::Instance(instance) => instance.mesh().is_closed(),
        }
    }

    /// Returns the area, which is infinite for a plane.
    pub fn area(&self) -> f64 {
        match self {
            Self::Plane(_) => f64::INFINITY,
            Self::Triangle(triangle) => triangle.area(),
            Self::Sphere(sphere) => sphere.area(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.area(),
            Self::Disc(disc) => disc.area(),
            Self::Quad(quad) => quad.plane.area(),
            Self::Cube(cube) => cube.area(),
            Self::Mesh(mesh) => mesh.area(),
            Self::Instance(instance) => instance.area(),
        }
    }

    /// Returns the unit normal on the front of a flat shape.
    pub fn flat_normal(&self) -> Option<DVec3> {
        match self {
            Self::Plane(plane) => Some(plane.normal()),
            Self::Triangle(triangle) => Some(triangle.normal()),
            Self::Disc(Disc { plane }) | Self::Quad(Quad { plane }) => Some(plane.normal),
            _ => None,
        }
    }

    /// Returns a ball around the shape: a sphere's own ball, or the ball around the box of another shape. Returns
    /// `None` for an infinite shape.
    pub fn ball(&self) -> Option<Ball> {
        if let Self::Sphere(sphere) = self {
            return Some(sphere.ball());
        }
        self.bounds().as_ref().map(Ball::of_box)
    }

    /// Samples a direction from a point toward the shape. Returns `None` for a plane, or if the sampled point coincides
    /// with `from`.
    ///
    /// Spheres are sampled by the cone that they fill, and triangles and quads nearby by their solid angle. Ellipsoids
    /// are sampled as images of a sphere, and other shapes by their area.
    pub fn sample(&self, from: DVec3, u: [f64; 2]) -> Option<ShapeSample> {
        let (point, part) = match self {
            Self::Plane(_) => return None,
            Self::Sphere(sphere) => return Some(sphere.sample(from, u)),
            Self::Triangle(triangle) => return Polygon(PolygonKind::Triangle(triangle.clone())).sample(from, u),
            Self::Quad(quad) => return Polygon(PolygonKind::Parallelogram(&quad.plane)).sample(from, u),
            Self::Ellipsoid(ellipsoid) => {
                return ShapeSample::along(ellipsoid.point_at(sample_sphere(u)).position - from);
            }
            Self::Disc(disc) => {
                let sample = ShapeSample::along(disc.sample_area(u) - from)?;
                return Some(sample.with_density(Density::Area(1.0 / disc.area())));
            }
            Self::Cube(cube) => cube.sample_area(u),
            Self::Mesh(mesh) => mesh.sample_area(u),
            Self::Instance(instance) => instance.sample_area(u),
        };
        Some(ShapeSample::along(point - from)?.with_part(part).with_density(self.density_of_part(part)))
    }

    /// Returns the density per steradian with which `sample` draws the direction of a ray that first meets the shape at
    /// a crossing.
    pub fn pdf(&self, ray: &Ray, intersection: &Intersection) -> f64 {
        let density = match self {
            Self::Plane(_) => return 0.0,
            Self::Sphere(sphere) => return sphere.pdf(ray),
            Self::Ellipsoid(ellipsoid) => return ellipsoid.pdf(ray),
            Self::Triangle(triangle) => Polygon(PolygonKind::Triangle(triangle.clone())).density(ray.origin),
            Self::Quad(quad) => Polygon(PolygonKind::Parallelogram(&quad.plane)).density(ray.origin),
            Self::Disc(_) | Self::Cube(_) | Self::Mesh(_) | Self::Instance(_) => {
                self.density_of_part(intersection.part)
            }
        };
        self.toward(density, ray, intersection)
    }

    /// Returns the density with which the area of a part is sampled.
    fn density_of_part(&self, part: u32) -> Density {
        match self {
            Self::Instance(instance) => Density::Area(instance.density(part)),
            _ => Density::Area(1.0 / self.area()),
        }
    }

    fn toward(&self, density: Density, ray: &Ray, intersection: &Intersection) -> f64 {
        density.toward(intersection.t, self.normal(ray, intersection).dot(ray.direction).abs())
    }

    /// Returns the number of parts that can be sampled one by one: triangles of a mesh or faces of a cube, 0 for other
    /// shapes.
    pub fn part_count(&self) -> u32 {
        match self {
            Self::Cube(_) => 6,
            _ => self.mesh().map_or(0, |mesh| mesh.count()),
        }
    }

    /// Returns one of the parts in the world, or `None` if the shape has no parts.
    pub fn part(&self, part: u32) -> Option<Polygon<'_>> {
        match self {
            Self::Cube(cube) => Some(Polygon(PolygonKind::Parallelogram(cube.face(part)))),
            Self::Mesh(mesh) => Some(mesh.polygon(part)),
            Self::Instance(instance) => Some(Polygon(PolygonKind::Triangle(instance.triangle(part)))),
            _ => None,
        }
    }

    /// Returns the flat polygons that the shape consists of: its parts, or itself. There are none if it is round.
    pub fn polygons(&self) -> impl Iterator<Item = Polygon<'_>> {
        let own = match self {
            Self::Quad(Quad { plane }) => Some(Polygon(PolygonKind::Parallelogram(plane))),
            Self::Triangle(triangle) => Some(Polygon(PolygonKind::Triangle(triangle.clone()))),
            _ => None,
        };
        own.into_iter().chain((0..self.part_count()).filter_map(|part| self.part(part)))
    }

    /// Samples a direction from a point toward one of the parts.
    pub fn sample_part(&self, part: u32, from: DVec3, u: [f64; 2]) -> Option<ShapeSample> {
        Some(self.part(part)?.sample(from, u)?.with_part(part))
    }

    /// Returns the density per steradian with which `sample_part` draws the direction of a ray that first meets the
    /// part at a crossing.
    pub fn pdf_part(&self, ray: &Ray, intersection: &Intersection) -> f64 {
        let part = self.part(intersection.part);
        part.map_or(0.0, |part| self.toward(part.density(ray.origin), ray, intersection))
    }

    /// Samples a point from which light may reach a ball. Returns `None` for an infinite shape, and for an instance,
    /// whose triangles are sampled one by one.
    ///
    /// On a sphere, the point lies in the cap that sees some of the ball. On other shapes, it lies anywhere on the
    /// surface.
    pub fn sample_emission(&self, toward: &Ball, u: [f64; 2]) -> Option<SurfacePoint> {
        Some(match self {
            Self::Plane(_) | Self::Instance(_) => return None,
            Self::Triangle(triangle) => triangle.point(sample_triangle(u)),
            Self::Sphere(sphere) => sphere.sample_emission(toward, u),
            Self::Ellipsoid(ellipsoid) => ellipsoid.point_at(sample_sphere(u)),
            Self::Disc(disc) => disc.plane.point(sample_disk(u).into()),
            Self::Quad(quad) => quad.plane.point(u.map(|x| 2.0 * x - 1.0)),
            Self::Cube(cube) => {
                let (face, along) = cube.choose_part(u[0]);
                cube.face(face).point([2.0 * along - 1.0, 2.0 * u[1] - 1.0])
            }
            Self::Mesh(mesh) => {
                let (triangle, along) = mesh.choose_part(u[0]);
                mesh.triangle(triangle).point(sample_triangle([along, u[1]]))
            }
        })
    }

    /// Returns whether shading normals may differ from geometric normals.
    pub fn is_smooth(&self) -> bool {
        self.mesh().is_some_and(|mesh| mesh.is_smooth())
    }

    /// Returns the density per unit area with which `sample_emission` draws a point of the shape for a ball.
    pub fn pdf_emission(&self, toward: &Ball, point: &SurfacePoint) -> f64 {
        match self {
            Self::Sphere(sphere) => sphere.pdf_emission(toward, point),
            Self::Ellipsoid(ellipsoid) => ellipsoid.area_density(ellipsoid.to_unit_sphere(point.position)),
            _ => 1.0 / self.area(),
        }
    }
}

/// Returns whether a ray meets the first of two triangles before the second, given the t at which it crosses each. If
/// both are equally near, it meets the one that is listed first.
pub fn is_before(parts: [u32; 2], t: [f64; 2]) -> bool {
    parts[0] != parts[1] && (t[0] < t[1] || t[0] == t[1] && parts[0] < parts[1])
}
