//! Meshes, and the files they are read from.

use std::collections::HashMap;
use std::sync::Arc;

use sha2::Digest;

use super::compile_shape::{MAX_LENGTH, ShapeCompiler};
use super::description::{Description, MeshText, ShapeText};
use super::gather::{Gather, all};
use super::source::At;
use crate::error::Result;
use crate::shape::{Attributes, Mesh, Vertices, read_mesh, read_smooth_mesh, vertex_normals};

/// The meshes of files that are placed more than once, each kept once.
pub(super) struct Meshes {
    /// How often each file is placed.
    places: HashMap<String, usize>,
    /// By file and whether it is smooth.
    kept: HashMap<(String, bool), Arc<Mesh>>,
}

impl Meshes {
    /// Counts the files that a scene names.
    pub(super) fn of(description: &Description) -> Self {
        let mut places = HashMap::new();
        for object in description.object.iter().flatten() {
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
        let key = text.file.as_ref().map(|file| (file.clone(), text.smooth));
        let given = [text.points.is_some(), text.faces.is_some(), text.normals.is_some(), text.uv.is_some()];
        if let Some(mesh) = key.as_ref().and_then(|key| self.compiler.meshes.kept.get(key))
            && given == [false; 4]
        {
            return Ok(mesh.clone());
        }
        let (vertices, faces, mut attributes) = match text {
            MeshText { file: Some(file), points: None, faces: None, normals: None, uv: None, .. } => {
                self.mesh_file(&at.key("file"), file, text.smooth)?
            }
            MeshText { file: None, points: Some(points), faces: Some(faces), .. } => {
                let count = points.len();
                let vertices = self.points(&at.key("points"), points);
                let list = at.key("faces");
                let corners = all(faces.iter().enumerate().map(|(number, face)| {
                    match face.iter().position(|&corner| corner as usize >= count) {
                        Some(corner) => {
                            let message =
                                format!("there is no point {}: the {count} points count from 0", face[corner]);
                            self.refuse(&list.index(number).index(corner), &message)
                        }
                        None => Ok(()),
                    }
                }));
                let (vertices, _, attributes) = (vertices, corners, self.attributes(at, text, count)).gather()?;
                (Vertices::Double(vertices), faces.clone(), attributes)
            }
            _ => return self.refuse(at, "a mesh has either a `file`, or `points` and `faces`"),
        };
        if text.smooth && attributes.normals.is_empty() {
            attributes.normals = vertex_normals(&vertices, &faces);
            let warning = format!("{}: the mesh has no normals; they are computed from its faces", self.name);
            self.compiler.warnings.push(warning);
        }
        let Some((mesh, report)) = Mesh::new(vertices, faces) else {
            return self.refuse(at, "no triangle of this mesh has an area");
        };
        let mesh = mesh.with(attributes);
        if report.degenerate > 0 {
            let warning = format!("{}: {} triangles without area were dropped", self.name, report.degenerate);
            self.compiler.warnings.push(warning);
        }
        let mesh = Arc::new(mesh);
        if let Some(key) = key.filter(|(file, _)| self.compiler.meshes.places[file] > 1) {
            self.compiler.meshes.kept.insert(key, mesh.clone());
        }
        Ok(mesh)
    }

    /// Normals and texture coordinates of the points of a mesh in the scene file.
    fn attributes(&self, at: &At, text: &MeshText, count: usize) -> Result<Attributes> {
        let single = |x: f64| x as f32;
        let fits = |key: &str, what: &str, given: usize| match given == count {
            true => Ok(()),
            false => self.refuse(&at.key(key), &format!("{count} points have {count} {what}, not {given}")),
        };
        let mut attributes = Attributes::default();
        if let Some(normals) = &text.normals {
            let here = at.key("normals");
            fits("normals", "normals", normals.len())?;
            for (number, &normal) in normals.iter().enumerate() {
                let normal = self.compiler.direction(&here.index(number), normal)?.normalize();
                attributes.normals.push(normal.to_array().map(single));
            }
        }
        if let Some(coordinates) = &text.uv {
            let here = at.key("uv");
            fits("uv", "entries of `uv`", coordinates.len())?;
            for (number, pair) in coordinates.iter().enumerate() {
                self.compiler.point(&here.index(number), [pair[0], pair[1], 0.0])?;
                attributes.coordinates.push(pair.map(single));
            }
        }
        Ok(attributes)
    }

    fn mesh_file(&mut self, at: &At, file: &str, smooth: bool) -> Result<(Vertices, Vec<[u32; 3]>, Attributes)> {
        let path = self.compiler.source.folder().join(file);
        let refuse = |message: String| self.compiler.source.mistake_at(at, message, None);
        let mesh = if smooth { read_smooth_mesh(&path) } else { read_mesh(&path) };
        let mesh = mesh.map_err(|message| match path.try_exists() {
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
        Ok((mesh.vertices, mesh.faces, mesh.attributes))
    }
}
