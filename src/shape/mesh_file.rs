//! Triangles from PLY, OBJ and glTF files.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::faces::Faces;
use super::mesh_data::MeshFile;
use super::{Attributes, Vertices};

/// Reads a mesh file by its ending, `.ply`, `.obj`, `.gltf` or `.glb`; checks that corners exist and that
/// vertices and what they carry are finite.
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
    if is_packed(path) {
        return Err("it is compressed by gzip: unpack it first".into());
    }
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
    let Attributes { normals, coordinates, .. } = &file.attributes;
    if let Some(vertex) = normals.iter().position(|normal| !normal.iter().all(|x| x.is_finite())) {
        return Err(format!("the normal of vertex {vertex} (counted from 0) is not finite"));
    }
    if let Some(vertex) = coordinates.iter().position(|pair| !pair.iter().all(|x| x.is_finite())) {
        return Err(format!("the texture coordinates of vertex {vertex} (counted from 0) are not finite"));
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

/// Whether a file begins as gzip begins (RFC 1952, section 2.3.1).
fn is_packed(path: &Path) -> bool {
    begins_with(path, &[0x1f, 0x8b])
}

fn begins_with(path: &Path, bytes: &[u8]) -> bool {
    let mut start = vec![0; bytes.len()];
    File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == bytes
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

impl PlyFace {
    /// The triangles of strips, each of which a negative index ends; two equal corners only lead on to the next
    /// triangle.
    fn triangles(&self, mut keep: impl FnMut([u32; 3])) {
        for strip in self.0.split(|&corner| corner == NO_VERTEX) {
            for (number, corners) in strip.windows(3).enumerate() {
                let &[a, b, c] = corners else { continue };
                if a != b && b != c && c != a {
                    keep(if number % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
    }
}

/// Whether an element lists vertices; `name` is what there are several of.
fn has_corners(element: &ElementDef, name: &str) -> Result<(), String> {
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

fn read_ply(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    // The parser would look for the end of the first line, however far away that is.
    if !begins_with(path, b"ply") {
        return Err("a PLY file begins with a line `ply`, and this one does not".into());
    }
    let file = File::open(path).map_err(|error| error.to_string())?;
    let mut reader = Reader::new(BufReader::new(file));
    let header = Parser::<PlyVertex>::new().read_header(&mut reader).map_err(ply_error)?;
    let (mut vertices, mut faces) = (Vertices::Single(Vec::new()), Faces::default());
    let mut attributes = Attributes::default();
    // Elements without properties are lines of a text, but nothing at all in a binary file, however many there are.
    let takes_no_bytes = |e: &ElementDef| e.properties.is_empty() && header.encoding != Encoding::Ascii;
    for element in header.elements.values() {
        if element.name != "vertex" && takes_no_bytes(element) {
            continue;
        }
        if element.name == "face" {
            has_corners(element, "faces")?;
            in_batches(&mut reader, element, &header, |polygon: PlyFace| faces.push(&polygon.0))?;
        } else if element.name == "tristrips" {
            has_corners(element, "tristrips")?;
            in_batches(&mut reader, element, &header, |strips: PlyFace| strips.triangles(|face| faces.push(&face)))?;
        } else if element.name == "vertex" {
            for axis in ["x", "y", "z"] {
                match element.properties.get(axis).map(|property| &property.data_type) {
                    Some(PropertyType::Scalar(ScalarType::Float)) => {}
                    Some(PropertyType::Scalar(_)) => vertices = Vertices::Double(Vec::new()),
                    _ => return Err(format!("its vertices have no {axis}")),
                }
            }
            let has = |names: &[&str]| names.iter().all(|name| element.properties.contains_key(*name));
            let has_normals = smooth && has(&["nx", "ny", "nz"]);
            let has_coordinates = COORDINATES.iter().any(|names| has(names));
            let keep = |point: PlyVertex| {
                match &mut vertices {
                    Vertices::Single(points) => points.push(point.place.map(|x| x as f32)),
                    Vertices::Double(points) => points.push(point.place.into()),
                }
                attributes.normals.extend(has_normals.then_some(point.normal));
                attributes.coordinates.extend(has_coordinates.then_some(point.coordinates));
            };
            in_batches(&mut reader, element, &header, keep)?;
        } else {
            in_batches(&mut reader, element, &header, |_: PlyVertex| ())?;
        }
    }
    let faces = faces.triangles(&vertices)?;
    Ok(MeshFile { vertices, faces, attributes, names_materials: false, ignored: Vec::new(), others: Vec::new() })
}

/// Elements that are read at once: each takes several times the memory of what is kept of it.
const BATCH: usize = 4096;

/// Hands all elements of one kind over, one after the other.
fn in_batches<E: PropertyAccess>(
    reader: &mut Reader<BufReader<File>>,
    element: &ElementDef,
    header: &Header,
    mut keep: impl FnMut(E),
) -> Result<(), String> {
    let (parser, mut batch) = (Parser::<E>::new(), element.clone());
    for done in (0..element.count).step_by(BATCH) {
        batch.count = BATCH.min(element.count - done);
        let read = parser.read_payload_for_element(reader, &batch, header);
        let of_all = |error| count_from(&ply_error(error), batch.count, done, element.count);
        read.map_err(of_all)?.into_iter().for_each(&mut keep);
    }
    Ok(())
}

/// A message about the end of a file with the numbers of all elements instead of those of a batch.
fn count_from(message: &str, batch: usize, done: usize, all: usize) -> String {
    let numbers = message.split_once(&format!("(expected {batch}, got "));
    let numbers = numbers.and_then(|(before, rest)| Some((before, rest.split_once(')')?)));
    match numbers {
        Some((before, (got, after))) => match got.parse::<usize>() {
            Ok(got) => format!("{before}(expected {all}, got {}){after}", done + got),
            Err(_) => message.to_owned(),
        },
        None => message.to_owned(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_ends_in_a_later_batch_says_how_many_elements_it_has_of_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cut.ply");
        let header =
            "ply\nformat ascii 1.0\nelement vertex 10000\nproperty float x\nproperty float y\nproperty float z\n";
        std::fs::write(&path, header.to_owned() + "end_header\n" + &"0 0 0\n".repeat(5000)).expect("a file");
        let message = read(&path).err().expect("vertices are missing");
        assert_eq!(message, "the file ends too early, while reading element 'vertex' (expected 10000, got 5000)");
    }
}
