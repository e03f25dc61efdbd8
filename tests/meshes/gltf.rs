//! glTF files: every way to store triangles, nodes that place them, and files that are deliberately broken.

use abbe::math::{DVec3, Transform};
use abbe::shape::{Mesh, read_mesh};
use base64::prelude::*;

use super::files::{FACES, POINTS, file, read, triangles};
use crate::support::random::Random;

/// Returns the pyramid's corners and faces as bytes. The vertex indices have `width` bytes each and begin at byte 60.
fn binary(width: usize) -> Vec<u8> {
    let points = POINTS.iter().flatten().flat_map(|&x| (x as f32).to_le_bytes());
    let corners = FACES.iter().flatten().flat_map(|corner| corner.to_le_bytes()[..width].to_vec());
    points.chain(corners).collect()
}

/// Returns a document of the pyramid, with `uri` as the address of its buffer and more text for its node.
fn document(uri: &str, width: usize, node: &str) -> String {
    let kind = [5121, 5123, 0, 5125][width - 1];
    let length = binary(width).len();
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{node}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}},
{{"bufferView":1,"componentType":{kind},"count":18,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":60}},{{"buffer":0,"byteOffset":60,"byteLength":{}}}],
"buffers":[{{{uri}"byteLength":{length}}}]}}"#,
        length - 60
    )
}

fn embedded(width: usize) -> String {
    format!(r#""uri":"data:application/octet-stream;base64,{}","#, BASE64_STANDARD.encode(binary(width)))
}

fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let json = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let padded = binary.len().next_multiple_of(4);
    let number = |n: usize| (n as u32).to_le_bytes();
    let length = 12 + 8 + json.len() + 8 + padded;
    let head = [b"glTF".as_slice(), &number(2), &number(length)].concat();
    let first = [&number(json.len()), b"JSON".as_slice(), json.as_bytes()].concat();
    let second = [&number(padded), b"BIN\0".as_slice(), binary, &vec![0; padded - binary.len()]].concat();
    [head, first, second].concat()
}

#[test]
fn every_way_to_store_a_gltf_gives_the_same_triangles() {
    for width in [1, 2, 4] {
        assert_eq!(read("a.gltf", document(&embedded(width), width, "").as_bytes()).0, triangles(true));
        assert_eq!(read("a.glb", &glb(&document("", width, ""), &binary(width))).0, triangles(true));
        let marked = format!("\u{feff}{}", document(&embedded(width), width, ""));
        assert_eq!(read("a.gltf", marked.as_bytes()).0, triangles(true));
        let (folder, path) = file("a.GLTF", document(r#""uri":"a%20b.bin","#, width, ""));
        std::fs::write(folder.path().join("a b.bin"), binary(width)).expect("the file can be written");
        let mesh = read_mesh(&path, false).expect("a glTF file");
        assert_eq!(mesh.faces, FACES);
        assert_eq!(mesh.others, [folder.path().join("a b.bin")]);
    }
}

/// `KHR_mesh_quantization`, as gltfpack writes it.
#[test]
fn places_may_be_whole_numbers() {
    let text = |kind: u32, width: usize, normalized: bool| {
        let (view, scale) = (format!(r#"{{"buffer":0,"byteLength":{}}}"#, 20 * width), r#","scale":[2,2,2]"#);
        let head =
            r#""extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_texture_transform"],"scene":0"#;
        let accessor = format!(r#""componentType":{kind},"normalized":{normalized},"count":5"#);
        let json = document("", 1, scale)
            .replace(r#""scene":0"#, head)
            .replace(r#""componentType":5126,"count":5"#, &accessor)
            .replace(
                r#"{"buffer":0,"byteLength":60}"#,
                &view.replace('}', &format!(r#","byteStride":{}}}"#, 4 * width)),
            )
            .replace(r#""byteOffset":60,"#, &format!(r#""byteOffset":{},"#, 20 * width));
        json.replace(r#""byteLength":78"#, &format!(r#""byteLength":{}"#, 20 * width + 18))
    };
    let corners: Vec<u8> = FACES.iter().flatten().map(|&corner| corner as u8).collect();
    // Type of the numbers, their size in bytes, and the number that stands for 1.
    for (kind, width, one) in [(5120, 1, 127), (5121, 1, 255), (5122, 2, 32767), (5123, 2, 65535)] {
        for normalized in [true, false] {
            let place = |point: usize, axis: usize| (point as i64 + 2 * axis as i64) * (one / 9);
            let numbers =
                (0..5).flat_map(|point| (0..4).map(move |axis| if axis < 3 { place(point, axis) } else { 0 }));
            let numbers: Vec<u8> = numbers.flat_map(|number| number.to_le_bytes()[..width].to_vec()).collect();
            let bytes = glb(&text(kind, width, normalized), &[&numbers[..], &corners].concat());
            let scale = if normalized { 2.0 / one as f64 } else { 2.0 };
            let point = |point: u32| {
                DVec3::from([0, 1, 2].map(|axis| f64::from((place(point as usize, axis) as f64 * scale) as f32)))
            };
            for (found, face) in read("a.glb", &bytes).0.iter().zip(FACES) {
                for (found, expected) in found.iter().zip(face.map(point)) {
                    assert!((*found - expected).length() <= 1e-6 * expected.length(), "{kind}: {found} {expected}");
                }
            }
        }
    }
    // The lowest number of a byte stands for -1, and so does the next one.
    let numbers = [[-128_i8, -127, 127, 0], [0; 4], [127, 0, 0, 0], [0, 127, 0, 0], [0; 4]].concat();
    let numbers: Vec<u8> = numbers.into_iter().map(|number| number as u8).collect();
    let (_folder, path) = file("a.glb", glb(&text(5120, 1, true), &[&numbers[..], &corners].concat()));
    let mesh = read_mesh(&path, false).expect("a glTF file");
    assert_eq!(mesh.vertices.at(0), DVec3::new(-2.0, -2.0, 2.0));
    assert!(mesh.ignored.is_empty(), "no texture coordinates are moved where there are none");
}

#[test]
fn texture_transforms_are_reported_as_ignored() {
    let coordinates = r#""POSITION":0,"TEXCOORD_0":2"#;
    let accessor = r#""type":"SCALAR"},{"bufferView":0,"componentType":5126,"count":5,"type":"VEC2"}"#;
    let text = document(&embedded(1), 1, "")
        .replace(r#""POSITION":0"#, coordinates)
        .replace(r#""type":"SCALAR"}"#, accessor)
        .replace(r#""scene":0"#, r#""extensionsUsed":["KHR_texture_transform"],"scene":0"#);
    let (_folder, path) = file("a.gltf", text);
    assert_eq!(read_mesh(&path, false).expect("a glTF file").ignored, ["texture transforms"]);
}

#[test]
fn strips_fans_and_bare_points_become_triangles() {
    let with_mode = |mode: u32, corners: &[u8]| {
        let bytes = [&binary(1)[..60], corners].concat();
        let uri = format!(r#""uri":"data:;base64,{}","#, BASE64_STANDARD.encode(&bytes));
        let text = document(&uri, 1, "").replace(r#""indices":1"#, &format!(r#""indices":1,"mode":{mode}"#));
        let count = corners.len();
        let text = text
            .replace("18,", &format!("{count},"))
            .replace(r#""byteLength":18"#, &format!(r#""byteLength":{count}"#));
        let (_folder, path) = file("a.gltf", text.replace(r#""byteLength":78"#, r#""byteLength":60"#));
        read_mesh(&path, false).map(|mesh| mesh.faces)
    };
    assert_eq!(with_mode(5, &[0, 1, 2, 3, 4]).expect("a strip"), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    assert_eq!(with_mode(6, &[0, 1, 2, 3, 4]).expect("a fan"), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
    assert_eq!(with_mode(4, &[0, 1, 2, 3, 4]).expect("a list"), [[0, 1, 2]]);
    assert_eq!(with_mode(1, &[0, 1, 2, 3]).expect_err("lines"), "the file holds no faces");
    let bare = document(&embedded(1), 1, "").replace(r#","indices":1"#, "");
    assert_eq!(read("a.gltf", bare.as_bytes()).0.len(), 1, "5 points without indices are one triangle");
}

#[test]
fn sparse_entries_replace_those_of_the_view() {
    // Corners 1 and 4 are swapped.
    let swapped = [POINTS[4], POINTS[1]].into_iter().flatten().flat_map(|x| (x as f32).to_le_bytes());
    let bytes: Vec<u8> = binary(1).into_iter().chain([1, 4]).chain(swapped).collect();
    let uri = format!(r#""uri":"data:;base64,{}","#, BASE64_STANDARD.encode(&bytes));
    let sparse = r#""type":"VEC3","sparse":{"count":2,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}"#;
    let text = document(&uri, 1, "").replace(r#""type":"VEC3""#, sparse).replace(
        r#""byteLength":18}]"#,
        r#""byteLength":18},{"buffer":0,"byteOffset":78,"byteLength":2},{"buffer":0,"byteOffset":80,"byteLength":24}]"#,
    );
    let found = read("a.gltf", text.as_bytes()).0;
    let moved = |corner: u32| [0, 4, 2, 3, 1][corner as usize];
    let expected = FACES.map(|face| face.map(|corner| DVec3::from(POINTS[moved(corner)].map(|x| f64::from(x as f32)))));
    assert_eq!(found, expected);
}

#[test]
fn sparse_entries_without_a_view_replace_zeros() {
    // The base stays where it is, and the tip moves to 0.
    let points = POINTS[..4].iter().flatten().flat_map(|&x| (x as f32).to_le_bytes());
    let bytes: Vec<u8> = binary(1).into_iter().chain([0, 1, 2, 3]).chain(points).collect();
    let uri = format!(r#""uri":"data:;base64,{}","#, BASE64_STANDARD.encode(&bytes));
    let sparse = r#"{"componentType":5126,"count":5,"type":"VEC3","sparse":{"count":4,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}}"#;
    let text =
        document(&uri, 1, "").replace(r#"{"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"}"#, sparse);
    let text = text.replace(
        r#""byteLength":18}]"#,
        r#""byteLength":18},{"buffer":0,"byteOffset":78,"byteLength":4},{"buffer":0,"byteOffset":82,"byteLength":48}]"#,
    );
    let point = |corner: u32| {
        if corner == 4 { DVec3::ZERO } else { POINTS[corner as usize].map(|x| f64::from(x as f32)).into() }
    };
    assert_eq!(read("a.gltf", text.as_bytes()).0, FACES.map(|face| face.map(point)));
    let countless = text.replace(r#""count":5"#, r#""count":1000000000000"#);
    let (_folder, path) = file("a.gltf", countless);
    let message = read_mesh(&path, false).err();
    assert_eq!(message.as_deref(), Some("accessor 0 has more entries than the buffers have bytes"));
}

#[test]
fn copies_by_an_extension_are_reported_as_ignored() {
    let used = r#""scene":0,"extensionsUsed":["KHR_materials_ior","EXT_mesh_gpu_instancing"]"#;
    let text = document(&embedded(1), 1, "");
    let (_folder, path) = file("a.gltf", text.replace(r#""scene":0"#, used));
    assert_eq!(read_mesh(&path, false).expect("a glTF file").ignored, ["copies by EXT_mesh_gpu_instancing"]);
    let (_folder, path) = file("a.gltf", text);
    assert_eq!(read_mesh(&path, false).expect("a glTF file").ignored, [""; 0]);
}

#[test]
fn a_matrix_of_a_node_may_have_the_rounding_of_32_bits() {
    let text =
        |last: &str| document(&embedded(1), 1, &format!(r#","matrix":[1,0,0,0,0,1,0,1e-9,0,0,1,0,0,0,0,{last}]"#));
    assert_eq!(read("a.gltf", text("1.0000001").as_bytes()).0, triangles(true));
    let (_folder, path) = file("a.gltf", text("1.00001"));
    assert_eq!(read_mesh(&path, false).err().as_deref(), Some("the matrix of node 0 is not affine"));
}

#[test]
fn nodes_place_their_meshes_and_mirrored_ones_keep_their_front() {
    let (sin, cos) = libm::sincos(20_f64.to_radians());
    let trs = format!(
        r#","rotation":[0,{sin},0,{cos}],"scale":[2,1,-0.5],"translation":[1,2,3]}},{{"children":[0],"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,0,0,1]"#
    );
    let text = document(&embedded(2), 2, &trs).replace(r#""scenes":[{"nodes":[0]}]"#, r#""scenes":[{"nodes":[1]}]"#);
    let map = Transform::scale(DVec3::new(2.0, 1.0, -0.5))
        .then(&Transform::rotate(DVec3::Y, 40.0))
        .then(&Transform::translate(DVec3::new(1.0, 2.0, 3.0)))
        .then(&Transform::rotate(DVec3::Z, 90.0))
        .then(&Transform::translate(DVec3::new(5.0, 0.0, 0.0)));
    let (found, _) = read("a.gltf", text.as_bytes());
    for (found, [a, b, c]) in found.iter().zip(triangles(true)) {
        for (found, expected) in found.iter().zip([a, c, b]) {
            assert!((*found - map.point(expected)).length() < 1e-14, "{found} for {}", map.point(expected));
        }
    }
    // Without a scene, the nodes that are no children of other nodes are shown.
    let unnamed = text.replace(r#""scene":0,"scenes":[{"nodes":[1]}],"#, "");
    assert_eq!(read("a.gltf", unnamed.as_bytes()).0, found);
}

#[test]
fn broken_gltf_files_are_refused_with_the_reason() {
    let good = document(&embedded(1), 1, "");
    let cases = [
        (r#""count":18"#, r#""count":19"#, "accessor 1 reaches beyond buffer view 1"),
        (r#""count":18"#, r#""count":18446744073709551615"#, "accessor 1 reaches beyond buffer view 1"),
        (r#""count":5"#, r#""count":4"#, "a face refers to vertex 4, but its 4 vertices are numbered from 0"),
        (r#""byteOffset":60"#, r#""byteOffset":18446744073709551615"#, "buffer view 1 reaches beyond buffer 0"),
        (r#""byteLength":78"#, r#""byteLength":79"#, "buffer 0 has 78 bytes, not 79"),
        (r#""byteLength":60"#, r#""byteLength":60,"byteStride":0"#, "accessor 0 reaches beyond buffer view 0"),
        (r#""indices":1"#, r#""indices":2"#, "there is no accessor 2"),
        (r#""indices":1"#, r#""indices":0"#, "accessor 0 does not hold whole numbers"),
        (r#""POSITION":0"#, r#""POSITION":1"#, "accessor 1 has components of type 5121"),
        (r#""type":"VEC3""#, r#""type":"VEC2""#, "accessor 0 is of type \"VEC2\", not VEC3"),
        (r#""mesh":0"#, r#""mesh":1"#, "there is no mesh 1"),
        (r#""mesh":0"#, r#""mesh":0,"children":[0]"#, "node 0 is reached twice: nodes must form a tree"),
        (r#""mesh":0"#, r#""mesh":0,"children":[7]"#, "there is no node 7"),
        (r#""mesh":0"#, r#""mesh":0,"matrix":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]"#, "the matrix of node 0 is not affine"),
        (r#""mesh":0"#, r#""mesh":0,"scale":[1e308,1e308,1e308],"translation":[1e308,0,0]"#, ""),
        (r#""scene":0"#, r#""scene":3"#, "there is no scene 3"),
        (r#""version":"2.0""#, r#""version":"1.0""#, "it is glTF \"1.0\", not 2.0"),
        ("base64,", "base64,?", "buffer 0 is not base64 text"),
        (
            r#""scene":0"#,
            r#""scene":0,"extensionsRequired":["KHR_materials_ior","KHR_draco_mesh_compression"]"#,
            "it needs the extension KHR_draco_mesh_compression, which Abbe does not read",
        ),
    ];
    for (old, new, message) in cases {
        assert!(good.contains(old), "{old}");
        let (_folder, path) = file("a.gltf", good.replacen(old, new, 1));
        match read_mesh(&path, false) {
            Err(found) => assert!(found == message || message.is_empty(), "{new}: {found}"),
            Ok(_) => assert!(message.is_empty(), "{new} is accepted"),
        }
    }
    for (text, start) in
        [("", "its JSON is not valid glTF: EOF"), ("[1]", "it is glTF"), ("glTF", "it is not version 2")]
    {
        let (_folder, path) = file("a.glb", text);
        let message = read_mesh(&path, false).expect_err("no glTF");
        assert!(message.starts_with(start) || text == "[1]", "{message}");
    }
    let (_folder, path) = file("a.gltf", document(r#""uri":"absent.bin","#, 1, ""));
    assert_eq!(read_mesh(&path, false).err().as_deref(), Some("there is no file absent.bin beside it"));
}

#[test]
fn a_small_file_cannot_ask_for_much_memory() {
    // 3000 nodes that each place one mesh of 300 000 triangles would give 900 million.
    let corners = vec![0_u8; 900_000];
    let uri = format!(r#""uri":"data:;base64,{}","#, BASE64_STANDARD.encode([&binary(1)[..60], &corners].concat()));
    let text = document(&uri, 1, "").replace(r#""count":18"#, r#""count":900000"#);
    let text = text
        .replace(r#""byteLength":18"#, r#""byteLength":900000"#)
        .replace(r#""byteLength":78"#, r#""byteLength":900060"#);
    let nodes = vec![r#"{"mesh":0}"#; 3000].join(",");
    let children: Vec<String> = (0..3000).map(|i| i.to_string()).collect();
    let text = text
        .replace(r#"[{"mesh":0}]"#, &format!("[{nodes}]"))
        .replace(r#""nodes":[0]"#, &format!(r#""nodes":[{}]"#, children.join(",")));
    let (_folder, path) = file("a.gltf", text);
    assert_eq!(
        read_mesh(&path, false).err().as_deref(),
        Some("its nodes place more than 134217728 triangles or vertices")
    );
}

#[test]
fn no_bytes_make_the_gltf_reader_panic() {
    let sources =
        [glb(&document("", 2, r#","scale":[1,2,3]"#), &binary(2)), document(&embedded(1), 1, "").into_bytes()];
    let mut random = Random::new(77);
    let (_folder, path) = file("a.glb", b"");
    let (mut read, mut refused) = (0, 0);
    for _ in 0..6000 {
        let mut bytes = sources[(random.number() * 2.0) as usize].clone();
        for _ in 0..1 + (random.number() * 3.0) as usize {
            let at = (random.number() * bytes.len() as f64) as usize;
            match (random.number() * 4.0) as u32 {
                0 => bytes[at] = (random.number() * 256.0) as u8,
                // Numbers grow, shrink and change their signs where there is a digit.
                1 => bytes[at] = b"0123456789-e.\"[]{},"[(random.number() * 19.0) as usize],
                2 => drop(bytes.remove(at)),
                _ => bytes.insert(at, b"90"[(random.number() * 2.0) as usize]),
            }
        }
        std::fs::write(&path, &bytes).expect("the file can be written");
        match read_mesh(&path, false) {
            Ok(mesh) => {
                read += 1;
                drop(Mesh::new(mesh.vertices, mesh.faces));
            }
            Err(message) => {
                refused += 1;
                assert!(!message.is_empty());
            }
        }
    }
    assert!(read > 100 && refused > 500, "{read} read, {refused} refused");
}
