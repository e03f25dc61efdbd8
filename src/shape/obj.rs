//! Triangles from OBJ files.

use std::cell::Cell;
use std::path::Path;

use tobj::LoadError;

use super::mesh_file::MeshFile;
use super::{Attributes, Vertices};

/// Reads the triangles of all objects of a file, and the normals of its vertices if they are wanted.
///
/// Where the file has texture coordinates, or normals that are wanted, a vertex with several of them becomes several.
pub(super) fn read(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    // Names and comments may be in any encoding.
    let text = String::from_utf8_lossy(&bytes);
    let has = |word: &str| text.lines().any(|line| line.split_whitespace().next() == Some(word));
    let (has_normals, has_coordinates) = (smooth && has("vn"), has("vt"));
    let single_index = has_normals || has_coordinates;
    let options = tobj::LoadOptions { triangulate: true, single_index, ..Default::default() };
    let names_materials = Cell::new(false);
    let models = tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| {
        names_materials.set(true);
        Ok(Default::default())
    });
    let (models, _) = models.map_err(|error| match error {
        LoadError::PositionParseError => "a vertex, v, is not made of numbers".into(),
        LoadError::FaceParseError => "a face, f, is not made of whole numbers".into(),
        LoadError::FaceVertexOutOfBounds => "a face, f, asks for a vertex that the file does not have".into(),
        other => other.to_string(),
    })?;
    let (mut points, mut faces, mut attributes) = (Vec::new(), Vec::new(), Attributes::default());
    for model in models {
        let first = points.len() as u32;
        points.extend(model.mesh.positions.chunks_exact(3).map(|p| [p[0], p[1], p[2]]));
        // An object of which only some corners have them has none.
        if has_normals {
            attributes.normals.extend(groups(&model.mesh.normals, points.len() - first as usize));
        }
        if has_coordinates {
            attributes.coordinates.extend(groups(&model.mesh.texcoords, points.len() - first as usize));
        }
        let corners = model.mesh.indices.chunks_exact(3);
        faces.extend(corners.map(|c| [c[0] + first, c[1] + first, c[2] + first]));
    }
    let (vertices, names_materials) = (Vertices::Single(points), names_materials.get());
    Ok(MeshFile { vertices, faces, attributes, names_materials, ignored: Vec::new(), others: Vec::new() })
}

/// Numbers in groups, one group for each of `count` vertices; zeros if they are not as many.
fn groups<const K: usize>(numbers: &[f32], count: usize) -> Vec<[f32; K]> {
    let (groups, rest) = numbers.as_chunks::<K>();
    if rest.is_empty() && groups.len() == count { groups.to_vec() } else { vec![[0.0; K]; count] }
}
