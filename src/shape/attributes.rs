//! What the vertices of a mesh carry besides their positions.

use super::Vertices;
use crate::math::{DVec3, Transform};

/// Attributes of each vertex, interpolated over the triangles. Lists are empty where a mesh has no such attribute.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Normals of the surface that the triangles approximate, of any length. A normal of length 0 means that there is
    /// none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, with v up.
    pub coordinates: Vec<[f32; 2]>,
    /// Number of triangles without texture coordinates in a mesh where others have them. Zeros take their place.
    pub bare: usize,
}

impl Attributes {
    /// Returns the unit normal at affine coordinates of a triangle whose own normal is `flat`.
    ///
    /// Returns `flat` if the interpolated normal vanishes or points away from the triangle's front. If the normals of
    /// all three corners point away, then it is the triangle whose winding is reversed, as in meshes that a program has
    /// mirrored. In this case the interpolated normal is flipped.
    pub(super) fn shading(&self, corners: [u32; 3], uv: [f64; 2], flat: DVec3) -> DVec3 {
        if self.normals.is_empty() {
            return flat;
        }
        let interpolated: [f64; 3] = interpolated(&self.normals, corners, uv);
        let Some(normal) = DVec3::from(interpolated).try_normalize() else { return flat };
        let faces_away = |corner: u32| flat.dot(self.normals[corner as usize].map(f64::from).into()) < 0.0;
        match normal.dot(flat) {
            along if along > 0.0 => normal,
            along if along < 0.0 && corners.into_iter().all(faces_away) => -normal,
            _ => flat,
        }
    }

    /// Returns the texture coordinates at affine coordinates of a triangle.
    pub(super) fn coordinates(&self, corners: [u32; 3], uv: [f64; 2]) -> Option<[f64; 2]> {
        (!self.coordinates.is_empty()).then(|| interpolated(&self.coordinates, corners, uv))
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        // Normals are not normalized, so that they are interpolated as before the map. The map is scaled so that its
        // largest number is 1.
        let Some(back) = map.inverse() else { return self.clone() };
        let size = back.size();
        let map_normal =
            |normal: &[f32; 3]| (back.mul_transposed(normal.map(f64::from).into()) / size).to_array().map(|x| x as f32);
        let (normals, coordinates) = (self.normals.iter().map(map_normal).collect(), self.coordinates.clone());
        Self { normals, coordinates, bare: self.bare }
    }
}

fn interpolated<const K: usize>(numbers: &[[f32; K]], corners: [u32; 3], [u, v]: [f64; 2]) -> [f64; K] {
    let [a, b, c] = corners.map(|corner| numbers[corner as usize]);
    std::array::from_fn(|i| f64::from(a[i]) * (1.0 - u - v) + f64::from(b[i]) * u + f64::from(c[i]) * v)
}

/// Computes vertex normals from the triangles around each vertex, weighted by their angles there. Vertices at the same
/// place share one normal.
///
/// Thuermer & Wuethrich 1998, *Computing Vertex Normals from Polygonal Facets*.
pub fn vertex_normals(vertices: &Vertices, faces: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let welded = vertices.welded();
    let mut sums = vec![DVec3::ZERO; welded.len()];
    for face in faces {
        let points = face.map(|corner| vertices.at(corner));
        for i in 0..3 {
            let [along, back] = [1, 2].map(|step| points[(i + step) % 3] - points[i]);
            let size = along.abs().max(back.abs()).max_element();
            let (along, back) = (along / size, back / size);
            let across = along.cross(back);
            let angle = libm::atan2(across.length(), along.dot(back));
            if let Some(normal) = across.try_normalize() {
                sums[welded[face[i] as usize] as usize] += normal * angle;
            }
        }
    }
    let normal = |&vertex: &u32| sums[vertex as usize].normalize_or_zero().to_array().map(|x| x as f32);
    welded.iter().map(normal).collect()
}
