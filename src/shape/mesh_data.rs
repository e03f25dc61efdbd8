use std::fmt;
use std::path::PathBuf;

use super::{Attributes, Vertices};

/// The contents of a mesh file.
#[derive(Default)]
#[non_exhaustive]
pub struct MeshFile {
    /// Vertices, in the precision of the file.
    pub vertices: Vertices,
    /// Corners of the triangles. Polygons are cut into triangles.
    pub faces: Vec<[u32; 3]>,
    /// What the vertices carry besides their positions.
    pub attributes: Attributes,
    /// Number of materials that the file refers to. Abbe takes materials from the scene instead.
    pub materials: usize,
    /// Other contents that would move points or texture coordinates, which are ignored.
    pub ignored: Vec<&'static str>,
    /// Other files that the mesh was read from.
    pub others: Vec<PathBuf>,
}

impl fmt::Debug for MeshFile {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let mut shown = formatter.debug_struct("MeshFile");
        shown.field("vertices", &self.vertices.count()).field("faces", &self.faces.len());
        shown.field("materials", &self.materials).field("ignored", &self.ignored);
        shown.field("others", &self.others).finish_non_exhaustive()
    }
}

/// Rejects vertices that are not finite, or that carry something that is not finite.
///
/// # Errors
/// A sentence that says which vertex it is.
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

/// Stands for a negative index: no mesh has this many vertices.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// Returns the error message for a corner beyond the last vertex.
pub(super) fn no_such_vertex(corner: u32, count: usize) -> String {
    let vertex = if corner == NO_VERTEX { "a negative vertex".into() } else { format!("vertex {corner}") };
    format!("a face refers to {vertex}, but the {count} vertices are numbered from 0")
}
