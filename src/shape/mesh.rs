use std::collections::HashMap;

use super::triangle::Sheared;
use super::{Bvh, Crossing, Triangle};
use crate::math::{Bounds, DVec3, Ray, Transform};

/// Triangles over shared vertices, with a tree of boxes.
///
/// ```toml
/// shape.mesh = { file = "bunny.ply" }                          # PLY or OBJ, relative to the scene file
/// shape.mesh = { points = [[0, 0, 0], ..], faces = [[0, 1, 2], ..] }
/// ```
#[derive(Clone, Debug)]
pub struct Mesh {
    vertices: Vertices,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh,
    /// Running sum of the triangles' areas, for drawing one by its area.
    areas: Vec<f64>,
    closed: bool,
}

/// Vertices as exactly as they were given: files hold f32, scene files and transforms f64.
#[derive(Clone, Debug)]
pub enum Vertices {
    /// As a mesh file stores them.
    Single(Vec<[f32; 3]>),
    /// As a scene file writes them, or after a transform.
    Double(Vec<DVec3>),
}

impl Vertices {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
        }
    }

    /// Vertex `index`, widened exactly.
    pub fn at(&self, index: u32) -> DVec3 {
        match self {
            Self::Single(points) => points[index as usize].map(f64::from).into(),
            Self::Double(points) => points[index as usize],
        }
    }
}

/// What building a mesh left out or noticed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshReport {
    /// Triangles without area, which were dropped.
    pub degenerate: usize,
    /// Edges that are not shared by exactly two triangles running opposite ways: 0 in a closed mesh.
    pub open_edges: usize,
}

impl Mesh {
    /// The mesh of triangles whose corners index existing, finite vertices. None if no triangle has an area.
    pub fn new(vertices: Vertices, faces: Vec<[u32; 3]>) -> Option<(Self, MeshReport)> {
        let count = faces.len();
        let corners = |face: &[u32; 3]| face.map(|corner| vertices.at(corner));
        let triangles: Vec<[u32; 3]> =
            faces.into_iter().filter(|face| !Triangle::is_degenerate(corners(face))).collect();
        if triangles.is_empty() {
            return None;
        }
        let open_edges = open_edges(&vertices, &triangles);
        let report = MeshReport { degenerate: count - triangles.len(), open_edges };
        Some((Self::built(vertices, triangles, open_edges == 0), report))
    }

    fn built(vertices: Vertices, triangles: Vec<[u32; 3]>, closed: bool) -> Self {
        let shapes = || triangles.iter().map(|face| Triangle::new(face.map(|corner| vertices.at(corner))));
        let bounds: Vec<Bounds> = shapes().map(|triangle| triangle.bounds()).collect();
        let mut total = 0.0;
        let areas = shapes().map(|triangle| {
            total += triangle.area();
            total
        });
        let areas = areas.collect();
        Self { bvh: Bvh::new(&bounds), vertices, triangles, areas, closed }
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Never: a mesh has at least one triangle.
    pub fn is_empty(&self) -> bool {
        false
    }

    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    pub(super) fn triangle(&self, index: u32) -> Triangle {
        Triangle::new(self.corners(index))
    }

    fn corners(&self, index: u32) -> [DVec3; 3] {
        self.triangles[index as usize].map(|corner| self.vertices.at(corner))
    }

    /// The nearest crossing; of equally near ones, that of the triangle listed first.
    pub(super) fn intersect(&self, ray: &Ray, t_max: f64) -> Option<Crossing> {
        let sheared = Sheared::new(ray);
        let mut nearest: Option<Crossing> = None;
        self.bvh.walk(ray, t_max, |index, limit| {
            if let Some(crossing) = sheared.intersect(self.corners(index), limit) {
                if nearest.is_none_or(|n| crossing.t < n.t || index < n.part) {
                    nearest = Some(Crossing { part: index, ..crossing });
                }
                return Some(crossing.t);
            }
            Some(limit)
        });
        nearest
    }

    pub(super) fn bounds(&self) -> Bounds {
        Bounds::around(self.triangles.iter().flatten().map(|&corner| self.vertices.at(corner)))
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        let points = (0..self.vertices.count() as u32).map(|index| map.point(self.vertices.at(index))).collect();
        let turned = |[a, b, c]: [u32; 3]| if map.mirrors() { [a, c, b] } else { [a, b, c] };
        let triangles = self.triangles.iter().copied().map(turned).collect();
        Self::built(Vertices::Double(points), triangles, self.closed)
    }

    pub(super) fn area(&self) -> f64 {
        self.areas[self.areas.len() - 1]
    }

    /// A point uniform by area, and the triangle it lies on.
    pub(super) fn sample(&self, u: [f64; 2]) -> (DVec3, u32) {
        let (index, along) = self.choose(u[0]);
        (self.triangle(index).sample([along, u[1]]), index)
    }

    /// A triangle by its area, and what is left of the random number.
    pub(super) fn choose(&self, u: f64) -> (u32, f64) {
        let target = u * self.area();
        let index = self.areas.partition_point(|&sum| sum <= target).min(self.areas.len() - 1);
        let before = if index == 0 { 0.0 } else { self.areas[index - 1] };
        (index as u32, ((target - before) / (self.areas[index] - before)).clamp(0.0, 1.0))
    }
}

/// Edges that keep the mesh from enclosing a volume, vertices at the same place counting as one.
fn open_edges(vertices: &Vertices, triangles: &[[u32; 3]]) -> usize {
    let mut places: HashMap<[u64; 3], u32> = HashMap::new();
    let merged: Vec<u32> = (0..vertices.count() as u32)
        .map(|index| {
            // Adding 0 makes -0 and 0 the same place.
            let key = vertices.at(index).to_array().map(|x| (x + 0.0).to_bits());
            *places.entry(key).or_insert(index)
        })
        .collect();
    let mut balance: HashMap<(u32, u32), [u32; 2]> = HashMap::new();
    for triangle in triangles {
        let corners = triangle.map(|corner| merged[corner as usize]);
        for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(i, j)| (corners[i], corners[j])) {
            balance.entry((a.min(b), a.max(b))).or_default()[usize::from(a > b)] += 1;
        }
    }
    balance.values().filter(|ways| ways[0] != ways[1]).count()
}
