//! Triangles from OBJ files (Wavefront 1991, *Advanced Visualizer Manual*, appendix B1).

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::Path;

use smallvec::SmallVec;

use super::faces::Faces;
use super::interner::Interner;
use super::mesh_data::MeshFile;
use super::{Attributes, Vertices};
use crate::math::{Bounds, DVec3};

/// Reads the triangles of all objects of a file, and the normals of its vertices if `smooth`.
///
/// A vertex with several texture coordinates becomes several vertices, and so does one with several normals if they are
/// read.
pub(super) fn read(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    // Names and comments may be in any encoding.
    let text = String::from_utf8_lossy(&bytes);
    let mut lists = ObjData::default();
    for (line, statement) in statements(text.strip_prefix('\u{feff}').unwrap_or(&text)) {
        let words: SmallVec<[&str; 8]> = statement.split_whitespace().collect();
        let Some((keyword, words)) = words.split_first() else { continue };
        match *keyword {
            "v" => {
                lists.positions.push(position(words).map_err(|problem| format!("the vertex in line {line} {problem}"))?)
            }
            "vt" => {
                let coordinates = coordinates(words);
                let error_text = |problem| format!("the texture coordinate in line {line} {problem}");
                lists.coordinates.push(coordinates.map_err(error_text)?);
            }
            "vn" => {
                // Some programs write normals that are not numbers for faces without area.
                let normal = if smooth { numbers(words) } else { Ok([0.0; 3]) };
                let normal = normal.map_err(|problem| format!("the normal in line {line} {problem}"))?;
                lists.normals.push(normal.map(|x| x as f32));
            }
            "f" | "fo" => {
                lists.add_face(line, words, smooth).map_err(|problem| format!("the face in line {line} {problem}"))?
            }
            "mtllib" => lists.has_library = true,
            "usemtl" => drop(lists.materials.insert(words.join(" "))),
            _ => {}
        }
    }
    lists.into_file()
}

/// Returns the statements of a text, one per line and without comments, each with its line number. A backslash at the
/// end of a line continues it on the next one.
fn statements(text: &str) -> impl Iterator<Item = (usize, Cow<'_, str>)> {
    // A carriage return ends a line as well, unless a line feed follows it: then it is white space at the line's end.
    let lines = text.split('\n').flat_map(|line| line.strip_suffix('\r').unwrap_or(line).split('\r'));
    let mut lines = lines.map(|line| line.split('#').next().unwrap_or_default()).zip(1..);
    std::iter::from_fn(move || {
        let (mut line, number) = lines.next()?;
        let mut whole = String::new();
        while let Some(before) = line.trim_end().strip_suffix('\\') {
            whole.extend([before, " "]);
            line = lines.next().map_or("", |(line, _)| line);
        }
        let is_whole = whole.is_empty();
        whole.push_str(if is_whole { "" } else { line });
        Some((number, if is_whole { Cow::Borrowed(line) } else { Cow::Owned(whole) }))
    })
}

fn number(word: &str) -> Result<f64, &'static str> {
    let number: f64 = word.parse().map_err(|_| "is not made of numbers")?;
    if (number as f32).is_finite() { Ok(number) } else { Err("is not finite") }
}

/// Returns the first K numbers of a line.
fn numbers<const K: usize>(words: &[&str]) -> Result<[f64; K], &'static str> {
    let words = words.first_chunk::<K>().ok_or("has too few numbers")?;
    let mut numbers = [0.0; K];
    for (slot, word) in numbers.iter_mut().zip(words) {
        *slot = number(word)?;
    }
    Ok(numbers)
}

/// Reads a position. A fourth number is a weight. With a color there are six numbers or more, and the color is ignored.
fn position(words: &[&str]) -> Result<[f64; 3], &'static str> {
    let position = numbers::<3>(words)?;
    let [_, _, _, weight] = words else { return Ok(position) };
    let weight = number(weight)?;
    let position = position.map(|x| x / weight);
    if position.iter().all(|&x| (x as f32).is_finite()) { Ok(position) } else { Err("is not finite") }
}

/// Reads texture coordinates. One number is enough for a one-dimensional texture. A third number is a depth and is
/// ignored.
fn coordinates(words: &[&str]) -> Result<[f32; 2], &'static str> {
    let pair = if let [u] = words { [number(u)?, 0.0] } else { numbers(words)? };
    Ok(pair.map(|x| x as f32))
}

/// Largest ratio of the positions' distance from the origin to their extent at which they are kept in 32 bits.
/// Roundings are then at most a millionth of the extent, 2^-24 times this ratio.
const MAX_DISTANCE_RATIO: f64 = 16.0;

/// Returns the positions of vertices, in 64 bits where 32 would round them by too much.
fn vertices(positions: impl Iterator<Item = [f64; 3]> + Clone) -> Vertices {
    let bounds = Bounds::around(positions.clone().map(DVec3::from));
    let widest = bounds.size().max_element();
    if bounds.min.abs().max(bounds.max.abs()).max_element() <= MAX_DISTANCE_RATIO * widest {
        Vertices::Single(positions.map(|position| position.map(|x| x as f32)).collect())
    } else {
        Vertices::Double(positions.map(DVec3::from).collect())
    }
}

/// Indices of a corner's position, texture coordinates and normal, each into a list of its own.
type Corner = [u32; 3];

/// Stands for texture coordinates or a normal that a corner does not have.
const NO_INDEX: u32 = u32::MAX;

const LIST_NAMES: [&str; 3] = ["vertex", "texture coordinate", "normal"];

fn missing_entry(kind: usize) -> String {
    format!("refers to a {} that the file does not have", LIST_NAMES[kind])
}

/// What has been read from a file so far.
#[derive(Default)]
struct ObjData {
    positions: Vec<[f64; 3]>,
    coordinates: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    corners: Interner<Corner>,
    faces: Faces,
    /// Number of triangles in faces that leave out texture coordinates.
    bare: usize,
    /// The highest index into each list that a face uses, with its line. Lists may be filled later.
    highest: [(u32, usize); 3],
    has_library: bool,
    /// Names of the materials.
    materials: BTreeSet<String>,
}

impl ObjData {
    fn add_face(&mut self, line: usize, words: &[&str], smooth: bool) -> Result<(), String> {
        let (mut face, mut is_bare) = (Vec::with_capacity(words.len()), false);
        for word in words {
            let mut corner = self.corner(line, word)?;
            if !smooth {
                corner[2] = NO_INDEX;
            }
            is_bare |= corner[1] == NO_INDEX;
            face.push(self.corners.intern(corner));
        }
        self.bare += if is_bare { face.len().saturating_sub(2) } else { 0 };
        self.faces.push(&face);
        Ok(())
    }

    /// Reads a corner such as 3, 3/2, 3//1 or 3/2/1. Numbers count from 1, or, if negative, back from the last entry so
    /// far.
    fn corner(&mut self, line: usize, word: &str) -> Result<Corner, String> {
        let counts = [self.positions.len(), self.coordinates.len(), self.normals.len()];
        let mut corner = [NO_INDEX; 3];
        for (kind, number) in word.split('/').enumerate() {
            if kind > 0 && number.is_empty() {
                continue;
            }
            let number: i64 = number.parse().map_err(|_| "is not made of whole numbers")?;
            let Some(slot) = corner.get_mut(kind) else { return Err("is not made of whole numbers".into()) };
            let index = if number < 0 { (counts[kind] as i64).checked_add(number) } else { number.checked_sub(1) };
            let index = index.and_then(|index| u32::try_from(index).ok()).filter(|&index| index != NO_INDEX);
            *slot = index.ok_or_else(|| missing_entry(kind))?;
            if *slot >= self.highest[kind].0 {
                self.highest[kind] = (*slot, line);
            }
        }
        Ok(corner)
    }

    fn into_file(self) -> Result<MeshFile, String> {
        let counts = [self.positions.len(), self.coordinates.len(), self.normals.len()];
        for (kind, (highest, line)) in self.highest.into_iter().enumerate() {
            // Some programs leave out a list, but not the indices into it.
            let is_left_out = kind > 0 && counts[kind] == 0;
            if line > 0 && !is_left_out && highest as usize >= counts[kind] {
                return Err(format!("the face in line {line} {}", missing_entry(kind)));
            }
        }
        let (mut attributes, corners) = (Attributes::default(), self.corners.into_values());
        let has = |kind: usize| counts[kind] > 0 && corners.iter().any(|corner| corner[kind] != NO_INDEX);
        if has(1) {
            let lookup = |corner: &Corner| self.coordinates.get(corner[1] as usize).copied().unwrap_or_default();
            attributes.bare = self.bare;
            attributes.coordinates = corners.iter().map(lookup).collect();
        }
        if has(2) {
            let lookup = |corner: &Corner| self.normals.get(corner[2] as usize).copied().unwrap_or_default();
            attributes.normals = corners.iter().map(lookup).collect();
        }
        let vertices = vertices(corners.iter().map(|corner| self.positions[corner[0] as usize]));
        let (faces, materials) = (self.faces.triangles(&vertices)?, self.materials.len().max(self.has_library.into()));
        Ok(MeshFile { vertices, faces, attributes, materials, ..MeshFile::default() })
    }
}
