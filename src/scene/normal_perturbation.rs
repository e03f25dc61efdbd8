//! Surfaces that look rougher than they are: an image perturbs the shading normal.

use std::sync::Arc;

use crate::math::DVec3;
use crate::shape::{Coordinates, Intersection, Shape, SurfacePoint};
use crate::spectrum::Texture;

/// An image on an object that perturbs its shading normal. The surface itself stays where it is.
#[derive(Clone, Debug)]
pub struct NormalPerturbation {
    /// Texture coordinates of the surface.
    pub coordinates: Arc<Coordinates>,
    /// The image and its placement.
    pub texture: Texture,
    /// The meaning of its numbers.
    pub kind: PerturbationKind,
}

/// What the numbers of the image mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PerturbationKind {
    /// Directions: red along u, green perpendicular to it on the side of v, blue out of the surface.
    Directions {
        /// Factor on red and green.
        strength: f64,
    },
    /// Heights above the front of the surface.
    Heights {
        /// Height of white in scene units.
        depth: f64,
    },
}

impl NormalPerturbation {
    /// Returns the unit shading normal at a point, on the front side. Where the image is flat, it is the unperturbed
    /// normal to the last bit.
    ///
    /// Heights h move the tangents to P_u + h_u n and P_v + h_v n, whose cross product is the normal: Blinn 1978,
    /// *Simulation of Wrinkled Surfaces*, equation 3. The tangents are first made perpendicular to the interpolated
    /// normal of a smooth mesh.
    #[inline(never)]
    pub fn normal(&self, shape: &Shape, intersection: &Intersection, point: &SurfacePoint) -> DVec3 {
        let n = point.shading;
        let Some(tangents) = self.coordinates.tangents(shape, intersection, point) else { return n };
        let [along_u, along_v] = tangents.map(|tangent| tangent - n * tangent.dot(n));
        let uv = self.coordinates.at(shape, intersection, point.position);
        // Where an image is mirrored on the surface, u and v have the opposite orientation.
        let side = 1f64.copysign(along_u.cross(along_v).dot(n));
        let bent = match self.kind {
            PerturbationKind::Directions { strength } => {
                let [x, y, z] = self.texture.color(uv).map(f64::from);
                let [x, y] = [x, y].map(|slope| slope * strength);
                if x == 0.0 && y == 0.0 {
                    return n;
                }
                let Some(right) = along_u.try_normalize() else { return n };
                right * x + n.cross(right) * (side * y) + n * z
            }
            PerturbationKind::Heights { depth } => {
                let [du, dv] = self.texture.slope(uv).map(|slope| slope * depth);
                if du == 0.0 && dv == 0.0 {
                    return n;
                }
                (along_u.cross(along_v) + n.cross(along_v) * du + along_u.cross(n) * dv) * side
            }
        };
        let Some(bent) = bent.try_normalize() else { return n };
        // A normal must not point into the surface: one that would is reflected at the tangent plane.
        let inward = bent.dot(point.normal).min(0.0);
        (bent - point.normal * (2.0 * inward)).try_normalize().unwrap_or(n)
    }
}
