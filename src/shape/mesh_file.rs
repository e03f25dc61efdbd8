//! Triangles from PLY, OBJ and glTF files.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType};

use super::{Attributes, Vertices};
use crate::math::DVec3;

/// What a mesh file holds.
pub struct MeshFile {
    /// Its vertices, in the precision of the file.
    pub vertices: Vertices,
    /// Corners of its triangles; polygons are cut into fans.
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

/// Reads a mesh file by its ending, `.ply`, `.obj`, `.gltf` or `.glb`; checks that corners exist and vertices are finite.
///
/// # Errors
/// A sentence that says what is wrong with the file.
pub fn read(path: &Path) -> Result<MeshFile, String> {
    read_with(path, false)
}

/// The same with the normals of the file's vertices, if it has any.
///
/// # Errors
/// A sentence that says what is wrong with the file.
pub fn read_smooth(path: &Path) -> Result<MeshFile, String> {
    read_with(path, true)
}

fn read_with(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_lowercase();
    let file = match ending.as_str() {
        "ply" => read_ply(path, smooth)?,
        "obj" => super::obj::read(path, smooth)?,
        "gltf" | "glb" => super::gltf::read(path, smooth)?,
        _ => return Err("a mesh file ends in .ply, .obj, .gltf or .glb".into()),
    };
    let count = file.vertices.count();
    if let Some(vertex) = (0..count as u32).find(|&index| !file.vertices.at(index).is_finite()) {
        return Err(format!("vertex {vertex} (counted from 0) is not finite"));
    }
    if let Some(corner) = file.faces.iter().flatten().find(|&&corner| corner as usize >= count) {
        let vertex = if *corner == NO_VERTEX { "a negative vertex".into() } else { format!("vertex {corner}") };
        return Err(format!("a face asks for {vertex}, but the {count} vertices count from 0"));
    }
    if file.faces.is_empty() {
        return Err("the file holds no faces".into());
    }
    Ok(file)
}

/// Stands for a negative index: no mesh has so many vertices.
const NO_VERTEX: u32 = u32::MAX;

#[derive(Default)]
struct PlyVertex {
    place: [f64; 3],
    normal: [f32; 3],
    coordinates: [f32; 2],
}

/// Names of a vertex's texture coordinates in use.
const COORDINATES: [[&str; 2]; 4] = [["u", "v"], ["s", "t"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]];

impl PropertyAccess for PlyVertex {
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
            _ => match COORDINATES.iter().find_map(|names| names.iter().position(|known| *known == name)) {
                Some(axis) => self.coordinates[axis] = value as f32,
                None => return PropertyAccessResult::Ignored,
            },
        }
        PropertyAccessResult::Set
    }
}

#[derive(Default)]
struct PlyFace(Vec<u32>);

impl PropertyAccess for PlyFace {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if name != "vertex_indices" && name != "vertex_index" {
            return PropertyAccessResult::Ignored;
        }
        let index = |i: i64| u32::try_from(i).unwrap_or(NO_VERTEX);
        self.0 = match property {
            Property::ListChar(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            Property::ListShort(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            Property::ListInt(list) => list.into_iter().map(|i| index(i.into())).collect(),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::Ignored,
        };
        PropertyAccessResult::Set
    }
}

fn read_ply(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut reader = Reader::new(BufReader::new(file));
    let (vertex_parser, face_parser) = (Parser::<PlyVertex>::new(), Parser::<PlyFace>::new());
    let header = vertex_parser.read_header(&mut reader).map_err(ply_error)?;
    let (mut points, mut polygons, mut double) = (Vec::new(), Vec::new(), false);
    let (mut has_normals, mut has_coordinates) = (false, false);
    for element in header.elements.values() {
        if element.name == "face" {
            polygons = face_parser.read_payload_for_element(&mut reader, element, &header).map_err(ply_error)?;
        } else if element.name == "vertex" {
            for axis in ["x", "y", "z"] {
                match element.properties.get(axis).map(|property| &property.data_type) {
                    Some(PropertyType::Scalar(scalar)) => double |= *scalar != ScalarType::Float,
                    _ => return Err(format!("its vertices have no {axis}")),
                }
            }
            let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
            has_normals = smooth && has(&["nx", "ny", "nz"]);
            has_coordinates = COORDINATES.iter().any(|names| has(names));
            points = vertex_parser.read_payload_for_element(&mut reader, element, &header).map_err(ply_error)?;
        } else {
            vertex_parser.read_payload_for_element(&mut reader, element, &header).map_err(ply_error)?;
        }
    }
    let vertices = if double {
        Vertices::Double(points.iter().map(|p| DVec3::from(p.place)).collect())
    } else {
        Vertices::Single(points.iter().map(|p| p.place.map(|x| x as f32)).collect())
    };
    let mut attributes = Attributes::default();
    if has_normals {
        attributes.normals = points.iter().map(|p| p.normal).collect();
    }
    if has_coordinates {
        attributes.coordinates = points.iter().map(|p| p.coordinates).collect();
    }
    let faces = polygons.iter().flat_map(|polygon| fan(&polygon.0)).collect();
    Ok(MeshFile { vertices, faces, attributes, names_materials: false, ignored: Vec::new(), others: Vec::new() })
}

fn ply_error(error: ply_rs_bw::parser::ParseError) -> String {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default().trim_end_matches('.');
    let message = first.split_once(": ").map_or(first, |(_, message)| message);
    match (message.strip_prefix("Unexpected end of file"), error.line()) {
        (Some(place), _) => format!("the file ends too early,{place}"),
        (None, Some(line)) => format!("line {line} does not fit a PLY file with this header"),
        (None, None) => message.to_owned(),
    }
}

/// The triangles of a convex polygon, all sharing its first corner.
fn fan(polygon: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    let rest = polygon.get(1..).unwrap_or_default();
    rest.windows(2).map(move |pair| [polygon[0], pair[0], pair[1]])
}
