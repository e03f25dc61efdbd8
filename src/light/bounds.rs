//! Where lights are, how large they are and which way they face.
//!
//! Conty Estevez & Kulla 2018, *Importance Sampling of Many Lights with Adaptive Tree Splitting*, section 4.

use std::f64::consts::PI;

use crate::math::{Bounds, DVec3};
use crate::shape::{Polygon, Shape};

/// What a light tree uses of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// The box around it.
    pub bounds: Bounds,
    /// The unit normal of its front; `None` if it faces all directions.
    pub normal: Option<DVec3>,
    /// Whether its back shines as well.
    pub two_sided: bool,
    /// Radiance times the area seen from the best direction, 0 or more.
    pub intensity: f64,
}

/// Several lights taken as one.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightGroup {
    /// The box around them.
    pub bounds: Bounds,
    /// The box around their unit normals.
    normals: Bounds,
    /// Whether the back of any of them shines.
    pub two_sided: bool,
    pub intensity: f64,
}

impl LightBounds {
    /// Bounds a shape of radiance 1; `None` if it is infinite.
    ///
    /// A convex body shows a quarter of its area on average (Cauchy 1841).
    pub(super) fn of_shape(shape: &Shape, two_sided: bool) -> Option<Self> {
        let visible_share = if shape.is_closed() { 0.25 } else { 1.0 };
        let intensity = visible_share * shape.area();
        Some(Self { bounds: shape.bounds()?, normal: shape.flat_normal(), two_sided, intensity })
    }

    /// Bounds a part of a shape that shines from its front, with radiance 1.
    pub fn of_part(part: &Polygon) -> Self {
        Self { bounds: part.bounds(), normal: Some(part.normal()), two_sided: false, intensity: part.area() }
    }

    /// Bounds a point that shines in all directions, with intensity 1.
    pub(super) fn of_point(position: DVec3) -> Self {
        Self { bounds: Bounds::around([position]), normal: None, two_sided: false, intensity: 1.0 }
    }
}

impl LightGroup {
    /// The group of no lights.
    pub const EMPTY: Self = Self { bounds: Bounds::EMPTY, normals: Bounds::EMPTY, two_sided: false, intensity: 0.0 };

    /// Returns the group with one more light.
    pub fn with_light(&self, light: &LightBounds) -> Self {
        let normals = match light.normal {
            Some(normal) => Bounds::around([normal]),
            None => Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE },
        };
        let LightBounds { bounds, two_sided, intensity, .. } = *light;
        self.union(&Self { bounds, normals, two_sided, intensity })
    }

    /// Returns both groups as one.
    pub fn union(&self, other: &Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            normals: self.normals.union(other.normals),
            two_sided: self.two_sided || other.two_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    /// Returns the middle of all normals, if there is one.
    pub fn axis(&self) -> Option<DVec3> {
        self.normals.center().try_normalize()
    }

    /// Returns the paper's cost of a group with this intensity, this size of box and this spread of normals.
    pub fn cost(&self) -> f64 {
        let edges = self.bounds.size();
        let area = edges.x * edges.y + edges.y * edges.z + edges.z * edges.x;
        // Lamps on a line or in a point have no area: the lengths of their boxes tell them apart.
        self.intensity * (area + 1e-6 * edges.length_squared()) * orientation_measure(self.min_cosine())
    }

    /// Returns a lower bound for the cosine between the middle of all normals and any of them.
    ///
    /// A unit vector n no farther than r from c has r^2 >= 1 + |c|^2 - 2 c . n.
    fn min_cosine(&self) -> f64 {
        let center = self.normals.center();
        let corner = self.normals.max - center;
        let length = center.length();
        let cosine_bound = 0.5 * (1.0 + length * length - corner.length_squared()) / length;
        if cosine_bound > -1.0 { cosine_bound.min(1.0) } else { -1.0 }
    }
}

/// Returns the paper's measure of orientations within an angle of an axis, given by its cosine, for lights whose
/// emission falls off with the cosine. The integral is solved for angles below and above a right angle.
fn orientation_measure(cos: f64) -> f64 {
    let sin = (1.0 - cos * cos).sqrt();
    if cos >= 0.0 {
        2.0 * PI - PI * cos + 0.5 * PI * PI * sin
    } else {
        2.0 * PI * (1.0 - cos) + PI * libm::acos(-cos) * sin
    }
}
