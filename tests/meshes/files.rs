//! PLY and OBJ files, and the triangles that are made of them.

use std::path::{Path, PathBuf};

use abbe::math::{DVec3, Ray, Transform};
use abbe::shape::{Mesh, Shape, Vertices, read_mesh};

use crate::support::random::Random;
use crate::support::run::Folder;
use crate::support::scenes::{render_text, scene, scene_in};

/// A pyramid over a square, whose base is divided into two triangles. No coordinate is exact in 32 bits.
pub const POINTS: [[f64; 3]; 5] =
    [[-0.9, 0.1, 0.7], [0.8, 0.1, 0.7], [0.8, 0.1, -1.1], [-0.9, 0.1, -1.1], [0.05, 1.3, -0.2]];
pub const FACES: [[u32; 3]; 6] = [[0, 3, 2], [0, 2, 1], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
const INSIDE: DVec3 = DVec3::new(0.0, 0.4, -0.2);

/// Returns the pyramid's triangles with the precision of 32 or 64 bits.
pub fn triangles(single: bool) -> Vec<[DVec3; 3]> {
    let round = |x: f64| if single { f64::from(x as f32) } else { x };
    FACES.map(|face| face.map(|corner| DVec3::from(POINTS[corner as usize].map(round)))).to_vec()
}

/// Creates a folder with one file in it. Returns the folder and the path of the file.
pub fn file(name: &str, bytes: impl AsRef<[u8]>) -> (Folder, PathBuf) {
    let folder = Folder::with(name, bytes);
    let path = folder.path_of(name);
    (folder, path)
}

/// Reads the triangles of a file, and whether it names materials.
pub fn read(name: &str, bytes: &[u8]) -> (Vec<[DVec3; 3]>, bool) {
    let (_folder, path) = file(name, bytes);
    let mesh = read_mesh(&path, false).unwrap_or_else(|message| panic!("{name}: {message}"));
    (mesh.faces.iter().map(|face| face.map(|corner| mesh.vertices.at(corner))).collect(), mesh.materials > 0)
}

fn ply_header(format: &str, number: &str, corners: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a pyramid\nelement vertex 5\nproperty {number} x\nproperty {number} y\n\
         property {number} z\nproperty uchar red\nelement face 5\n\
         property list uchar {corners} vertex_indices\nend_header\n"
    )
}

/// The base as a square, which a fan divides into the triangles of `FACES`.
const POLYGONS: [&[u32]; 5] = [&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];

fn ply_text() -> String {
    let vertices = POINTS.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    let faces = POLYGONS.map(|polygon| {
        let corners: Vec<String> = polygon.iter().map(u32::to_string).collect();
        format!("{} {}\n", polygon.len(), corners.join(" "))
    });
    ply_header("ascii", "float", "int") + &vertices + &faces.concat()
}

/// Returns the bytes of a number in little-endian or big-endian order.
fn in_byte_order<const N: usize>(little: [u8; N], big: bool) -> Vec<u8> {
    if big { little.into_iter().rev().collect() } else { little.to_vec() }
}

fn ply_binary(big: bool, single: bool) -> Vec<u8> {
    let format = if big { "binary_big_endian" } else { "binary_little_endian" };
    let (number, corners) = if single { ("float", "int") } else { ("double", "ushort") };
    let mut bytes = ply_header(format, number, corners).into_bytes();
    for point in POINTS {
        for x in point {
            bytes.extend(if single {
                in_byte_order((x as f32).to_le_bytes(), big)
            } else {
                in_byte_order(x.to_le_bytes(), big)
            });
        }
        bytes.push(255);
    }
    for polygon in POLYGONS {
        bytes.push(polygon.len() as u8);
        for &corner in polygon {
            let corner = if single {
                in_byte_order(corner.to_le_bytes(), big)
            } else {
                in_byte_order((corner as u16).to_le_bytes(), big)
            };
            bytes.extend(corner);
        }
    }
    bytes
}

#[test]
fn every_kind_of_ply_gives_the_same_triangles() {
    assert_eq!(read("a.ply", ply_text().as_bytes()).0, triangles(true));
    let windows = ply_text().replace('\n', "\r\n");
    assert_eq!(read("b.ply", windows.as_bytes()).0, triangles(true));
    let old_macintosh = ply_text().replace('\n', "\r");
    assert_eq!(read("d.ply", old_macintosh.as_bytes()).0, triangles(true));
    let binary = ply_binary(false, true);
    let header = ply_header("binary_little_endian", "float", "int");
    let old_header = header.replace('\n', "\r").into_bytes();
    assert_eq!(read("e.ply", &[&old_header, &binary[header.len()..]].concat()).0, triangles(true));
    for big in [false, true] {
        for single in [false, true] {
            assert_eq!(read("c.PLY", &ply_binary(big, single)).0, triangles(single), "big {big}, single {single}");
        }
    }
}

#[test]
fn a_ply_in_lines_may_write_numbers_and_comments_in_any_way() {
    let text = ply_text();
    // A comment that is not UTF-8.
    let latin = |bytes: &[u8]| {
        let at = bytes.windows(7).position(|part| part == b"pyramid").expect("its comment");
        [&bytes[..at], b"r\xe4t", &bytes[at + 7..]].concat()
    };
    let body = |change: &dyn Fn(&str) -> String| {
        let (header, body) = text.split_once("end_header\n").expect("a header");
        format!("{header}end_header\n{}", change(body)).into_bytes()
    };
    for bytes in [
        latin(text.as_bytes()),
        latin(&ply_binary(false, true)),
        body(&|body| body.replace("0.", ".").replace(" 255", " +255")),
        body(&|body| body.replace("1.1", "11.e-1").replace("1.3", "13.E-1")),
        body(&|body| body.replace('\n', "\n\n")),
        body(&|body| body.replace('\n', " \r\n\t").replace(' ', "  ")),
    ] {
        assert_eq!(read("a.ply", &bytes).0, triangles(true), "{}", String::from_utf8_lossy(&bytes));
    }
    // Programs write NaN normals for faces without area.
    let header = "ply\nformat ascii 1.0\nelement vertex 3\n".to_owned()
        + &["x", "y", "z", "nx", "ny", "nz"].map(|name| format!("property float {name}\n")).concat();
    let header = header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    let (_folder, path) = file("a.ply", header + "0 0 0 nan -nan NaN\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n");
    assert_eq!(read_mesh(&path, false).expect("its normals are not used").faces, [[0, 1, 2]]);
    let reported = read_mesh(&path, true).err();
    assert_eq!(reported.as_deref(), Some("the normal of vertex 0 (counted from 0) is not finite"));
}

#[test]
fn strips_of_a_ply_are_cut_into_triangles() {
    let header = ply_header("ascii", "float", "int").replace("element face 5", "element tristrips 2");
    let vertices = POINTS.map(|[x, y, z]| format!("{x} {y} {z} 255\n")).concat();
    // The second strip returns to where it was without a triangle.
    let strips = "8 0 3 2 -1 2 1 0 4\n13 1 2 4 3 -1 -7 0 4 3 -1 4 4 0\n";
    let (_folder, path) = file("a.ply", header.replace("uchar int", "int int") + &vertices + strips);
    let expected = [[0, 3, 2], [2, 1, 0], [0, 1, 4], [1, 2, 4], [4, 2, 3], [0, 4, 3]];
    assert_eq!(read_mesh(&path, false).expect("strips").faces, expected);
}

#[test]
fn invalid_faces_of_a_ply_are_reported() {
    let refusal = |from: &str, to: &str| {
        let (_folder, path) = file("a.ply", ply_text().replace(from, to));
        read_mesh(&path, false).err().unwrap_or_default()
    };
    let list = "list uchar int vertex_indices";
    assert_eq!(refusal(list, list), "");
    let floats = refusal("uchar int", "uchar float");
    assert_eq!(floats, "the vertex_indices of its faces are not whole numbers");
    assert_eq!(refusal(list, "list uchar int corners"), "its faces have no list of vertex_indices");
    assert_eq!(refusal(list, "int vertex_indices"), "its faces have no list of vertex_indices");
    assert_eq!(
        refusal("element face 5\nproperty list uchar int vertex_indices", "element face 0"),
        "the file holds no faces"
    );
    let header = ply_header("binary_little_endian", "float", "int").replace("uchar int", "int int");
    let (_folder, path) = file("a.ply", [header.as_bytes(), &[0; 13 * 5], &[255; 4 * 4 * 5]].concat());
    let reported = read_mesh(&path, false).err();
    assert_eq!(reported.as_deref(), Some("its bytes do not fit a PLY file with this header"));
    for name in ["a.ply", "a.obj", "a.glb"] {
        let (_folder, path) = file(name, b"\x1f\x8b\x08\0\0\0\0\0");
        assert_eq!(read_mesh(&path, false).err().as_deref(), Some("it is compressed with gzip: unpack it first"));
    }
}

#[test]
fn every_way_to_write_an_obj_gives_the_same_triangles() {
    let vertices = POINTS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = [
        "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n",
        "f -5 -2 -3 -4\nf -5 -4 -1\nf -4 -3 -1\nf -3 -2 -1\nf -2 -5 -1\n",
        "vt 0 0\nvn 0 1 0\nf 1/1/1 4/1/1 3/1/1 2/1/1\nf 1//1 2//1 5//1\nf 2/1 3/1 5/1\nf 3 4 5\nf 4 1 5\n",
        "o base\nf 1 4 3 2\no sides\ng two\nf 1 2 5\nf 2 3 5\ng more\nf 3 4 5\nf 4 1 5\n",
    ];
    for faces in faces {
        let (found, names_materials) = read("a.obj", (vertices.clone() + faces).as_bytes());
        assert_eq!(found, triangles(true), "{faces}");
        assert!(!names_materials, "{faces}");
    }
}

#[test]
fn all_that_an_obj_may_hold_besides_is_read_or_passed_over() {
    let vertices = POINTS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let plain = vertices.clone() + faces;
    let colors = POINTS.map(|[x, y, z]| format!("v {x} {y} {z} 1 0.5 0\n")).concat();
    let weighed = POINTS.map(|[x, y, z]| format!("v {} {} {} 2\n", 2.0 * x as f32, 2.0 * y as f32, 2.0 * z as f32));
    for text in [
        format!("\u{feff}{plain}"),
        format!("\u{feff}# a pyramid\n{plain}"),
        plain.replace('\n', "\r\n"),
        plain.replace('\n', "\r"),
        format!("# a comment\r\n{}\r\n", plain.replace('\n', "\r")),
        plain.replacen('\n', "\r", 3),
        plain.replace('\n', " # a comment\n"),
        plain.replace(" 5\n", " \\\n5\n"),
        plain.replace(' ', " \\  \r\n\t"),
        format!("# a comment ends there \\\n{plain}\\"),
        plain.replace("f ", "fo "),
        plain.replace(' ', "\t  ") + "l 1 2 3\np 4\nf 1 2\nf 3\nf\nvp 0.5\ncurv 0 1 1 2\n",
        format!("{faces}{vertices}"),
        format!("vt 0.5\nvt 1 2 3\n{}", plain.replace(" 5\n", " 5/2\n").replace("f 2 ", "f 2/1 ")),
        // The texture coordinates that it refers to do not exist.
        plain.replace(" 5\n", " 5/7\n"),
        format!("{colors}{faces}"),
        format!("{}{faces}", weighed.concat()),
    ] {
        assert_eq!(read("a.obj", text.as_bytes()).0, triangles(true), "{text}");
    }
}

/// Points that are far from the origin for their size keep all digits. Others take half the memory.
#[test]
fn an_obj_far_from_the_origin_is_as_exact_as_near_it() {
    let faces = "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    for (far, is_rounded) in [(0.0, true), (1e7 + 0.1, false)] {
        let text = POINTS.map(|[x, y, z]| format!("v {} {y} {z}\n", x + far)).concat() + faces;
        let (_folder, path) = file("far.obj", text);
        let mesh = read_mesh(&path, false).expect("it is right");
        assert_eq!(matches!(mesh.vertices, Vertices::Single(_)), is_rounded);
        for [x, y, z] in POINTS {
            let there = DVec3::new(x + far, y, z);
            assert!((0..5).any(|number| (mesh.vertices.at(number) - there).length() < 1e-7), "{there}");
        }
    }
}

#[test]
fn broken_obj_files_are_refused_with_the_line() {
    let good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n";
    for (old, new, message) in [
        ("f", "# \nf", ""),
        ("v 1 0 0", "v 1,0 0 0", "the vertex in line 2 is not made of numbers"),
        ("v 1 0 0", "v 1 0", "the vertex in line 2 has too few numbers"),
        ("v 1 0 0", "v 1 0 0 0", "the vertex in line 2 is not finite"),
        ("v 1 0 0", "v \\\n1 0 inf", "the vertex in line 2 is not finite"),
        ("vt 0 0", "vt", "the texture coordinate in line 4 has too few numbers"),
        ("vt 0 0", "vt 0 zero", "the texture coordinate in line 4 is not made of numbers"),
        ("vt 0 0", "vt nan 0", "the texture coordinate in line 4 is not finite"),
        ("vn 0 0 1", "vn 0 0", "the normal in line 5 has too few numbers"),
        ("vn 0 0 1", "vn 0 1e39 0", "the normal in line 5 is not finite"),
        ("f 1/", "f one/", "the face in line 6 is not made of whole numbers"),
        ("f 1/", "f /", "the face in line 6 is not made of whole numbers"),
        ("f 1/1/1", "f 1/1/1/1", "the face in line 6 is not made of whole numbers"),
        ("f 1/", "f 0/", "the face in line 6 refers to a vertex that the file does not have"),
        ("f 1/", "f 4/", "the face in line 6 refers to a vertex that the file does not have"),
        ("f 1/1/", "f 1/2/", "the face in line 6 refers to a texture coordinate that the file does not have"),
        ("f 1/1/1", "f 1/1/-2", "the face in line 6 refers to a normal that the file does not have"),
    ] {
        let (_folder, path) = file("a.obj", good.replace(old, new));
        assert_eq!(read_mesh(&path, true).err().unwrap_or_default(), message, "{new}");
        // Unused normals may be anything, as for faces without area.
        let is_of_normal = message.starts_with("the normal");
        assert_eq!(read_mesh(&path, false).is_err(), !message.is_empty() && !is_of_normal, "{new}");
    }
}

/// The corners of an L. A fan from one of them does not stay inside.
const CORNERS: [[i32; 2]; 6] = [[2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 0]];

/// Returns twice the total area of triangles in a plane of constant z, whichever way they face.
fn doubled_area(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|[a, b, c]| (*b - *a).cross(*c - *a).z.abs()).sum()
}

#[test]
fn faces_that_are_not_convex_cover_their_area_once() {
    let points = CORNERS.map(|[x, y]| format!("{x} {y} 0\n")).concat();
    let header = ply_header("ascii", "float", "int").replace("property uchar red\n", "");
    let header = header.replace("vertex 5", "vertex 6").replace("face 5", "face 1");
    let ply = format!("{header}{points}6 0 1 2 3 4 5\n");
    // An L whose faces are listed before its vertices is divided as well.
    let (vertices, faces) = header.split_once("element face").expect("it has faces");
    let (faces, _) = faces.split_once("end_header").expect("it ends");
    let (first, vertices) = vertices.split_once("element vertex").expect("it has vertices");
    let late = format!("{first}element face{faces}element vertex{vertices}end_header\n6 0 1 2 3 4 5\n{points}");
    let obj = CORNERS.map(|[x, y]| format!("v {x} {y} 0\n")).concat() + "f 1 2 3 4 5 6\n";
    for (name, text) in [("a.ply", ply), ("b.ply", late), ("a.obj", obj)] {
        let triangles = read(name, text.as_bytes()).0;
        assert_eq!((triangles.len(), doubled_area(&triangles)), (4, 6.0), "{text}");
    }
}

/// A scene that writes an L as one face has the same mesh as a file that does.
#[test]
fn faces_of_many_corners_that_a_scene_writes_are_cut_as_those_of_a_file() {
    let obj = CORNERS.map(|[x, y]| format!("v {x} {y} 0\n")).concat() + "f 1 2 3 4 5 6\n";
    let (_folder, path) = file("l.obj", &obj);
    let points = CORNERS.map(|[x, y]| [x, y, 0]);
    let mesh_and_pixels = |mesh: &str| {
        let text = format!(
            "camera = {{ position = [1, 1, 5], look_at = [1, 1, 0], vertical_fov = 40 }}\n\
             film = {{ width = 16, height = 16 }}\n[[object]]\nmaterial = \"stuff\"\nshape.mesh = {{ {mesh} }}\n\
             [material.stuff]\nemissive.radiance = 1\n"
        );
        let Shape::Mesh(mesh) = &*scene(&text).objects[0].shape else { panic!("{text}") };
        (mesh.count(), render_text(&text).rgb())
    };
    let (count, image) = mesh_and_pixels(&format!("points = {points:?}, faces = [[0, 1, 2, 3, 4, 5]]"));
    assert!((count, &image) == (4, &mesh_and_pixels(&format!("file = {path:?}")).1), "{count} triangles");
    // The face covers 3 of the visible area of (10 tan 20 degrees)^2.
    let share = image.iter().map(|rgb| f64::from(rgb[1])).sum::<f64>() / 256.0;
    assert!((share - 0.2264).abs() < 0.01, "{share}");
}

/// Returns the warnings of a scene whose only object is a mesh file with some material.
fn warnings(name: &str, bytes: &[u8], material: &str) -> Vec<String> {
    let folder = Folder::with(name, bytes);
    let text = format!(
        "camera = {{ position = [0, 1, 5], look_at = [0, 0, 0], vertical_fov = 40 }}\n\
         film = {{ width = 4, height = 4 }}\nlight = [{{ environment.radiance = 1 }}]\nmaterial.stuff.{material}\n\
         [[object]]\nname = \"pyramid\"\nshape.mesh.file = \"{name}\"\nmaterial = \"stuff\"\n"
    );
    scene_in(folder.path(), &text).warnings
}

#[test]
fn materials_of_an_obj_are_ignored_with_a_warning() {
    let body = POINTS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat() + "f 1 4 3 2\nf 1 2 5\nf 2 3 5\n";
    let with_library = format!("mtllib absent.mtl\n{body}usemtl red\nf 3 4 5\nf 4 1 5\n");
    assert_eq!(read("a.obj", with_library.as_bytes()), (triangles(true), true));
    let warned = warnings("a.obj", with_library.as_bytes(), "mirror = {}");
    assert_eq!(warned, ["pyramid: the materials of a.obj are ignored; the scene defines them"]);
    let warned = warnings("a.obj", (with_library.clone() + "usemtl blue\nusemtl red\n").as_bytes(), "mirror = {}");
    let why = "the scene gives it one: save parts that look different as separate files";
    assert_eq!(warned, [format!("pyramid: the 2 materials of a.obj are ignored; {why}")]);
    let without_library = format!("{body}usemtl red\nf 3 4 5\nf 4 1 5\n");
    assert_eq!(read("a.obj", without_library.as_bytes()).0, triangles(true));
    assert!(warnings("a.obj", format!("{body}f 3 4 5\nf 4 1 5\n").as_bytes(), "mirror = {}").is_empty());
}

#[test]
fn faces_without_texture_coordinates_below_an_image_cause_a_warning() {
    let places = POINTS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat() + "vt 0.25 0.5\nvt 1 1\nvt 0 1\n";
    let some = places.clone() + "f 1/1 4/2 3/3 2/2\no sides\nf 1/1 2/2 5\nf 2 3 5\nf 3/1 4/2 5/3\nf 4/1 1/2 5/3\n";
    let warned = warnings("a.obj", some.as_bytes(), "diffuse.reflectance.checker = [0.2, 0.8]");
    let shown = "have no texture coordinates: they show the image where u and v are 0";
    assert_eq!(warned, [format!("pyramid: 2 triangles of a.obj {shown}")]);
    assert!(warnings("a.obj", some.as_bytes(), "diffuse.reflectance = 0.5").is_empty());
    let all = places + "f 1/1 4/2 3/3 2/2\nf 1/1 2/2 5/1\n";
    assert!(warnings("a.obj", all.as_bytes(), "diffuse.reflectance.checker = [0.2, 0.8]").is_empty());
}

#[test]
fn a_dielectric_on_an_open_mesh_causes_a_warning_and_on_a_closed_one_none() {
    let closed =
        POINTS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat() + "f 1 4 3 2\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let glass = "dielectric.index = 1.5";
    assert!(warnings("a.obj", closed.as_bytes(), glass).is_empty());
    let open = closed.replace("f 1 4 3 2\n", "");
    let warned = warnings("a.obj", open.as_bytes(), glass);
    assert_eq!(warned, ["pyramid: a dielectric on an open mesh: light may enter it and never leave"]);
    assert!(warnings("a.obj", open.as_bytes(), "mirror = {}").is_empty());
    let turned = closed.replace("f 1 2 5\n", "f 2 1 5\n");
    let reverse = "reverse the order of the corners, or recalculate the normals in the program that made it";
    let warned = warnings("a.obj", turned.as_bytes(), glass);
    assert_eq!(warned, [format!("pyramid: 1 triangle of this closed mesh is flipped: {reverse}")]);
    let more = turned.replace("f 1 4 3 2\n", "f 1 2 3 4\n");
    let warned = warnings("a.obj", more.as_bytes(), glass);
    assert_eq!(warned, [format!("pyramid: 3 triangles of this closed mesh are flipped: {reverse}")]);
    let torn = turned.replace("f 3 4 5\n", "");
    let warned = warnings("a.obj", torn.as_bytes(), glass);
    assert_eq!(warned, ["pyramid: a dielectric on an open mesh: light may enter it and never leave"]);
    let empty_face = format!("{closed}f 1 2 2\n");
    let warned = warnings("a.obj", empty_face.as_bytes(), glass);
    assert_eq!(warned, ["pyramid: 1 triangle without area was dropped"]);
}

/// A corner lies on the edge of another triangle, and a triangle without area lies between them.
#[test]
fn triangles_without_area_close_what_is_beside_them() {
    let points =
        || [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]].map(DVec3::from).to_vec();
    let open = vec![[0, 2, 1], [0, 4, 3], [4, 1, 3], [0, 3, 2], [1, 2, 3]];
    let closed = [open.clone(), vec![[0, 1, 4]]].concat();
    for (faces, expected) in [(open, (3, 0)), (closed, (0, 1))] {
        let mesh = Mesh::new(Vertices::Double(points()), faces).expect("faces with area");
        assert_eq!((mesh.open_edges(), mesh.degenerate()), expected);
        assert_eq!(Shape::Mesh(mesh.into()).is_closed(), expected.0 == 0);
    }
    // A triangle without area that lies alone opens nothing.
    let alone = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [0, 1, 4]].to_vec();
    let mesh = Mesh::new(Vertices::Double(points()), alone).expect("faces with area");
    assert_eq!((mesh.open_edges(), mesh.degenerate()), (0, 1));
}

fn report(faces: &[[u32; 3]]) -> (usize, usize) {
    let points = POINTS.map(DVec3::from).to_vec();
    let mesh = Mesh::new(Vertices::Double(points), faces.to_vec()).expect("faces with area");
    let report = (mesh.open_edges(), mesh.degenerate());
    assert_eq!(Shape::Mesh(mesh.into()).is_closed(), report.0 == 0);
    report
}

#[test]
fn open_edges_are_counted() {
    assert_eq!(report(&FACES), (0, 0));
    assert_eq!(report(&FACES[2..]), (4, 0));
    assert_eq!(report(&FACES[1..]), (3, 0));
    let mut turned = FACES;
    turned[3].swap(0, 1);
    assert_eq!(report(&turned), (3, 0));
    let mut with_needle = FACES.to_vec();
    with_needle.push([1, 1, 2]);
    assert_eq!(report(&with_needle), (0, 1));
    // Corners at the same place are one corner, however often they are written.
    let split: Vec<DVec3> = FACES.iter().flatten().map(|&corner| DVec3::from(POINTS[corner as usize])).collect();
    let faces = (0..6).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh::new(Vertices::Double(split), faces).expect("faces with area");
    assert_eq!(mesh.open_edges(), 0);
}

#[test]
fn a_mesh_keeps_its_front_and_its_points_under_every_transform() {
    let scale = |x, y, z| Transform::scale(DVec3::new(x, y, z));
    let turn = Transform::rotate(DVec3::new(1.0, 2.0, -1.0), 50.0);
    let maps = [
        Transform::IDENTITY,
        scale(-1.0, 1.0, 1.0),
        scale(1.0, -3.0, 0.5),
        scale(-1.0, -1.0, -1.0),
        scale(2.0, 0.2, -1.0)
            .then(&turn)
            .then(&scale(1.0, -1.0, 2.0))
            .then(&Transform::translate(DVec3::new(5.0, -3.0, 2.0))),
    ];
    let points = POINTS.map(DVec3::from);
    let mut random = Random::new(9);
    for map in maps {
        let mesh = Mesh::new(Vertices::Double(points.to_vec()), FACES.to_vec()).expect("faces with area");
        let mesh = Shape::Mesh(mesh.into()).transformed(&map);
        assert!(mesh.is_closed());
        for _ in 0..2000 {
            // From inside, every ray leaves exactly once, through the back of a face, where the map puts that face.
            let ray = Ray::new(map.point(INSIDE), random.direction());
            let intersection = mesh.intersect(&ray, f64::INFINITY).expect("a closed body");
            let there = mesh.point(&ray, &intersection);
            assert!(there.normal.dot(ray.direction) > 0.0, "{map:?}");
            assert!((there.position - ray.at(intersection.t)).length() < 1e-13);
            let corners = FACES[intersection.part as usize].map(|corner| map.point(points[corner as usize]));
            assert!((there.position - corners[0]).dot(there.normal).abs() < 1e-13);
            let through = there.leave(ray.direction);
            assert!(mesh.intersect(&through, f64::INFINITY).is_none());
        }
    }
}

#[test]
fn a_missing_file_and_another_ending_are_refused() {
    assert!(read_mesh(Path::new("no/such/file.ply"), false).is_err());
    let (_folder, path) = file("a.stl", b"solid");
    assert_eq!(read_mesh(&path, false).err().as_deref(), Some("a mesh file ends in .ply, .obj, .gltf or .glb"));
}
