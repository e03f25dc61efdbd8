//! Triangles from PLY, OBJ and glTF files.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::mesh_data::{MeshFile, check_finite, no_such_vertex};

/// Reads a mesh file according to its extension, `.ply`, `.obj`, `.gltf` or `.glb`. Reads the normals of its vertices
/// if `smooth`. Checks that corners exist and that vertices and what they carry are finite.
///
/// # Errors
/// A sentence that says what is wrong with the file.
pub fn read(path: impl AsRef<Path>, smooth: bool) -> Result<MeshFile, String> {
    let path = path.as_ref();
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
    if is_gzip(path) {
        return Err("it is compressed with gzip: unpack it first".into());
    }
    let file = match extension.as_str() {
        "ply" => super::ply::read(path, smooth)?,
        "obj" => super::obj::read(path, smooth)?,
        "gltf" | "glb" => super::gltf::read(path, smooth)?,
        _ => return Err("a mesh file ends in .ply, .obj, .gltf or .glb".into()),
    };
    let count = file.vertices.count();
    check_finite(&file.vertices, &file.attributes)?;
    if let Some(corner) = file.faces.iter().flatten().find(|&&corner| corner as usize >= count) {
        return Err(no_such_vertex(*corner, count));
    }
    if file.faces.is_empty() {
        return Err("the file holds no faces".into());
    }
    Ok(file)
}

/// Returns whether a file begins like gzip (RFC 1952, section 2.3.1).
fn is_gzip(path: &Path) -> bool {
    let mut start = [0; 2];
    File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == [0x1f, 0x8b]
}
