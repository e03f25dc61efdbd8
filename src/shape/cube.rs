use super::affine_plane::AffinePlane;
use super::{Intersection, SurfacePoint};
use crate::math::{Bounds, DVec3, Ray, Transform, UNIT_ROUNDOFF};

/// A box, or after a transform a parallelepiped; its front is the outside.
///
/// ```toml
/// shape.cube = { center = [0, 0.5, 0], size = 1 }            # full edges: a number, or [x, y, z]
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Cube {
    pub(super) center: DVec3,
    /// Vectors from the center to the centers of three faces.
    pub(super) half_edges: [DVec3; 3],
    duals: [DVec3; 3],
    /// Face 2 i + s lies at the positive (s = 1) or the negative (s = 0) end of half edge i.
    faces: Box<[AffinePlane; 6]>,
}

impl Cube {
    /// Creates the box with edges of the given full lengths along the axes.
    pub fn new(center: DVec3, size: DVec3) -> Self {
        let half = size * 0.5;
        Self::from_half_edges(center, [DVec3::X * half.x, DVec3::Y * half.y, DVec3::Z * half.z])
    }

    fn from_half_edges(center: DVec3, half_edges: [DVec3; 3]) -> Self {
        let terms = half_edges.iter().fold(center.abs(), |terms, edge| terms + edge.abs());
        let face = |index: usize| {
            let (axis, outward) = (index / 2, if index % 2 == 1 { 1.0 } else { -1.0 });
            let arm = half_edges[axis] * outward;
            AffinePlane::new(center + arm, half_edges[(axis + 1) % 3], half_edges[(axis + 2) % 3], arm)
                .with_terms(terms)
        };
        let faces: [AffinePlane; 6] = std::array::from_fn(face);
        let duals = std::array::from_fn(|axis| {
            let normal = faces[2 * axis + 1].normal;
            normal / normal.dot(half_edges[axis])
        });
        Self { center, half_edges, duals, faces: Box::new(faces) }
    }

    /// Intersects the slabs |coordinate| <= 1 in the cube's own coordinates. They are convex, so no ray slips through
    /// an edge.
    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Intersection> {
        let d = ray.origin - self.center;
        let (mut enter, mut leave) = ((f64::NEG_INFINITY, 0), (f64::INFINITY, 0));
        for axis in 0..3 {
            let (origin, speed) = (d.dot(self.duals[axis]), ray.direction.dot(self.duals[axis]));
            if speed == 0.0 {
                if origin.abs() > 1.0 {
                    return None;
                }
                continue;
            }
            let forward = usize::from(speed > 0.0);
            let sign = 1f64.copysign(speed);
            let (near, far) = ((-sign - origin) / speed, (sign - origin) / speed);
            if near > enter.0 {
                enter = (near, 2 * axis + 1 - forward);
            }
            if far < leave.0 {
                leave = (far, 2 * axis + forward);
            }
        }
        if enter.0 > leave.0 {
            return None;
        }
        let (t, face) = if enter.0 > 0.0 { enter } else { leave };
        (t > 0.0 && t <= t_max && t.is_finite()).then(|| self.intersection(ray, t, face))
    }

    fn intersection(&self, ray: &Ray, t: f64, face: usize) -> Intersection {
        let d = ray.at(t) - self.center;
        // The point is kept inside the edges by more than the rounding of a slab coordinate. A ray that continues
        // inside then starts inside all slabs, and hits no face that it did not cross.
        let limit = 1.0 - 64.0 * UNIT_ROUNDOFF * (1.0 + (self.center.abs() + self.extent()).dot(self.sensitivity()));
        let limit = limit.max(0.0);
        let coordinate = |axis: usize| d.dot(self.duals[axis]).clamp(-limit, limit);
        Intersection { t, part: face as u32, uv: [coordinate((face / 2 + 1) % 3), coordinate((face / 2 + 2) % 3)] }
    }

    /// Returns how much the rounding of a world coordinate can move a slab coordinate.
    fn sensitivity(&self) -> DVec3 {
        self.duals.iter().fold(DVec3::ZERO, |sensitivity, dual| sensitivity.max(dual.abs()))
    }

    pub(super) fn point(&self, intersection: &Intersection) -> SurfacePoint {
        self.faces[intersection.part as usize].point(intersection.uv)
    }

    /// Returns three of the edges, each along one axis before a transform.
    pub fn edges(&self) -> [DVec3; 3] {
        self.half_edges.map(|half| 2.0 * half)
    }

    /// Returns how far the cube extends from its center along each axis of the world.
    fn extent(&self) -> DVec3 {
        let [a, b, c] = self.half_edges.map(|edge| edge.abs());
        a + b + c
    }

    pub(super) fn bounds(&self) -> Bounds {
        let extent = self.extent();
        Bounds { min: self.center - extent, max: self.center + extent }.padded(8)
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        Self::from_half_edges(map.point(self.center), self.half_edges.map(|edge| map.vector(edge)))
    }

    pub(super) fn area(&self) -> f64 {
        (0..3).map(|axis| 2.0 * self.faces[2 * axis].area()).sum()
    }

    /// Returns the plane of a face, which is the plane's parallelogram |a| <= 1, |b| <= 1.
    pub(super) fn face(&self, index: u32) -> &AffinePlane {
        &self.faces[index as usize]
    }

    /// Samples a point uniformly by area. Returns it with the face it lies on.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> (DVec3, u32) {
        let (face, along) = self.choose_part(u[0]);
        (self.face(face).sample_area([along, u[1]]), face)
    }

    /// Draws a face in proportion to its area. Returns it with the rest of the random number.
    pub(super) fn choose_part(&self, u: f64) -> (u32, f64) {
        let mut rest = u * self.area();
        for face in 0..6 {
            let area = self.faces[face].area();
            if rest < area || face == 5 {
                return (face as u32, (rest / area).min(1.0));
            }
            rest -= area;
        }
        unreachable!("the last face takes what is left")
    }
}
