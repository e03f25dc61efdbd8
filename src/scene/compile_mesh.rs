//! Meshes, and the files they are read from.

use std::collections::HashMap;
use std::sync::Arc;

use sha2::Digest;

use super::compile_shape::{MAX_LENGTH, ShapeCompiler};
use super::description::{Description, MeshText, ShapeText};
use super::source::At;
use crate::error::Result;
use crate::shape::{Mesh, Vertices, read_mesh};

/// The meshes of files that are placed more than once, each kept once.
pub(super) struct Meshes {
    /// How often each file is placed.
    places: HashMap<String, usize>,
    kept: HashMap<String, Arc<Mesh>>,
}

impl Meshes {
    /// Counts the files that a scene names.
    pub(super) fn of(description: &Description) -> Self {
        let mut places = HashMap::new();
        for object in &description.object {
            if let ShapeText::Mesh(MeshText { file: Some(file), .. }) = &object.shape {
                *places.entry(file.clone()).or_default() += object.instances.as_ref().map_or(1, Vec::len);
            }
        }
        Self { places, kept: HashMap::new() }
    }

    /// Whether a mesh file is placed more than once.
    pub(super) fn is_shared(&self, shape: &ShapeText) -> bool {
        let ShapeText::Mesh(MeshText { file: Some(file), .. }) = shape else { return false };
        self.places.get(file).is_some_and(|&places| places > 1)
    }
}

impl ShapeCompiler<'_, '_> {
    /// The mesh as written, before any transform.
    pub(super) fn mesh(&mut self, at: &At, text: &MeshText) -> Result<Arc<Mesh>> {
        let kept = text.file.as_ref().and_then(|file| self.compiler.meshes.kept.get(file));
        if let (Some(mesh), MeshText { points: None, faces: None, .. }) = (kept, text) {
            return Ok(mesh.clone());
        }
        let (vertices, faces) = match text {
            MeshText { file: Some(file), points: None, faces: None } => self.mesh_file(&at.key("file"), file)?,
            MeshText { file: None, points: Some(points), faces: Some(faces) } => {
                let vertices = self.points(&at.key("points"), points)?;
                let count = vertices.len();
                for (number, face) in faces.iter().enumerate() {
                    if let Some(corner) = face.iter().position(|&corner| corner as usize >= count) {
                        let message = format!("there is no point {}: the {count} points count from 0", face[corner]);
                        return self.refuse(&at.key("faces").index(number).index(corner), &message);
                    }
                }
                (Vertices::Double(vertices), faces.clone())
            }
            _ => return self.refuse(at, "a mesh has either a `file`, or `points` and `faces`"),
        };
        let Some((mesh, report)) = Mesh::new(vertices, faces) else {
            return self.refuse(at, "no triangle of this mesh has an area");
        };
        if report.degenerate > 0 {
            let warning = format!("{}: {} triangles without area were dropped", self.name, report.degenerate);
            self.compiler.warnings.push(warning);
        }
        let mesh = Arc::new(mesh);
        if let Some(file) = text.file.as_ref().filter(|&file| self.compiler.meshes.places[file] > 1) {
            self.compiler.meshes.kept.insert(file.clone(), mesh.clone());
        }
        Ok(mesh)
    }

    fn mesh_file(&mut self, at: &At, file: &str) -> Result<(Vertices, Vec<[u32; 3]>)> {
        let path = self.compiler.source.folder().join(file);
        let refuse = |message: String| self.compiler.source.mistake_at(at, message, None);
        let mesh = read_mesh(&path).map_err(|message| match path.try_exists() {
            _ if file.is_empty() => refuse("a mesh file needs a name".into()),
            _ if path.is_dir() => refuse(format!("{file} is a folder")),
            Ok(false) => self.compiler.source.missing_file(at, file),
            _ => refuse(format!("{file}: {message}")),
        })?;
        let is_far = |&vertex: &u32| mesh.vertices.at(vertex).abs().max_element() > MAX_LENGTH;
        if let Some(vertex) = (0..mesh.vertices.count() as u32).find(is_far) {
            return Err(refuse(format!("{file}: vertex {vertex} (counted from 0) is beyond {MAX_LENGTH:e}")));
        }
        let bytes = std::fs::read(&path).map_err(|error| refuse(format!("cannot read {file}: {error}")))?;
        self.compiler.hash.update(&bytes);
        for other in &mesh.others {
            let bytes = std::fs::read(other).map_err(|error| refuse(format!("{}: {error}", other.display())))?;
            self.compiler.hash.update(&bytes);
        }
        for what in mesh.ignored {
            self.compiler.warnings.push(format!("{}: the {what} of {file} are ignored", self.name));
        }
        if mesh.names_materials {
            let warning = format!("{}: the materials of {file} are ignored; the scene gives them", self.name);
            self.compiler.warnings.push(warning);
        }
        Ok((mesh.vertices, mesh.faces))
    }
}
