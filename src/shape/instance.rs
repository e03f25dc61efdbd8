use std::sync::Arc;

use super::hull::Hull;
use super::{Intersection, Mesh, SurfacePoint, Triangle};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma, unit};

/// A mesh placed by an affine map: many of them share the triangles of one.
///
/// Rays are taken into the mesh's own space, without normalizing them there, so that distances stay those of the world.
/// The surface is the one that the *computed* map back takes to the mesh: its bounds of error hold the roundings of
/// that map beside those of the map to the world, and a ray that leaves the surface starts on the right side of it
/// there.
#[derive(Clone, Debug)]
pub struct Instance {
    mesh: Arc<Mesh>,
    to_world: Transform,
    to_object: Transform,
    /// Bound, in the mesh's space, of how far the map there and back moves a point of the mesh.
    mismatch: DVec3,
    bounds: Bounds,
}

/// Most that a map back may stretch a ray's direction: boxes are tested by its reciprocal in 32 bits, which is rounded
/// as others are above 2^-126, and a map has three axes.
const LARGEST: f64 = 1e37;

impl Instance {
    /// A mesh after an invertible map; none where the map back is too large for numbers of 32 bits.
    pub fn new(mesh: Arc<Mesh>, to_world: Transform) -> Option<Self> {
        let to_object = to_world.inverse().filter(|back| back.size() <= LARGEST)?;
        let own = mesh.bounds();
        let reach = own.min.abs().max(own.max.abs());
        let mismatch = to_world.mismatch(&to_object, reach);
        let around = Bounds::around(mesh.vertices().map(|vertex| to_world.point(vertex)));
        let mut placed = Self { mesh, to_world, to_object, mismatch, bounds: around };
        // A ray that meets the box has come from as far as the box is wide: its direction is rounded as well.
        let pad = placed.error(reach, around.min.abs().max(around.max.abs()), reach * gamma(16));
        placed.bounds = Bounds { min: around.min - pad, max: around.max + pad };
        (pad.is_finite() && around.min.is_finite() && around.max.is_finite()).then_some(placed)
    }

    /// The placed mesh after another map.
    pub(super) fn transformed(&self, map: &Transform) -> Option<Self> {
        Self::new(self.mesh.clone(), self.to_world.then(map))
    }

    /// The mesh with its triangles in the world.
    pub(super) fn baked(&self) -> Mesh {
        self.mesh.transformed(&self.to_world)
    }

    /// The map back to the mesh and how much longer lengths are in the world, if the map to the world keeps all angles.
    pub fn similarity(&self) -> Option<(Transform, f64)> {
        Some((self.to_object, self.to_world.uniform_scale()?))
    }

    /// The mesh that it places.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64, left: Option<u32>) -> Option<Intersection> {
        self.mesh.intersect(&self.own(ray), t_max, left)
    }

    pub(super) fn is_crossed(
        &self,
        ray: &Ray,
        t_max: f64,
        left: Option<u32>,
        counts: impl Fn(u32, f64) -> bool,
    ) -> bool {
        self.mesh.is_crossed(&self.own(ray), t_max, left, counts)
    }

    /// The crossing with one triangle alone.
    pub(super) fn intersect_part(&self, ray: &Ray, part: u32) -> Option<Intersection> {
        self.mesh.triangle(part).intersect(&self.own(ray), f64::INFINITY)
    }

    /// The ray in the mesh's space.
    fn own(&self, ray: &Ray) -> Ray {
        Ray { origin: self.to_object.point(ray.origin), direction: self.to_object.vector(ray.direction) }
    }

    /// The point, its normal by the inverse transpose, which keeps the front in front in mirror images too.
    pub(super) fn point(&self, intersection: &Intersection) -> SurfacePoint {
        let SurfacePoint { position, error, normal, shading } = self.mesh.point(intersection);
        let placed = self.to_world.point(position);
        let turned = |normal: DVec3| {
            let turned = self.to_object.transposed(normal);
            unit(turned / turned.abs().max_element())
        };
        let error = self.error(position.abs(), placed.abs(), error);
        let (flat, is_flat) = (turned(normal), shading == normal);
        let shading = if is_flat { flat } else { turned(shading) };
        SurfacePoint { position: placed, error, normal: flat, shading }
    }

    /// Bound in the world of a point's distance to the surface.
    ///
    /// With M and t the map to the world, N and s the map back, p = M q + t the computed image of q, itself off by e:
    /// the map to the world rounds by gamma(4) (|M| |q| + |t|). The ray's origin near p is taken back with a rounding
    /// of gamma(4) (|N| |p| + |s|), one more for the little way between both, to a place that differs from q by
    /// |N M - 1| |q| + |N t + s|. Those are lengths in the mesh's space, as e is, and worth |M| times as much in the
    /// world.
    fn error(&self, own: DVec3, placed: DVec3, error: DVec3) -> DVec3 {
        let there = error + self.mismatch + self.to_object.rounding(placed) * 1.25;
        (self.to_world.magnitudes() * there + self.to_world.rounding(own)) * (1.0 + gamma(16))
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The mesh's box in the world, where that is rounded as well.
    pub(super) fn hull(&self, rounding: DVec3) -> Hull {
        let (own, Bounds { min, max }) = (self.mesh.bounds(), self.bounds);
        let reach = own.min.abs().max(own.max.abs());
        let pad = 2.0 * self.error(reach, min.abs().max(max.abs()), reach * gamma(16)) + rounding;
        let half = 0.5 * own.size();
        let axes = DVec3::AXES.map(|axis| self.to_world.vector(axis * half));
        Hull::new(self.to_world.point(own.center()), axes, false, pad)
    }

    /// A triangle of the mesh, in the world.
    pub(super) fn triangle(&self, part: u32) -> Triangle {
        self.mesh.triangle(part).transformed(&self.to_world)
    }

    pub(super) fn tangents(&self, part: u32) -> Option<[DVec3; 2]> {
        let own = self.mesh.tangents(part)?;
        Some(own.map(|tangent| self.to_world.vector(tangent)))
    }

    pub(super) fn area(&self) -> f64 {
        (0..self.mesh.count()).map(|part| self.triangle(part).area()).sum()
    }

    /// A point of a triangle drawn by its area in the mesh's space, evenly over the triangle.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> (DVec3, u32) {
        let (point, part) = self.mesh.sample_area(u);
        (self.to_world.point(point), part)
    }

    /// Density per unit of area in the world with which `sample` draws points of a triangle.
    pub(super) fn density(&self, part: u32) -> f64 {
        let own = self.mesh.triangle(part).area() / self.mesh.area();
        own / self.triangle(part).area()
    }
}
