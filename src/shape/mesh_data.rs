use std::path::PathBuf;

use super::{Attributes, Vertices};

/// What a mesh file holds.
#[derive(Default)]
pub struct MeshFile {
    /// Its vertices, in the precision of the file.
    pub vertices: Vertices,
    /// Corners of its triangles; polygons are cut.
    pub faces: Vec<[u32; 3]>,
    /// What its vertices carry.
    pub attributes: Attributes,
    /// How many materials the file asks for, which Abbe takes from the scene instead.
    pub materials: usize,
    /// What else the file holds that moves its points, which are taken as they stand.
    pub ignored: Vec<&'static str>,
    /// Other files that it was read from.
    pub others: Vec<PathBuf>,
}

/// Refuses vertices that are not finite, or that carry something which is not.
///
/// # Errors
/// A sentence that says which.
pub(super) fn check_finite(vertices: &Vertices, attributes: &Attributes) -> Result<(), String> {
    if let Some(vertex) = (0..vertices.count() as u32).find(|&index| !vertices.at(index).is_finite()) {
        return Err(format!("vertex {vertex} (counted from 0) is not finite"));
    }
    let Attributes { normals, coordinates, .. } = attributes;
    if let Some(vertex) = normals.iter().position(|normal| !normal.iter().all(|x| x.is_finite())) {
        return Err(format!("the normal of vertex {vertex} (counted from 0) is not finite"));
    }
    if let Some(vertex) = coordinates.iter().position(|pair| !pair.iter().all(|x| x.is_finite())) {
        return Err(format!("the texture coordinates of vertex {vertex} (counted from 0) are not finite"));
    }
    Ok(())
}

/// Stands for a negative index: no mesh has so many vertices.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// What is wrong with a corner beyond the last vertex.
pub(super) fn no_such_vertex(corner: u32, count: usize) -> String {
    let vertex = if corner == NO_VERTEX { "a negative vertex".into() } else { format!("vertex {corner}") };
    format!("a face asks for {vertex}, but the {count} vertices count from 0")
}
