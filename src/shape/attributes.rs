//! What a mesh's vertices carry besides their places.

use super::Vertices;
use crate::math::{DVec3, Transform};

/// Numbers of each vertex, interpolated over the triangles; lists are empty where a mesh has none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Attributes {
    /// Normals of the surface that the triangles stand for, of any length; one of length 0 stands for none.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, v up.
    pub coordinates: Vec<[f32; 2]>,
    /// Triangles that have no texture coordinates where others have: zeros stand for them.
    pub bare: usize,
}

impl Attributes {
    /// The unit normal at affine coordinates of a triangle whose own normal is `flat`.
    ///
    /// Of no use are interpolated normals that vanish or look away from the triangle's front. Where those of all three
    /// corners look away, it is the triangle that runs the other way around, as in meshes that a program has mirrored:
    /// they are turned.
    pub(super) fn shading(&self, corners: [u32; 3], uv: [f64; 2], flat: DVec3) -> DVec3 {
        if self.normals.is_empty() {
            return flat;
        }
        let interpolated: [f64; 3] = interpolated(&self.normals, corners, uv);
        let Some(normal) = DVec3::from(interpolated).try_normalize() else { return flat };
        let looks_away = |corner: u32| flat.dot(self.normals[corner as usize].map(f64::from).into()) < 0.0;
        match normal.dot(flat) {
            along if along > 0.0 => normal,
            along if along < 0.0 && corners.into_iter().all(looks_away) => -normal,
            _ => flat,
        }
    }

    /// The texture coordinates at affine coordinates of a triangle.
    pub(super) fn coordinates(&self, corners: [u32; 3], uv: [f64; 2]) -> Option<[f64; 2]> {
        (!self.coordinates.is_empty()).then(|| interpolated(&self.coordinates, corners, uv))
    }

    pub(super) fn transformed(&self, map: &Transform) -> Self {
        // Not normalized, so that they are interpolated as before the map; the largest number of the map is made 1.
        let Some(back) = map.inverse() else { return self.clone() };
        let size = back.size();
        let turned =
            |normal: &[f32; 3]| (back.transposed(normal.map(f64::from).into()) / size).to_array().map(|x| x as f32);
        let (normals, coordinates) = (self.normals.iter().map(turned).collect(), self.coordinates.clone());
        Self { normals, coordinates, bare: self.bare }
    }
}

fn interpolated<const K: usize>(numbers: &[[f32; K]], corners: [u32; 3], [u, v]: [f64; 2]) -> [f64; K] {
    let [a, b, c] = corners.map(|corner| numbers[corner as usize]);
    std::array::from_fn(|i| f64::from(a[i]) * (1.0 - u - v) + f64::from(b[i]) * u + f64::from(c[i]) * v)
}

/// Normals of vertices, from the triangles around each, weighted by their angles there; vertices at the same place have
/// one.
///
/// Thuermer & Wuethrich 1998, *Computing Vertex Normals from Polygonal Facets*.
pub fn vertex_normals(vertices: &Vertices, faces: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let merged = vertices.merged();
    let mut sums = vec![DVec3::ZERO; merged.len()];
    for face in faces {
        let points = face.map(|corner| vertices.at(corner));
        for i in 0..3 {
            let [along, back] = [1, 2].map(|step| points[(i + step) % 3] - points[i]);
            let size = along.abs().max(back.abs()).max_element();
            let (along, back) = (along / size, back / size);
            let across = along.cross(back);
            let angle = libm::atan2(across.length(), along.dot(back));
            if let Some(normal) = across.try_normalize() {
                sums[merged[face[i] as usize] as usize] += normal * angle;
            }
        }
    }
    let normal = |&vertex: &u32| sums[vertex as usize].normalize_or_zero().to_array().map(|x| x as f32);
    merged.iter().map(normal).collect()
}
