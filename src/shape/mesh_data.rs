use std::path::PathBuf;

use super::{Attributes, Vertices};

/// What a mesh file holds.
pub struct MeshFile {
    /// Its vertices, in the precision of the file.
    pub vertices: Vertices,
    /// Corners of its triangles; polygons are cut.
    pub faces: Vec<[u32; 3]>,
    /// What its vertices carry.
    pub attributes: Attributes,
    /// Whether the file asks for materials, which Abbe takes from the scene instead.
    pub names_materials: bool,
    /// What else the file holds that moves its points, which are taken as they stand.
    pub ignored: Vec<&'static str>,
    /// Other files that it was read from.
    pub others: Vec<PathBuf>,
}
