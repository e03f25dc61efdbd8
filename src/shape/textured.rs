//! Maps of the unit square to shapes with images, by which lamps with images are sampled.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::mem::discriminant;
use std::sync::Arc;

use super::{Coordinates, Disc, Intersection, Quad, Shape, SurfacePoint};
use crate::math::{DVec3, Ray, disk_to_square, sample_triangle, square_to_disk, triangle_to_square};

/// A point of the unit square, which is mapped to a part of a shape.
///
/// On quads, spheres and the squares around discs, the unit square is where the image lies, once. Faces of cubes may be
/// rotated, and triangles are unfolded into squares.
#[derive(Clone, Copy, Debug)]
pub struct TexturedPoint {
    /// Position in the square, 0 to 1 each way.
    pub at: [f64; 2],
    /// Area of the surface per unit area of the square at this point.
    pub area: f64,
}

/// A shape with its texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct TexturedShape<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// Texture coordinates of the shape's points.
    pub coordinates: &'a Coordinates,
}

impl TexturedShape<'_> {
    /// Returns the point of a part for a point of the square. Returns `None` outside a disc, and for a plane.
    pub fn point_at(&self, part: u32, place: [f64; 2]) -> Option<SurfacePoint> {
        Some(match (self.coordinates, self.shape) {
            (Coordinates::Sphere { inverse, .. }, Shape::Sphere(sphere)) => {
                sphere.point(sphere.position_at((inverse.inverse() * on_unit_sphere(place)).normalize()))
            }
            (_, Shape::Ellipsoid(ellipsoid)) => ellipsoid.point_at(on_unit_sphere(place)),
            _ => self.shape.point(&NO_RAY, &self.crossing_at(part, place)?),
        })
    }

    /// Returns the coordinates (u, v) for a point of the square. Returns `None` outside a disc, and for a plane.
    pub fn coordinates_at(&self, part: u32, place: [f64; 2]) -> Option<[f64; 2]> {
        match self.coordinates {
            Coordinates::Sphere { .. } => Some(place),
            _ => Some(self.at(&self.crossing_at(part, place)?)),
        }
    }

    fn at(&self, intersection: &Intersection) -> [f64; 2] {
        self.coordinates.at(self.shape, intersection, DVec3::ZERO)
    }

    /// Returns the crossing with a flat part, at distance 0.
    fn crossing_at(&self, part: u32, place: [f64; 2]) -> Option<Intersection> {
        let uv = match self.coordinates {
            Coordinates::Square if matches!(self.shape, Shape::Disc(_)) => square_to_disk(place)?,
            Coordinates::Square | Coordinates::Cube => place.map(|x| 2.0 * x - 1.0),
            Coordinates::Triangle { .. } | Coordinates::Mesh => sample_triangle(place),
            Coordinates::Sphere { .. } | Coordinates::Plane { .. } => return None,
        };
        Some(Intersection { t: 0.0, part, uv })
    }

    /// Returns the point of the square at a crossing of the shape, or `None` for a plane. `position` is the crossing in
    /// the world.
    pub fn place(&self, intersection: &Intersection, position: DVec3) -> Option<TexturedPoint> {
        let at = match self.coordinates {
            Coordinates::Square if matches!(self.shape, Shape::Disc(_)) => disk_to_square(intersection.uv)?,
            Coordinates::Square | Coordinates::Cube => intersection.uv.map(|x| 0.5 + 0.5 * x),
            Coordinates::Triangle { .. } | Coordinates::Mesh => triangle_to_square(intersection.uv),
            Coordinates::Sphere { .. } => self.coordinates.at(self.shape, intersection, position),
            Coordinates::Plane { .. } => return None,
        };
        Some(TexturedPoint { at, area: self.area(intersection.part, at, position)? })
    }

    /// Returns the area of a part per unit area of the square at a point `place`, which is at `position` in the world.
    /// Returns `None` for a plane.
    pub fn area(&self, part: u32, place: [f64; 2], position: DVec3) -> Option<f64> {
        Some(match self.shape {
            Shape::Disc(Disc { plane }) | Shape::Quad(Quad { plane }) => plane.area(),
            Shape::Cube(_) | Shape::Mesh(_) | Shape::Instance(_) => self.shape.part(part)?.area(),
            Shape::Triangle(triangle) => triangle.area(),
            Shape::Sphere(sphere) => sphere.area() * self.growth(place),
            Shape::Ellipsoid(ellipsoid) => {
                self.growth(place) / ellipsoid.area_density(ellipsoid.to_unit_sphere(position))
            }
            Shape::Plane(_) => return None,
        })
    }

    /// Returns the share of a part's area per unit area of the square at a point: 1 on average, less near the poles of
    /// a sphere. For an ellipsoid, it refers to the sphere before it was stretched.
    pub fn growth(&self, [_, v]: [f64; 2]) -> f64 {
        if matches!(self.coordinates, Coordinates::Sphere { .. }) { FRAC_PI_2 * libm::sin(PI * v) } else { 1.0 }
    }

    /// Returns how far the two edges of the square reach in the image, each along u and along v.
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

    /// Returns whether a point of a round shape lies behind a nearer one, as seen from another point.
    pub fn is_behind(&self, point: &SurfacePoint, from: DVec3) -> bool {
        let outside = match self.shape {
            Shape::Sphere(sphere) => sphere.is_outside(from),
            Shape::Ellipsoid(ellipsoid) => ellipsoid.is_outside(from),
            _ => false,
        };
        outside && point.normal.dot(point.position - from) >= 0.0
    }

    /// Returns whether an image lies on two shapes in the same way, however they are placed.
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

/// A placeholder: the points of flat shapes and meshes depend on the crossing alone.
const NO_RAY: Ray = Ray { origin: DVec3::ZERO, direction: DVec3::Z };

/// Returns the point of the unit sphere at a longitude and a latitude of an image.
fn on_unit_sphere([u, v]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (radius, height)) = (libm::sincos(TAU * (u - 0.5)), libm::sincos(PI * v));
    DVec3::new(radius * sin, -height, radius * cos)
}
