//! The unit square on shapes with images, by which such lamps are sampled.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::mem::discriminant;
use std::sync::Arc;

use super::{Coordinates, Disc, Intersection, Quad, Shape, SurfacePoint};
use crate::math::{DVec3, Ray, disk_in_square, square_around_disk, triangle_coordinates, triangle_square};

/// A place of the unit square on a part of a shape.
///
/// On quads, spheres and the squares around discs it is where the image lies, once; faces of cubes may be turned, and
/// triangles are folded open into squares.
#[derive(Clone, Copy, Debug)]
pub struct TexturedPoint {
    /// In the square, 0 to 1 each way.
    pub at: [f64; 2],
    /// Area of the surface there for one of the square.
    pub area: f64,
}

/// A shape, and where its points lie in an image on it.
#[derive(Clone, Copy, Debug)]
pub struct TexturedShape<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Where its points lie.
    pub coordinates: &'a Coordinates,
}

impl TexturedShape<'_> {
    /// The point of a part for a place of the square; none beside a disc, and on a plane.
    pub fn point_at(&self, part: u32, place: [f64; 2]) -> Option<SurfacePoint> {
        Some(match (self.coordinates, self.shape) {
            (Coordinates::Sphere { inverse, .. }, Shape::Sphere(sphere)) => {
                sphere.point(sphere.over((inverse.inverse() * on_unit_sphere(place)).normalize()))
            }
            (_, Shape::Ellipsoid(ellipsoid)) => ellipsoid.point_at(on_unit_sphere(place)),
            _ => self.shape.point(&NO_RAY, &self.crossing_at(part, place)?),
        })
    }

    /// The coordinates (u, v) for a place of the square; none beside a disc, and on a plane.
    pub fn coordinates_at(&self, part: u32, place: [f64; 2]) -> Option<[f64; 2]> {
        match self.coordinates {
            Coordinates::Sphere { .. } => Some(place),
            _ => Some(self.at(&self.crossing_at(part, place)?)),
        }
    }

    fn at(&self, intersection: &Intersection) -> [f64; 2] {
        self.coordinates.at(self.shape, intersection, DVec3::ZERO)
    }

    /// The crossing of no distance with a flat part.
    fn crossing_at(&self, part: u32, place: [f64; 2]) -> Option<Intersection> {
        let uv = match self.coordinates {
            Coordinates::Square if matches!(self.shape, Shape::Disc(_)) => disk_in_square(place)?,
            Coordinates::Square | Coordinates::Cube => place.map(|x| 2.0 * x - 1.0),
            Coordinates::Triangle { .. } | Coordinates::Mesh => triangle_coordinates(place),
            Coordinates::Sphere { .. } | Coordinates::Plane { .. } => return None,
        };
        Some(Intersection { t: 0.0, part, uv })
    }

    /// Where the square lies at a crossing of the shape, whose point in the world is known; none on a plane.
    pub fn place(&self, intersection: &Intersection, position: DVec3) -> Option<TexturedPoint> {
        let at = match self.coordinates {
            Coordinates::Square if matches!(self.shape, Shape::Disc(_)) => square_around_disk(intersection.uv)?,
            Coordinates::Square | Coordinates::Cube => intersection.uv.map(|x| 0.5 + 0.5 * x),
            Coordinates::Triangle { .. } | Coordinates::Mesh => triangle_square(intersection.uv),
            Coordinates::Sphere { .. } => self.coordinates.at(self.shape, intersection, position),
            Coordinates::Plane { .. } => return None,
        };
        Some(TexturedPoint { at, area: self.area(intersection.part, at, position)? })
    }

    /// Area of a part for one of the square at a place, which is a point of the world; none of a plane.
    pub fn area(&self, part: u32, place: [f64; 2], position: DVec3) -> Option<f64> {
        Some(match self.shape {
            Shape::Disc(Disc { plane }) | Shape::Quad(Quad { plane }) => plane.area(),
            Shape::Cube(_) | Shape::Mesh(_) | Shape::Instance(_) => self.shape.part(part)?.area(),
            Shape::Triangle(triangle) => triangle.area(),
            Shape::Sphere(sphere) => sphere.area() * self.growth(place),
            Shape::Ellipsoid(ellipsoid) => self.growth(place) / ellipsoid.density_over(ellipsoid.unit_of(position)),
            Shape::Plane(_) => return None,
        })
    }

    /// How much of the area of a part an area of the square stands for at a place, on a sphere before it was stretched:
    /// 1 on average, less near the poles.
    pub fn growth(&self, [_, v]: [f64; 2]) -> f64 {
        if matches!(self.coordinates, Coordinates::Sphere { .. }) { FRAC_PI_2 * libm::sin(PI * v) } else { 1.0 }
    }

    /// How far the two edges of the square reach in the image, by u and by v each.
    pub fn edges(&self, part: u32) -> [[f64; 2]; 2] {
        let corner = |uv| self.at(&Intersection { t: 0.0, part, uv });
        let between = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [(c - a).abs(), (d - b).abs()];
        match self.coordinates {
            Coordinates::Square | Coordinates::Sphere { .. } | Coordinates::Plane { .. } => [[1.0, 0.0], [0.0, 1.0]],
            Coordinates::Triangle { .. } | Coordinates::Mesh => {
                let first = corner([0.0, 0.0]);
                [[1.0, 0.0], [0.0, 1.0]].map(|uv| between(first, corner(uv)))
            }
            Coordinates::Cube => {
                let first = corner([-1.0, -1.0]);
                [[1.0, -1.0], [-1.0, 1.0]].map(|uv| between(first, corner(uv)))
            }
        }
    }

    /// Whether a point of a round shape lies behind a nearer one, seen from a point.
    pub fn is_behind(&self, point: &SurfacePoint, from: DVec3) -> bool {
        let outside = match self.shape {
            Shape::Sphere(sphere) => sphere.is_outside(from),
            Shape::Ellipsoid(ellipsoid) => ellipsoid.is_outside(from),
            _ => false,
        };
        outside && point.normal.dot(point.position - from) >= 0.0
    }

    /// Whether an image lies on two shapes alike, however they are placed.
    pub fn is_like(&self, other: &TexturedShape) -> bool {
        let mesh = |shape: &Shape| shape.mesh().map(Arc::as_ptr);
        match (self.coordinates, other.coordinates) {
            (Coordinates::Square, Coordinates::Square) => discriminant(self.shape) == discriminant(other.shape),
            (Coordinates::Mesh, Coordinates::Mesh) => mesh(self.shape) == mesh(other.shape),
            (Coordinates::Triangle { .. }, Coordinates::Triangle { .. }) => self.coordinates == other.coordinates,
            (Coordinates::Cube, Coordinates::Cube) | (Coordinates::Sphere { .. }, Coordinates::Sphere { .. }) => true,
            _ => false,
        }
    }
}

/// Flat shapes and meshes know their points by the crossing alone.
const NO_RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };

/// The point of the unit sphere at a longitude and a latitude of an image.
fn on_unit_sphere([u, v]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (radius, height)) = (libm::sincos(TAU * (u - 0.5)), libm::sincos(PI * v));
    DVec3::new(radius * sin, -height, radius * cos)
}
