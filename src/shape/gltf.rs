//! Triangles from glTF 2.0 files, `.gltf` and `.glb` (Khronos Group 2021, *glTF 2.0 Specification*).

use std::fs;
use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::gltf_buffer::{Accessor, AccessorData, Buffer, BufferView, Store};
use super::mesh_data::MeshFile;
use super::{Attributes, Vertices};
use crate::math::{DMat3, DVec3, Transform};

/// The parts of a file that Abbe reads. Indices refer to lists of the same document.
#[derive(Default, Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Document {
    asset: Asset,
    scene: Option<usize>,
    scenes: Vec<SceneText>,
    nodes: Vec<GltfNode>,
    meshes: Vec<MeshText>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<BufferView>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
    extensions_used: Vec<String>,
    materials: Vec<IgnoredAny>,
    animations: Vec<IgnoredAny>,
    skins: Vec<IgnoredAny>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Asset {
    version: String,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct SceneText {
    nodes: Vec<usize>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct GltfNode {
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct MeshText {
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: AttributesText,
    indices: Option<usize>,
    #[serde(default = "triangles")]
    mode: u32,
    #[serde(default)]
    targets: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct AttributesText {
    position: Option<usize>,
    normal: Option<usize>,
    #[serde(rename = "TEXCOORD_0")]
    coordinates: Option<usize>,
}

/// Returns the value of `mode` that means separate triangles.
fn triangles() -> u32 {
    4
}

/// Prefixes of the names of required extensions that only change appearance.
const HARMLESS_PREFIXES: [&str; 4] = ["KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_punctual"];
/// Extension that stores positions, normals and texture coordinates as integers. They are read in every file.
const QUANTIZED: &str = "KHR_mesh_quantization";
/// Extension that transforms the texture coordinates of materials.
const TEXTURE_TRANSFORM: &str = "KHR_texture_transform";
/// Extension that places a mesh many times. If it is not required, programs that do not support it place the mesh once.
const INSTANCING: &str = "EXT_mesh_gpu_instancing";
/// Tolerance for the last row of an affine matrix, 0, 0, 0, 1, if the matrix was computed from others in 32 bits.
const ROUNDING: f64 = 8.0 * f32::EPSILON as f64;
/// Maximum number of triangles of a file. A small file may place a large mesh as often as it likes.
const MAX_TRIANGLES: usize = 1 << 27;

/// Reads the triangles of a file's default scene, placed by its nodes.
pub(super) fn read(path: &Path, smooth: bool) -> Result<MeshFile, String> {
    let bytes = fs::read(path).map_err(|error| error.to_string())?;
    let (json, binary) = match bytes.starts_with(b"glTF") {
        true => chunks(&bytes)?,
        false => (bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes), None),
    };
    let document: Document =
        serde_json::from_slice(json).map_err(|error| format!("its JSON is not valid glTF: {error}"))?;
    if !document.asset.version.starts_with("2.") {
        return Err(format!("it is glTF {:?}, not 2.0", document.asset.version));
    }
    let is_unsupported =
        |name: &&String| **name != QUANTIZED && !HARMLESS_PREFIXES.iter().any(|start| name.starts_with(start));
    if let Some(name) = document.extensions_required.iter().find(is_unsupported) {
        return Err(format!("it needs the extension {name}, which Abbe does not read"));
    }
    let placed = document.placed_meshes()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let store = Store::open(&document.buffers, folder, binary)?;
    let mut file = document.read(&placed, &store, smooth)?;
    file.materials = document.materials.len();
    let uses = |extension: &str| document.extensions_used.iter().any(|name| name == extension);
    let has_morphs = document.meshes.iter().flat_map(|mesh| &mesh.primitives).any(|p| !p.targets.is_empty());
    for (what, is_present) in [
        ("animations", !document.animations.is_empty()),
        ("skins", !document.skins.is_empty()),
        ("morph targets", has_morphs),
        ("copies by EXT_mesh_gpu_instancing", uses(INSTANCING)),
        ("texture transforms", uses(TEXTURE_TRANSFORM) && !file.attributes.coordinates.is_empty()),
    ] {
        file.ignored.extend(is_present.then_some(what));
    }
    file.others = store.files;
    Ok(file)
}

/// Returns the JSON and the binary chunk of a .glb file (section 4 of the specification).
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let number = |at: usize| bytes.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    let chunk = |at: usize, kind: &[u8]| {
        let named = bytes.get(at + 4..at + 8)? == kind;
        bytes.get(at + 8..(at + 8).checked_add(number(at)?)?).filter(|_| named)
    };
    if number(4) != Some(2) {
        return Err("it is not version 2 of a binary glTF".into());
    }
    let json = chunk(12, b"JSON").ok_or("its first chunk is incomplete, or not JSON")?;
    let after = 20 + json.len().next_multiple_of(4);
    match bytes.len() > after {
        true => Ok((json, Some(chunk(after, b"BIN\0").ok_or("its second chunk is incomplete, or not BIN")?))),
        false => Ok((json, None)),
    }
}

impl Document {
    /// Returns the meshes of the default scene, each with the map from its node's space to the scene's.
    fn placed_meshes(&self) -> Result<Vec<(&MeshText, Transform)>, String> {
        let scene = match self.scene {
            Some(scene) => Some(self.scenes.get(scene).ok_or_else(|| format!("there is no scene {scene}"))?),
            None => self.scenes.first(),
        };
        let roots = scene.map_or_else(|| self.roots(), |scene| scene.nodes.clone());
        let mut visited = vec![false; self.nodes.len()];
        let mut placed = Vec::new();
        let mut open: Vec<(usize, Transform)> = roots.iter().rev().map(|&node| (node, Transform::IDENTITY)).collect();
        while let Some((number, parent_map)) = open.pop() {
            let node = self.nodes.get(number).ok_or_else(|| format!("there is no node {number}"))?;
            if std::mem::replace(&mut visited[number], true) {
                return Err(format!("node {number} is reached twice: nodes must form a tree"));
            }
            let map = node.map().ok_or_else(|| format!("the matrix of node {number} is not affine"))?.then(&parent_map);
            if let Some(mesh) = node.mesh {
                placed.push((self.meshes.get(mesh).ok_or_else(|| format!("there is no mesh {mesh}"))?, map));
            }
            open.extend(node.children.iter().rev().map(|&child| (child, map)));
        }
        Ok(placed)
    }

    /// Returns the nodes that are not children of other nodes.
    fn roots(&self) -> Vec<usize> {
        let mut is_root = vec![true; self.nodes.len()];
        for &child in self.nodes.iter().flat_map(|node| &node.children) {
            is_root.get_mut(child).into_iter().for_each(|root| *root = false);
        }
        (0..self.nodes.len()).filter(|&node| is_root[node]).collect()
    }

    fn read(&self, placed: &[(&MeshText, Transform)], store: &Store, smooth: bool) -> Result<MeshFile, String> {
        let all_identity = placed.iter().all(|(_, map)| *map == Transform::IDENTITY);
        let mut vertices = if all_identity { Vertices::default() } else { Vertices::Double(Vec::new()) };
        let (mut attributes, mut has_normals, mut has_coordinates) = (Attributes::default(), false, false);
        let mut faces = Vec::<[u32; 3]>::new();
        for (mesh, map) in placed {
            for primitive in mesh.primitives.iter().filter(|primitive| (4..=6).contains(&primitive.mode)) {
                let Some(position) = primitive.attributes.position else { continue };
                let points: Vec<[f32; 3]> = self.accessor(position, store)?.floats()?;
                let corners = self.corners(primitive, points.len(), store)?;
                let (first, triangles) = (vertices.count(), assemble(&corners, primitive.mode).count());
                if faces.len() + triangles > MAX_TRIANGLES || first + points.len() > MAX_TRIANGLES {
                    return Err(format!("its nodes place more than {MAX_TRIANGLES} triangles or vertices"));
                }
                let own = self.attributes(primitive, points.len(), store, smooth)?;
                has_normals |= smooth && primitive.attributes.normal.is_some();
                has_coordinates |= primitive.attributes.coordinates.is_some();
                attributes.bare += if primitive.attributes.coordinates.is_some() { 0 } else { triangles };
                attributes.normals.extend(own.transformed(map).normals);
                attributes.coordinates.extend(own.coordinates);
                let place = |corner: u32| corner + first as u32;
                faces.extend(assemble(&corners, primitive.mode).map(|face| map.fix_winding(face.map(place))));
                match &mut vertices {
                    Vertices::Single(all) => all.extend(points),
                    Vertices::Double(all) => all.extend(points.iter().map(|p| map.point(p.map(f64::from).into()))),
                }
            }
        }
        if !has_normals {
            attributes.normals = Vec::new();
        }
        if !has_coordinates {
            (attributes.coordinates, attributes.bare) = (Vec::new(), 0);
        }
        Ok(MeshFile { vertices, faces, attributes, ..MeshFile::default() })
    }

    /// Returns the corners of a primitive with `count` vertices.
    fn corners(&self, primitive: &Primitive, count: usize, store: &Store) -> Result<Vec<u32>, String> {
        let corners = match primitive.indices {
            Some(indices) => self.accessor(indices, store)?.whole_numbers()?,
            None => (0..count as u32).collect(),
        };
        match corners.iter().find(|&&corner| corner as usize >= count) {
            Some(corner) => {
                Err(format!("a face refers to vertex {corner}, but its {count} vertices are numbered from 0"))
            }
            None => Ok(corners),
        }
    }

    /// Returns the normals and texture coordinates of the `count` vertices of a primitive, with zeros where it has
    /// none.
    fn attributes(
        &self,
        primitive: &Primitive,
        count: usize,
        store: &Store,
        smooth: bool,
    ) -> Result<Attributes, String> {
        let mut own = Attributes::default();
        if let Some(normals) = primitive.attributes.normal.filter(|_| smooth) {
            own.normals = self.accessor(normals, store)?.floats()?;
        }
        if let Some(coordinates) = primitive.attributes.coordinates {
            // In glTF, images begin at the top.
            let flipped = |[u, v]: [f32; 2]| [u, 1.0 - v];
            own.coordinates = self.accessor(coordinates, store)?.floats()?.into_iter().map(flipped).collect();
        }
        if [own.normals.len(), own.coordinates.len()].iter().any(|&own| own != 0 && own != count) {
            return Err(format!(
                "a primitive has {count} positions, but a different number of normals or texture coordinates"
            ));
        }
        own.normals.resize(count, [0.0; 3]);
        own.coordinates.resize(count, [0.0; 2]);
        Ok(own)
    }

    fn accessor<'a>(&'a self, number: usize, store: &'a Store) -> Result<AccessorData<'a>, String> {
        let accessor = self.accessors.get(number).ok_or_else(|| format!("there is no accessor {number}"))?;
        Ok(accessor.data(number, &self.buffer_views, store))
    }
}

/// Returns the triangles of a list, a strip or a fan of corners (section 3.7.2.1 of the specification).
fn assemble(corners: &[u32], mode: u32) -> impl Iterator<Item = [u32; 3]> + '_ {
    let count = if mode == triangles() { corners.len() / 3 } else { corners.len().saturating_sub(2) };
    (0..count).map(move |i| {
        match mode {
            4 => [3 * i, 3 * i + 1, 3 * i + 2],
            5 => [i, i + 1 + i % 2, i + 2 - i % 2],
            _ => [i + 1, i + 2, 0],
        }
        .map(|at| corners[at])
    })
}

impl GltfNode {
    /// Returns the map to the space of the parent node, or `None` if the matrix is not affine.
    fn map(&self) -> Option<Transform> {
        if let Some(m) = self.matrix {
            let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
            let is_affine = [m[3], m[7], m[11], m[15] - 1.0].iter().all(|x| x.abs() <= ROUNDING);
            let linear = DMat3::from_cols(column(0), column(1), column(2));
            return is_affine.then(|| Transform::affine(linear, column(3)));
        }
        let scale = self.scale.map_or(Transform::IDENTITY, |scale| Transform::scale(scale.into()));
        let turn =
            self.rotation.map_or(Transform::IDENTITY, |[x, y, z, w]| Transform::quaternion(DVec3::new(x, y, z), w));
        let shift = self.translation.map_or(Transform::IDENTITY, |by| Transform::translate(by.into()));
        Some(scale.then(&turn).then(&shift))
    }
}
