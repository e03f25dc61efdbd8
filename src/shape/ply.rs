//! Triangles from PLY files (Turk 1994, *The PLY Polygon File Format*).

use std::path::Path;

use ply_rs_bw::ply::{ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::faces::Faces;
use super::interner::Interner;
use super::mesh_data::{MeshFile, NO_VERTEX, check_finite, no_such_vertex};
use super::ply_body::Body;
use super::{Attributes, Vertices};

#[derive(Default)]
struct Vertex {
    place: [f64; 3],
    normal: [f32; 3],
    /// Texture coordinates, for each pair of names.
    coordinates: [[f32; 2]; COORDINATE_NAMES.len()],
}

/// Names in use for a vertex's texture coordinates.
const COORDINATE_NAMES: [[&str; 2]; 4] =
    [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let value = match property {
            Property::Float(x) => f64::from(x),
            Property::Double(x) => x,
            Property::Char(x) => f64::from(x),
            Property::UChar(x) => f64::from(x),
            Property::Short(x) => f64::from(x),
            Property::UShort(x) => f64::from(x),
            Property::Int(x) => f64::from(x),
            Property::UInt(x) => f64::from(x),
            _ => return PropertyAccessResult::Ignored,
        };
        match name {
            "x" => self.place[0] = value,
            "y" => self.place[1] = value,
            "z" => self.place[2] = value,
            "nx" => self.normal[0] = value as f32,
            "ny" => self.normal[1] = value as f32,
            "nz" => self.normal[2] = value as f32,
            _ => {
                let mut places = self.coordinates.iter_mut().flatten();
                match COORDINATE_NAMES.as_flattened().iter().position(|known| *known == name) {
                    Some(at) => places.nth(at).into_iter().for_each(|place| *place = value as f32),
                    None => return PropertyAccessResult::Ignored,
                }
            }
        }
        PropertyAccessResult::Set
    }
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    /// A pair of texture coordinates for each corner, one after the other.
    coordinates: Vec<f32>,
}

/// Name of the list of a face's texture coordinates.
const CORNER_COORDINATES: &str = "texcoord";

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let index = |i: i64| u32::try_from(i).unwrap_or(NO_VERTEX);
        match (name, property) {
            (CORNER_COORDINATES, Property::ListFloat(list)) => self.coordinates = list,
            (CORNER_COORDINATES, Property::ListDouble(list)) => {
                self.coordinates = list.into_iter().map(|x| x as f32).collect()
            }
            ("vertex_indices" | "vertex_index", list) => {
                self.corners = match list {
                    Property::ListChar(list) => list.into_iter().map(|i| index(i.into())).collect(),
                    Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
                    Property::ListShort(list) => list.into_iter().map(|i| index(i.into())).collect(),
                    Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
                    Property::ListInt(list) => list.into_iter().map(|i| index(i.into())).collect(),
                    Property::ListUInt(list) => list,
                    _ => return PropertyAccessResult::Ignored,
                }
            }
            _ => return PropertyAccessResult::Ignored,
        }
        PropertyAccessResult::Set
    }
}

impl Face {
    /// Calls `keep` with the triangles of strips. A negative index ends a strip. A triangle with two equal corners is
    /// skipped: it only leads on to the next one.
    fn triangles(&self, mut keep: impl FnMut([u32; 3])) {
        for strip in self.corners.split(|&corner| corner == NO_VERTEX) {
            for (number, corners) in strip.windows(3).enumerate() {
                let &[a, b, c] = corners else { continue };
                if a != b && b != c && c != a {
                    keep(if number % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
    }
}

/// Checks that an element lists vertices. `name` is the plural noun for its entries.
fn check_corners(element: &ElementDef, name: &str) -> Result<(), String> {
    let list = ["vertex_indices", "vertex_index"].iter().find_map(|key| element.properties.get(*key));
    match list.map(|property| &property.data_type) {
        _ if element.count == 0 => Ok(()),
        Some(PropertyType::List(_, ScalarType::Float | ScalarType::Double)) => {
            Err(format!("the vertex_indices of its {name} are not whole numbers"))
        }
        Some(PropertyType::List(..)) => Ok(()),
        _ => Err(format!("its {name} have no list of vertex_indices")),
    }
}

/// What has been read from a file so far.
#[derive(Default)]
struct PlyData {
    vertices: Vertices,
    attributes: Attributes,
    faces: Faces,
    /// The distinct corners of faces, if faces have texture coordinates of their own. Each has its vertex and the bits
    /// of its coordinates, if it has any.
    corners: Option<Interner<(u32, Option<[u32; 2]>)>>,
}

impl PlyData {
    fn vertices(&mut self, body: &mut Body, element: &ElementDef, smooth: bool) -> Result<(), String> {
        for axis in ["x", "y", "z"] {
            match element.properties.get(axis).map(|property| &property.data_type) {
                Some(PropertyType::Scalar(ScalarType::Float)) => {}
                Some(PropertyType::Scalar(_)) => self.vertices = Vertices::Double(Vec::new()),
                _ => return Err(format!("its vertices have no {axis}")),
            }
        }
        let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
        let has_normals = smooth && has(&["nx", "ny", "nz"]);
        let pair = COORDINATE_NAMES.iter().position(|names| has(names));
        body.elements(element, |vertex: Vertex| {
            match &mut self.vertices {
                Vertices::Single(points) => points.push(vertex.place.map(|x| x as f32)),
                Vertices::Double(points) => points.push(vertex.place.into()),
            }
            self.attributes.normals.extend(has_normals.then_some(vertex.normal));
            self.attributes.coordinates.extend(pair.map(|pair| vertex.coordinates[pair]));
        })
    }

    fn push(&mut self, vertices: &[u32], coordinates: &[f32]) {
        let Some(corners) = &mut self.corners else { return self.faces.push(vertices) };
        let has_pairs = coordinates.len() == 2 * vertices.len();
        self.attributes.bare += if has_pairs { 0 } else { vertices.len().saturating_sub(2) };
        let pair = |i: usize| has_pairs.then(|| [coordinates[2 * i], coordinates[2 * i + 1]].map(f32::to_bits));
        let number = |(i, &vertex)| corners.intern((vertex, pair(i)));
        self.faces.push(&vertices.iter().enumerate().map(number).collect::<Vec<_>>());
    }

    /// Makes a vertex of each distinct corner. What corners lack is taken from their vertices.
    fn split_corners(&mut self) -> Result<(), String> {
        let Some(corners) = self.corners.take().map(Interner::into_values) else { return Ok(()) };
        // Checked while vertices still have the numbers of the file.
        check_finite(&self.vertices, &self.attributes)?;
        let count = self.vertices.count();
        if let Some((vertex, _)) = corners.iter().find(|(vertex, _)| *vertex as usize >= count) {
            return Err(no_such_vertex(*vertex, count));
        }
        let Attributes { normals, coordinates, bare } = &mut self.attributes;
        let has_none = coordinates.is_empty() && corners.iter().all(|(_, bits)| bits.is_none());
        if has_none || !coordinates.is_empty() {
            *bare = 0;
        }
        let pair = |&(vertex, bits): &(u32, Option<[u32; 2]>)| match bits {
            Some(bits) => bits.map(f32::from_bits),
            None => coordinates.get(vertex as usize).copied().unwrap_or_default(),
        };
        let pairs: Vec<[f32; 2]> = corners.iter().map(pair).collect();
        if let Some(corner) = pairs.iter().position(|pair| !pair.iter().all(|x| x.is_finite())) {
            let (vertex, _) = corners[corner];
            return Err(format!("texture coordinates at vertex {vertex} (counted from 0) are not finite"));
        }
        *coordinates = if has_none { Vec::new() } else { pairs };
        let vertices = || corners.iter().map(|(vertex, _)| *vertex as usize);
        *normals = if normals.is_empty() { Vec::new() } else { vertices().map(|vertex| normals[vertex]).collect() };
        self.vertices = match &self.vertices {
            Vertices::Single(points) => Vertices::Single(vertices().map(|vertex| points[vertex]).collect()),
            Vertices::Double(points) => Vertices::Double(vertices().map(|vertex| points[vertex]).collect()),
        };
        Ok(())
    }
}

/// Reads the triangles of a file, and the normals of its vertices if `smooth`.
///
/// A vertex with several texture coordinates becomes several vertices.
pub(super) fn read(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let mut body = Body::open(path)?;
    let elements: Vec<ElementDef> = body.header.elements.values().cloned().collect();
    let corner_property = body.header.elements.get("face").and_then(|faces| faces.properties.get(CORNER_COORDINATES));
    let mut lists = PlyData { corners: corner_property.map(|_| Interner::default()), ..PlyData::default() };
    for element in &elements {
        match element.name.as_str() {
            "vertex" => lists.vertices(&mut body, element, smooth)?,
            // Elements without properties are lines of a text file. In a binary file they take no bytes, however many
            // there are.
            _ if element.properties.is_empty() && !body.has_lines() => {}
            "face" => {
                check_corners(element, "faces")?;
                body.elements(element, |face: Face| lists.push(&face.corners, &face.coordinates))?;
            }
            "tristrips" => {
                check_corners(element, "tristrips")?;
                let keep = |strips: Face| strips.triangles(|corners| lists.push(&corners, &[]));
                body.elements(element, keep)?;
            }
            _ => body.elements(element, |_: Vertex| ())?,
        }
    }
    lists.split_corners()?;
    let PlyData { vertices, attributes, faces, .. } = lists;
    let faces = faces.triangles(&vertices)?;
    Ok(MeshFile { vertices, faces, attributes, ..MeshFile::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_ends_in_a_later_batch_says_how_many_elements_it_has_in_total() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cut.ply");
        let header =
            "ply\nformat ascii 1.0\nelement vertex 10000\nproperty float x\nproperty float y\nproperty float z\n";
        std::fs::write(&path, header.to_owned() + "end_header\n" + &"0 0 0\n".repeat(5000)).expect("a file");
        let message = read(&path, false).expect_err("vertices are missing");
        assert_eq!(message, "the file ends too early, while reading element 'vertex' (expected 10000, got 5000)");
    }
}
