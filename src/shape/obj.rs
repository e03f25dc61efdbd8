//! Triangles from OBJ files.

use std::cell::Cell;
use std::path::Path;

use tobj::LoadError;

use super::mesh_data::MeshFile;
use super::{Attributes, Vertices};

/// Reads the triangles of all objects of a file, and the normals of its vertices if they are wanted.
///
/// Where the file has texture coordinates, or normals that are wanted, a vertex with several of them becomes several.
pub(super) fn read(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    // Names and comments may be in any encoding.
    let text = String::from_utf8_lossy(&bytes);
    let [_, coordinates, normals] = counted(&text)?;
    let (has_normals, has_coordinates) = (smooth && normals > 0, coordinates > 0);
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
        LoadError::FaceVertexOutOfBounds => no_such("vertex"),
        LoadError::FaceTexCoordOutOfBounds => no_such("texture coordinate"),
        LoadError::FaceNormalOutOfBounds => no_such("normal"),
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

fn no_such(what: &str) -> String {
    format!("a face, f, asks for a {what} that the file does not have")
}

/// How many vertices, texture coordinates and normals a text lists.
///
/// # Errors
/// A face counts further back than there are any, or to a number that no file has: tobj multiplies both before it
/// looks.
fn counted(text: &str) -> Result<[u64; 3], String> {
    let mut counts = [0; 3];
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => counts[0] += 1,
            Some("vt") => counts[1] += 1,
            Some("vn") => counts[2] += 1,
            Some("f" | "l") => {
                for (kind, number) in words.flat_map(|corner| corner.split('/').enumerate().take(3)) {
                    let is_plain = !number.starts_with('-') && number.len() < 10;
                    // What is no number is refused as that later.
                    let Some(index) = (if is_plain { None } else { number.parse::<i64>().ok() }) else { continue };
                    let most = if index < 0 { counts[kind] } else { u64::from(u32::MAX) };
                    if index.unsigned_abs() > most {
                        return Err(no_such(["vertex", "texture coordinate", "normal"][kind]));
                    }
                }
            }
            _ => {}
        }
    }
    Ok(counts)
}

/// Numbers in groups, one group for each of `count` vertices; zeros if they are not as many.
fn groups<const K: usize>(numbers: &[f32], count: usize) -> Vec<[f32; K]> {
    let (groups, rest) = numbers.as_chunks::<K>();
    if rest.is_empty() && groups.len() == count { groups.to_vec() } else { vec![[0.0; K]; count] }
}
