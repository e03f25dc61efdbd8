//! Where lights are, how large they are and which way they face.
//!
//! Conty Estevez & Kulla 2018, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, section 4.

use std::f64::consts::PI;

use crate::math::{Bounds, DVec3};
use crate::shape::{Polygon, Shape};

/// What a tree knows of a light, or of several as one.
#[derive(Clone, Copy, Debug)]
pub struct LightBounds {
    /// The box that it fills.
    pub bounds: Bounds,
    /// Unit normals of its front.
    pub normals: NormalCone,
    /// Whether its back shines as well.
    pub two_sided: bool,
    /// Radiance times the area seen from where it is seen best, 0 or more.
    pub intensity: f64,
}

/// Unit normals within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalCone {
    pub(super) axis: DVec3,
    /// In radians, 0 to pi.
    pub(super) angle: f64,
}

impl NormalCone {
    /// Every normal.
    pub const ALL: Self = Self { axis: DVec3::Z, angle: PI };

    /// One normal.
    pub fn one(normal: DVec3) -> Self {
        Self { axis: normal, angle: 0.0 }
    }

    /// The normal in the middle.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// The narrowest cone around both that contains their axes' great circle: algorithm 1 of Conty Estevez & Kulla
    /// 2018.
    pub fn union(self, other: Self) -> Self {
        let (wide, narrow) = if self.angle >= other.angle { (self, other) } else { (other, self) };
        if wide.angle >= PI {
            return Self::ALL;
        }
        let sin = wide.axis.cross(narrow.axis).length();
        let between = libm::atan2(sin, wide.axis.dot(narrow.axis));
        if between + narrow.angle <= wide.angle {
            return wide;
        }
        // A little wider, so that rounding leaves no axis out.
        let angle = 0.5 * (wide.angle + between + narrow.angle) + 1e-12;
        if angle >= PI || sin == 0.0 && between > 1.0 {
            return Self::ALL;
        }
        if sin == 0.0 {
            return Self { angle, ..wide };
        }
        let turn = angle - wide.angle;
        let axis = wide.axis * (libm::sin(between - turn) / sin) + narrow.axis * (libm::sin(turn) / sin);
        match axis.try_normalize() {
            Some(axis) => Self { axis, angle },
            None => Self::ALL,
        }
    }

    /// The paper's measure of orientations, for lights that shine by the cosine.
    fn measure(&self) -> f64 {
        let widest = (self.angle + 0.5 * PI).min(PI);
        let (sin, cos) = libm::sincos(self.angle);
        let beyond = 2.0 * widest * sin - libm::cos(self.angle - 2.0 * widest) - 2.0 * self.angle * sin + cos;
        2.0 * PI * (1.0 - cos) + 0.5 * PI * beyond
    }
}

impl LightBounds {
    /// A shape of radiance 1; none of an infinite one.
    ///
    /// A convex body shows a quarter of its area on average (Cauchy 1841).
    pub fn of_shape(shape: &Shape, two_sided: bool) -> Option<Self> {
        let normals = shape.flat_normal().map_or(NormalCone::ALL, NormalCone::one);
        let seen = if shape.is_closed() { 0.25 } else { 1.0 };
        Some(Self { bounds: shape.bounds()?, normals, two_sided, intensity: seen * shape.area() })
    }

    /// A part of a shape, of radiance 1, that shines from its front.
    pub fn of_part(part: &Polygon) -> Self {
        let normals = NormalCone::one(part.normal());
        Self { bounds: part.bounds(), normals, two_sided: false, intensity: part.area() }
    }

    /// A point that shines in all directions with an intensity of 1.
    pub fn of_point(position: DVec3) -> Self {
        Self { bounds: Bounds::around([position]), normals: NormalCone::ALL, two_sided: false, intensity: 1.0 }
    }

    /// Both as one.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            normals: self.normals.union(other.normals),
            two_sided: self.two_sided || other.two_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    /// The paper's cost of holding so much light in so large a box, facing so many ways.
    pub(super) fn cost(&self) -> f64 {
        let edges = self.bounds.max - self.bounds.min;
        let area = edges.x * edges.y + edges.y * edges.z + edges.z * edges.x;
        // Lamps on a line or in a point have no area; their length tells them apart.
        self.intensity * (area + 1e-6 * edges.length_squared()) * self.normals.measure()
    }
}
