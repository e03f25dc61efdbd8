use std::f64::consts::PI;

use super::Intersection;
use super::affine_plane::AffinePlane;
use crate::math::{Bounds, DMat3, DVec3, Ray, horizontal_tangent, sample_disk};

/// A flat disc; its front is the side `normal` points to. A non-uniform scale makes it an ellipse.
///
/// Its coordinates (u, v) run from -1 to 1 along the radius `u` and along the radius perpendicular to it,
/// counterclockwise as seen from the front.
///
/// ```toml
/// shape.disc = { center = [0, 0, 0], normal = [0, 1, 0], radius = 1, u = [1, 0, 0] }    # u is optional
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    /// The plane of the disc, which fills the plane's unit circle.
    pub(super) plane: AffinePlane,
}

impl Disc {
    /// Creates a disc with a normal of any length above 0. `u` gives the direction of the first coordinate, and is made
    /// perpendicular to the normal. Without `u`, images stand upright, as on a plane. Returns `None` if `u` is parallel
    /// to the normal.
    pub fn new(center: DVec3, normal: DVec3, radius: f64, u: Option<DVec3>) -> Option<Self> {
        let normal = normal.normalize();
        let u = match u {
            Some(u) => {
                let u = u.normalize();
                (u - normal * u.dot(normal)).try_normalize()?
            }
            None => horizontal_tangent(normal),
        };
        let plane = AffinePlane::new(center, u * radius, normal.cross(u) * radius, normal);
        Some(Self { plane })
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        self.plane.intersect(ray, t_max).filter(|c| c.uv[0] * c.uv[0] + c.uv[1] * c.uv[1] < 1.0)
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::of_ellipsoid(self.plane.center, DMat3::from_cols(self.plane.u, self.plane.v, DVec3::ZERO)).padded(8)
    }

    pub(super) fn area(&self) -> f64 {
        PI * self.plane.u.cross(self.plane.v).length()
    }

    pub(super) fn sample_area(&self, u: [f64; 2]) -> DVec3 {
        self.plane.at(sample_disk(u).into())
    }
}
