//! Meshes, and the files they are read from.

use std::sync::Arc;

use smallvec::SmallVec;

use super::context::Context;
use super::ranges::{COORDINATE, MAX_LENGTH, direction, in_range, is_coordinate, point, range_error};
use super::shape_text::ShapeText;
use crate::math::DVec3;
use crate::scene::text::{Fields, Numbers, Rows, Spanned, Value, spanned};
use crate::shape::{Attributes, Faces, Mesh, Shape, Vertices, read_mesh, vertex_normals};

/// Extensions of mesh files.
const MESH_EXTENSIONS: [&str; 4] = ["ply", "obj", "gltf", "glb"];

/// The data of a mesh.
struct MeshData {
    vertices: Vertices,
    faces: Vec<[u32; 3]>,
    attributes: Attributes,
}

/// The indices of the points at the corners of a face, 3 or more.
type Face = SmallVec<[u32; 4]>;

/// The data of a mesh that the scene file itself contains.
struct InlineMesh<'d> {
    points: Option<Spanned<'d, Vec<DVec3>>>,
    faces: Option<Spanned<'d, Vec<Face>>>,
    normals: Option<Spanned<'d, Vec<DVec3>>>,
    uv: Option<Spanned<'d, Vec<[f64; 2]>>>,
}

/// Reads `mesh = { file = "cup.ply", smooth = true }`, or `points`, `faces`, `normals` and `uv` in place of the file.
pub(super) fn mesh<'d>(context: &mut Context, name: &str, value: Value<'d>) -> Option<ShapeText<'d>> {
    Fields::read(value, |mesh| {
        let file = mesh.maybe("file", spanned(Value::text));
        let points = mesh.maybe("points", spanned(points));
        let faces = mesh.maybe("faces", spanned(faces));
        let normals = mesh.maybe("normals", spanned(normals));
        let uv = mesh.maybe("uv", spanned(coordinates));
        let smooth = mesh.maybe("smooth", Value::yes_or_no);
        let has_unknown_keys = mesh.has_unknown();
        let (file, smooth) = (file?, smooth?);
        let inline = InlineMesh { points: points?, faces: faces?, normals: normals?, uv: uv? };
        // Normals that the scene file contains are used, unless it says that the mesh is not smooth.
        let (flat, smooth) = (smooth == Some(false), smooth.unwrap_or(false));
        let written = |mesh: &Arc<Mesh>, file| ShapeText { shape: Shape::Mesh(mesh.clone()), file };
        let mut data = match (&file, &inline) {
            (Some(file), InlineMesh { points: None, faces: None, normals: None, uv: None }) => {
                if let Some(mesh) = context.meshes.get(&(file.place.path(file.value), smooth)) {
                    return Some(written(mesh, Some(file.value)));
                }
                read_file(context, name, file, smooth)?
            }
            (None, InlineMesh { points: Some(_), faces: Some(_), .. }) => inline.data()?,
            _ if has_unknown_keys => return None,
            _ => return value.refuse("a mesh has either a `file`, or `points` and `faces`"),
        };
        if flat {
            data.attributes.normals.clear();
        }
        let mesh = build_mesh(context, name, value, data, smooth)?;
        let written = written(&mesh, file.map(|file| file.value));
        if let Some(Spanned { place, value: file }) = file {
            context.meshes.insert((place.path(file), smooth), mesh);
        }
        Some(written)
    })
}

fn points(value: Value) -> Option<Vec<DVec3>> {
    match value.rows() {
        Some(rows) => Some(coordinate_rows(value, rows)?.into_iter().map(DVec3::from_array).collect()),
        None => value.list(|entry| point(entry.as_list("a point", ""))),
    }
}

fn faces(value: Value) -> Option<Vec<Face>> {
    match value.rows() {
        Some(Rows { width: width @ 3.., numbers: Numbers::Whole(numbers) }) => {
            Some(numbers.chunks_exact(*width).map(Face::from_slice).collect())
        }
        Some(_) => value.refuse("each row of `faces` has 3 or more whole numbers"),
        None => value.list(face),
    }
}

fn normals(value: Value) -> Option<Vec<DVec3>> {
    let Some(rows) = value.rows() else { return value.list(|entry| direction(entry.as_list("a normal", ""))) };
    let normals: Vec<DVec3> = coordinate_rows(value, rows)?.into_iter().map(DVec3::from_array).collect();
    match normals.iter().position(|normal| normal.try_normalize().is_none()) {
        Some(row) => value.refuse(format!("row {row}: a direction needs a length above 0")),
        None => Some(normals),
    }
}

fn coordinates(value: Value) -> Option<Vec<[f64; 2]>> {
    match value.rows() {
        Some(rows) => coordinate_rows(value, rows),
        None => value.list(|entry| in_range(entry, COORDINATE, entry.numbers()?)),
    }
}

/// Reads rows of coordinates.
fn coordinate_rows<const N: usize>(value: Value, rows: &Rows) -> Option<Vec<[f64; N]>> {
    let numbers = match &rows.numbers {
        Numbers::Real(numbers) if rows.width == N => numbers,
        _ => return value.refuse(format!("`{}` has rows of {N} numbers, not {}", value.key(), rows.width)),
    };
    match numbers.iter().position(|number| !is_coordinate(*number)) {
        Some(first) => value.refuse(format!("row {}: {}", first / N, range_error(COORDINATE, numbers[first]))),
        None => Some(numbers.as_chunks().0.to_vec()),
    }
}

fn face(value: Value) -> Option<Face> {
    let corners = value.list(Value::count)?;
    match corners.len() {
        count @ ..3 => value.refuse(format!("a face is a list of 3 or more numbers, not {count}")),
        _ => Some(Face::from_vec(corners)),
    }
}

fn build_mesh(context: &mut Context, name: &str, value: Value, data: MeshData, smooth: bool) -> Option<Arc<Mesh>> {
    let MeshData { vertices, faces, mut attributes } = data;
    let is_averaged = smooth && attributes.normals.is_empty();
    if is_averaged {
        attributes.normals = vertex_normals(&vertices, &faces);
    }
    let Some(mesh) = Mesh::new(vertices, faces) else {
        return value.refuse("every triangle of this mesh has zero area");
    };
    match mesh.degenerate() {
        0 => {}
        1 => context.warn(format!("{name}: 1 triangle without area was dropped")),
        count => context.warn(format!("{name}: {count} triangles without area were dropped")),
    }
    let mesh = Arc::new(mesh.with(attributes));
    if is_averaged {
        context.averaged_meshes.insert(Arc::as_ptr(&mesh));
    }
    Some(mesh)
}

impl InlineMesh<'_> {
    fn data(self) -> Option<MeshData> {
        let (points, faces) = (self.points?, self.faces?);
        let count = points.value.len();
        let mut is_valid = true;
        for (number, face) in faces.value.iter().enumerate() {
            if let Some(corner) = face.iter().position(|&corner| corner as usize >= count) {
                let message = format!("there is no point {}: the {count} points are numbered from 0", face[corner]);
                is_valid = false;
                if faces.place.rows().is_some() {
                    faces.place.refuse::<()>(format!("row {number}: {message}"));
                    break;
                }
                faces.place.entry(number).entry(corner).refuse::<()>(message);
            }
        }
        let fits = |place: Value, what: &str, given: usize| match given == count {
            true => Some(()),
            false => place.refuse(format!("{count} points need {count} {what}, not {given}")),
        };
        let mut attributes = Attributes::default();
        if let Some(normals) = self.normals {
            fits(normals.place, "normals", normals.value.len())?;
            let single = |normal: DVec3| normal.normalize().to_array().map(|x| x as f32);
            attributes.normals = normals.value.into_iter().map(single).collect();
        }
        if let Some(uv) = self.uv {
            fits(uv.place, "entries of `uv`", uv.value.len())?;
            attributes.coordinates = uv.value.into_iter().map(|pair| pair.map(|x| x as f32)).collect();
        }
        if !is_valid {
            return None;
        }
        let vertices = Vertices::Double(points.value);
        let mut cut = Faces::default();
        faces.value.iter().for_each(|face| cut.push(face));
        match cut.triangles(&vertices) {
            Ok(faces) => Some(MeshData { vertices, faces, attributes }),
            Err(message) => faces.place.refuse(message),
        }
    }
}

fn read_file(context: &mut Context, name: &str, file: &Spanned<&str>, smooth: bool) -> Option<MeshData> {
    let Spanned { place, value: file } = *file;
    let path = place.path(file);
    let mesh = match read_mesh(&path, smooth) {
        Ok(mesh) => mesh,
        Err(_) if file.is_empty() => return place.refuse("a mesh file needs a name"),
        Err(_) if path.is_dir() => return place.refuse(format!("{file} is a folder")),
        Err(_) if path.try_exists().is_ok_and(|exists| !exists) => return place.missing(file, &MESH_EXTENSIONS),
        Err(message) => return place.refuse(format!("{file}: {message}")),
    };
    let is_far = |&vertex: &u32| mesh.vertices.at(vertex).abs().max_element() > MAX_LENGTH;
    if let Some(vertex) = (0..mesh.vertices.count() as u32).find(is_far) {
        return place.refuse(format!("{file}: vertex {vertex} (counted from 0) is beyond {MAX_LENGTH:e}"));
    }
    match std::fs::read(&path) {
        Ok(bytes) => context.record_file(path, &bytes),
        Err(error) => return place.refuse(format!("cannot read {file}: {error}")),
    }
    for other in mesh.others {
        match std::fs::read(&other) {
            Ok(bytes) => context.record_file(other, &bytes),
            Err(error) => return place.refuse(format!("{}: {error}", other.display())),
        }
    }
    for what in mesh.ignored {
        context.warn(format!("{name}: the {what} of {file} are ignored"));
    }
    match mesh.materials {
        0 => {}
        1 => context.warn(format!("{name}: the materials of {file} are ignored; the scene defines them")),
        count => context.warn(format!(
            "{name}: the {count} materials of {file} are ignored; the scene gives it one: save parts that look \
             different as separate files"
        )),
    }
    Some(MeshData { vertices: mesh.vertices, faces: mesh.faces, attributes: mesh.attributes })
}
