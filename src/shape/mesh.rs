use std::sync::OnceLock;

use super::edges::open_edges;
use super::flipped::turned;
use super::packed_triangles::PackedTriangles;
use super::polygon::PolygonKind;
use super::triangle::{Facet, tangents_over};
use super::{Attributes, Intersection, Polygon, SurfacePoint, Triangle, Vertices};
use crate::math::{Bounds, DVec3, Distribution, Ray, Transform};

/// Triangles with shared vertices, under a tree of boxes.
///
/// ```toml
/// shape.mesh = { file = "bunny.ply" }                          # PLY, OBJ or glTF, relative to the scene file
/// shape.mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] }
/// # smooth = true                          # by the file's normals, or computed ones if it has none
/// # normals = [[0, 0, 1], ..], uv = [[0, 0], ..]               # one for each of the points
/// ```
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vertices,
    triangles: Vec<[u32; 3]>,
    packed: PackedTriangles,
    /// Precomputed triangles of a small mesh. More rays arrive at such a mesh than it has triangles.
    facets: Vec<Facet>,
    bounds: Bounds,
    /// Distribution of the triangles by area. Computed on demand, because only lights need it.
    areas: OnceLock<Distribution>,
    attributes: Attributes,
    degenerate: usize,
    open_edges: usize,
}

/// Number of triangles up to which the memory of a mesh does not matter.
pub(super) const SMALL_MESH: u32 = 1024;

impl Mesh {
    /// Creates the mesh of triangles whose corners index existing, finite vertices. Triangles without area are dropped.
    /// Returns `None` if no triangle has an area.
    pub fn new(vertices: Vertices, faces: Vec<[u32; 3]>) -> Option<Self> {
        let is_flat = |face: &[u32; 3]| Triangle::is_degenerate(face.map(|corner| vertices.at(corner)));
        let (flat, triangles): (Vec<_>, Vec<_>) = faces.into_iter().partition(is_flat);
        if triangles.is_empty() {
            return None;
        }
        // A triangle without area may close a gap beside it, such as one at the tip of a sphere.
        let open_edges = match open_edges(&vertices, &triangles) {
            open if open > 0 && !flat.is_empty() => open.min(open_edges(&vertices, &[&*triangles, &flat].concat())),
            open => open,
        };
        Some(Self::build(vertices, triangles, flat.len(), open_edges))
    }

    fn build(vertices: Vertices, triangles: Vec<[u32; 3]>, degenerate: usize, open_edges: usize) -> Self {
        let packed = PackedTriangles::new(&vertices, &triangles);
        let facet = |corners: &[u32; 3]| Facet::new(Triangle::new(corners.map(|corner| vertices.at(corner))));
        let facets =
            if triangles.len() <= SMALL_MESH as usize { triangles.iter().map(facet).collect() } else { vec![] };
        let bounds = Bounds::around(triangles.iter().flatten().map(|&corner| vertices.at(corner)));
        let (areas, attributes) = (OnceLock::new(), Attributes::default());
        Self { packed, facets, vertices, triangles, bounds, areas, attributes, degenerate, open_edges }
    }

    /// Returns the number of triangles, at least one.
    pub fn count(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// Returns the number of triangles that were dropped because they have no area.
    pub fn degenerate(&self) -> usize {
        self.degenerate
    }

    /// Returns the number of edges along which triangles do not run equally often in both directions.
    pub fn open_edges(&self) -> usize {
        self.open_edges
    }

    /// Returns whether the mesh encloses a volume.
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0
    }

    /// Returns one of the triangles.
    pub(super) fn polygon(&self, index: u32) -> Polygon<'_> {
        match self.facets.get(index as usize) {
            Some(facet) => Polygon(PolygonKind::Facet(facet)),
            None => Polygon(PolygonKind::Triangle(self.triangle(index))),
        }
    }

    pub(super) fn triangle(&self, index: u32) -> Triangle {
        match self.facets.get(index as usize) {
            Some(facet) => facet.triangle.clone(),
            None => Triangle::new(self.corners(index)),
        }
    }

    fn corners(&self, index: u32) -> [DVec3; 3] {
        self.triangles[index as usize].map(|corner| self.vertices.at(corner))
    }

    /// Returns the nearest crossing of a ray that may leave the triangle `from`. Of equally near crossings, it is that
    /// of the triangle listed first.
    pub(super) fn intersect(&self, ray: &Ray, t_max: f64, from: Option<u32>) -> Option<Intersection> {
        self.packed.nearest(ray, t_max, |part| from == Some(part), |_| true)
    }

    /// Returns whether a ray that may leave the triangle `from` has a crossing with 0 < t <= `t_max` for which `accept`
    /// is true, given its triangle and t.
    pub(super) fn is_crossed(
        &self,
        ray: &Ray,
        t_max: f64,
        from: Option<u32>,
        accept: impl Fn(u32, f64) -> bool,
    ) -> bool {
        self.packed.any(ray, t_max, |part| from == Some(part), accept)
    }

    #[inline]
    pub(super) fn point(&self, intersection: &Intersection) -> SurfacePoint {
        let point = match self.facets.get(intersection.part as usize) {
            Some(facet) => facet.point(intersection.uv),
            None => self.triangle(intersection.part).point(intersection.uv),
        };
        let shading =
            self.attributes.shading(self.triangles[intersection.part as usize], intersection.uv, point.normal);
        SurfacePoint { shading, ..point }
    }

    /// Returns the mesh with vertex attributes. Lists that are not empty have an entry for each vertex.
    #[must_use]
    pub fn with(self, attributes: Attributes) -> Self {
        Self { attributes, ..self }
    }

    /// Returns whether the shading normals are interpolated.
    pub fn is_smooth(&self) -> bool {
        !self.attributes.normals.is_empty()
    }

    /// Returns whether the mesh has texture coordinates.
    pub fn has_coordinates(&self) -> bool {
        !self.attributes.coordinates.is_empty()
    }

    /// Returns how many triangles must be flipped to close the mesh. Returns 0 if the mesh is closed, or if flipping
    /// does not close it.
    pub fn turned(&self) -> usize {
        if self.is_closed() { 0 } else { turned(&self.vertices, &self.triangles) }
    }

    /// Returns the largest angle in degrees between a triangle's normal and a normal by which it is shaded, or 0 if the
    /// mesh is not smooth.
    pub fn bend(&self) -> f64 {
        let normals = &self.attributes.normals;
        let cosine = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|corner| self.vertices.at(corner));
            let flat = (b - a).cross(c - a).try_normalize()?;
            let normal = |corner: &u32| DVec3::from(normals[*corner as usize].map(f64::from)).try_normalize();
            triangle.iter().filter_map(normal).map(|normal| normal.dot(flat)).min_by(f64::total_cmp)
        };
        let least = self.triangles.iter().filter(|_| self.is_smooth()).filter_map(cosine).min_by(f64::total_cmp);
        least.map_or(0.0, |cosine| libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees())
    }

    /// Returns the number of triangles without texture coordinates, in a mesh where others have them.
    pub fn bare(&self) -> usize {
        self.attributes.bare
    }

    /// Returns the texture coordinates at affine coordinates of a triangle, or `None` if the mesh has none.
    pub fn coordinates(&self, part: u32, uv: [f64; 2]) -> Option<[f64; 2]> {
        self.attributes.coordinates(self.triangles[part as usize], uv)
    }

    /// Returns the derivatives of the points of a triangle with respect to its texture coordinates.
    pub(super) fn tangents(&self, part: u32) -> Option<[DVec3; 2]> {
        let corners = self.triangles[part as usize];
        let at = |corner: u32| self.attributes.coordinates[corner as usize];
        if self.has_coordinates() { tangents_over(self.corners(part), corners.map(at)) } else { None }
    }

    pub(super) fn vertices(&self) -> impl Iterator<Item = DVec3> + '_ {
        (0..self.vertices.count() as u32).map(|index| self.vertices.at(index))
    }

    pub(super) fn bounds(&self) -> Bounds {
        self.bounds
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        let points = self.vertices().map(|vertex| map.point(vertex)).collect();
        let triangles = self.triangles.iter().map(|&corners| map.fix_winding(corners)).collect();
        let attributes = self.attributes.transformed(map);
        Self::build(Vertices::Double(points), triangles, self.degenerate, self.open_edges).with(attributes)
    }

    fn areas(&self) -> &Distribution {
        let area = |index| self.triangle(index).area();
        self.areas.get_or_init(|| Distribution::new((0..self.count()).map(area)))
    }

    pub(super) fn area(&self) -> f64 {
        self.areas().total()
    }

    /// Samples a point uniformly by area. Returns it with the triangle it lies on.
    pub(super) fn sample_area(&self, u: [f64; 2]) -> (DVec3, u32) {
        let (index, along) = self.choose_part(u[0]);
        (self.triangle(index).sample_area([along, u[1]]), index)
    }

    /// Draws a triangle in proportion to its area. Returns it with the rest of the random number.
    pub(super) fn choose_part(&self, u: f64) -> (u32, f64) {
        let drawn = self.areas().sample(u);
        (drawn.index as u32, drawn.u)
    }
}
