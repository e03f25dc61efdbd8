use std::sync::Arc;

use super::hull::Hull;
use super::{Intersection, Mesh, SurfacePoint, Triangle};
use crate::math::{Bounds, DVec3, Ray, Transform, gamma, unit};

/// A mesh placed by an affine map. Many instances share the triangles of one mesh.
///
/// Rays are transformed into the mesh's own space and not normalized there, so that distances stay those of the world.
/// The surface of an instance is the one that the *computed* inverse map takes to the mesh. The error bounds therefore
/// include the roundings of that map as well as those of the map to the world, and a ray that leaves the surface starts
/// on the right side of it in the mesh's space.
#[derive(Clone, Debug)]
pub struct Instance {
    mesh: Arc<Mesh>,
    to_world: Transform,
    to_object: Transform,
    /// Bound, in the mesh's space, of how far the map to the world and back moves a point of the mesh.
    round_trip_error: DVec3,
    bounds: Bounds,
}

/// Largest entry of an inverse map, which stretches the direction of a ray. Boxes are tested with the direction's
/// reciprocal in 32 bits, which has the usual rounding only above 2^-126. Up to three entries add up in a coordinate of
/// the direction.
const MAX_INVERSE: f64 = 1e37;

impl Instance {
    /// Creates the instance of a mesh under an invertible map. Returns `None` if the inverse map is too large for
    /// 32-bit numbers.
    pub fn new(mesh: Arc<Mesh>, to_world: Transform) -> Option<Self> {
        let to_object = to_world.inverse().filter(|back| back.size() <= MAX_INVERSE)?;
        let mesh_bounds = mesh.bounds();
        let reach = mesh_bounds.min.abs().max(mesh_bounds.max.abs());
        let round_trip_error = to_world.round_trip_error(&to_object, reach);
        let around = Bounds::around(mesh.vertices().map(|vertex| to_world.point(vertex)));
        let mut placed = Self { mesh, to_world, to_object, round_trip_error, bounds: around };
        // A ray that meets the box may have come from as far away as the box is wide, so the rounding of its direction
        // counts too.
        let pad = placed.error(reach, around.min.abs().max(around.max.abs()), reach * gamma(16));
        placed.bounds = Bounds { min: around.min - pad, max: around.max + pad };
        (pad.is_finite() && around.min.is_finite() && around.max.is_finite()).then_some(placed)
    }

    /// Returns the instance after another map.
    pub(super) fn transformed(&self, map: &Transform) -> Option<Self> {
        Self::new(self.mesh.clone(), self.to_world.then(map))
    }

    /// Returns the mesh with its triangles in the world.
    pub(super) fn baked(&self) -> Mesh {
        self.mesh.transformed(&self.to_world)
    }

    /// Returns the map back to the mesh and the factor by which lengths grow in the world, if the map to the world
    /// keeps all angles.
    pub fn similarity(&self) -> Option<(Transform, f64)> {
        Some((self.to_object, self.to_world.uniform_scale()?))
    }

    /// Returns the mesh that is placed.
    pub fn mesh(&self) -> &Arc<Mesh> {
        &self.mesh
    }

    pub(super) fn intersect(&self, ray: &Ray, t_max: f64, from: Option<u32>) -> Option<Intersection> {
        self.mesh.intersect(&self.object_ray(ray), t_max, from)
    }

    pub(super) fn is_crossed(
        &self,
        ray: &Ray,
        t_max: f64,
        from: Option<u32>,
        accept: impl Fn(u32, f64) -> bool,
    ) -> bool {
        self.mesh.is_crossed(&self.object_ray(ray), t_max, from, accept)
    }

    /// Returns the crossing with one triangle alone.
    pub(super) fn intersect_part(&self, ray: &Ray, part: u32) -> Option<Intersection> {
        self.mesh.triangle(part).intersect(&self.object_ray(ray), f64::INFINITY)
    }

    /// Returns the ray in the mesh's space.
    fn object_ray(&self, ray: &Ray) -> Ray {
        Ray { origin: self.to_object.point(ray.origin), direction: self.to_object.vector(ray.direction) }
    }

    /// Returns the point in the world. The normal is mapped by the inverse transpose, which keeps the front in front in
    /// mirror images too.
    pub(super) fn point(&self, intersection: &Intersection) -> SurfacePoint {
        let SurfacePoint { position, error, normal, shading } = self.mesh.point(intersection);
        let placed = self.to_world.point(position);
        let mapped_normal = |normal: DVec3| {
            let mapped_normal = self.to_object.mul_transposed(normal);
            unit(mapped_normal / mapped_normal.abs().max_element())
        };
        let error = self.error(position.abs(), placed.abs(), error);
        let (flat, is_flat) = (mapped_normal(normal), shading == normal);
        let shading = if is_flat { flat } else { mapped_normal(shading) };
        SurfacePoint { position: placed, error, normal: flat, shading }
    }

    /// Returns a bound, in the world, of a point's distance to the surface.
    ///
    /// M and t are the map to the world, N and s the inverse map, and p = M q + t is the computed image of q, which
    /// itself is off by e. The map to the world has a rounding of gamma(4) (|M| |q| + |t|). The ray's origin near p is
    /// mapped back with a rounding of gamma(4) (|N| |p| + |s|), and one more for the short distance between both. It
    /// arrives at a point that differs from q by |N M - 1| |q| + |N t + s|. These lengths are in the mesh's space, as e
    /// is, and are multiplied by |M| in the world.
    fn error(&self, own: DVec3, placed: DVec3, error: DVec3) -> DVec3 {
        let object_error = error + self.round_trip_error + self.to_object.rounding_error(placed) * 1.25;
        (self.to_world.magnitudes() * object_error + self.to_world.rounding_error(own)) * (1.0 + gamma(16))
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Returns the hull of the mesh's box in the world, enlarged by `rounding` as well.
    pub(super) fn hull(&self, rounding: DVec3) -> Hull {
        let (own, Bounds { min, max }) = (self.mesh.bounds(), self.bounds);
        let reach = own.min.abs().max(own.max.abs());
        let pad = 2.0 * self.error(reach, min.abs().max(max.abs()), reach * gamma(16)) + rounding;
        let half = 0.5 * own.size();
        let axes = DVec3::AXES.map(|axis| self.to_world.vector(axis * half));
        Hull::new(self.to_world.point(own.center()), axes, false, pad)
    }

    /// Returns a triangle of the mesh, in the world.
    pub(super) fn triangle(&self, part: u32) -> Triangle {
        self.mesh.triangle(part).transformed(&self.to_world)
    }

    pub(super) fn tangents(&self, part: u32) -> Option<[DVec3; 2]> {
        let mesh_tangents = self.mesh.tangents(part)?;
        Some(mesh_tangents.map(|tangent| self.to_world.vector(tangent)))
    }

    pub(super) fn area(&self) -> f64 {
        (0..self.mesh.count()).map(|part| self.triangle(part).area()).sum()
    }

    /// Samples a point uniformly on a triangle that is drawn by its area in the mesh's space. Returns it with the
    /// triangle.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> (DVec3, u32) {
        let (point, part) = self.mesh.sample_area(u);
        (self.to_world.point(point), part)
    }

    /// Returns the density per unit area in the world with which `sample_area` draws points of a triangle.
    pub(super) fn density(&self, part: u32) -> f64 {
        let area_share = self.mesh.triangle(part).area() / self.mesh.area();
        area_share / self.triangle(part).area()
    }
}
