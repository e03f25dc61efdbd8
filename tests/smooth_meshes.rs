//! Meshes that look smoother than they are neither lose nor gain light: row X8 of the stability catalog.
//!
//! ```text
//! cargo test --test all smooth_meshes::
//! ```

use std::f64::consts::{PI, TAU};

use abbe::math::{DVec3, Ray, Transform};
use abbe::shape::{Attributes, Mesh, Shape, Vertices, read_mesh, vertex_normals};

use crate::meshes::files::file;
use crate::support::bodies::ball_faces;
use crate::support::random::Random;
use crate::support::run::Folder;
use crate::support::scenes::{EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, environment, render_film, scene, view};

/// Returns a ball of radius 1, divided by `around` meridians and `rings` - 1 circles of latitude.
fn ball(around: u32, rings: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points = vec![DVec3::Y, -DVec3::Y];
    for ring in 1..rings {
        for step in 0..around {
            let (sin, cos) = libm::sincos(PI * f64::from(ring) / f64::from(rings));
            let (y, x) = libm::sincos(TAU * f64::from(step) / f64::from(around));
            points.push(DVec3::new(sin * y, cos, sin * x));
        }
    }
    (points, ball_faces(around, rings - 1))
}

/// Returns an object of the ball of 16 x 8 with the normals of the ball.
fn object(material: &str) -> String {
    let (points, faces) = ball(16, 8);
    let list = |points: &[DVec3]| points.iter().map(|p| format!("{:?}, ", p.to_array())).collect::<String>();
    let faces: String = faces.iter().map(|face| format!("{face:?}, ")).collect();
    let places = list(&points);
    format!(
        "[[object]]\nshape.mesh = {{ points = [{places}], faces = [{faces}], normals = [{places}] }}\nmaterial = \"m\"\n\
         [material.m]\n{material}\n"
    )
}

/// Returns the ball alone under a uniform sky of radiance 1. It fills the view, with its middle and its rim.
fn furnace(material: &str, samples: u32) -> String {
    view([1.0, 2.0, 5.0], [0.0; 3], 22.0, 48)
        + &format!("[render]\nsamples = {samples}\n")
        + &object(material)
        + &environment(1.0)
}

#[test]
fn x8_a_smooth_white_ball_is_as_bright_as_the_sky_around_it() {
    for (material, tolerance) in [
        ("diffuse.reflectance = 1", 1e-3),
        ("mirror.reflectance = 1", 1e-3),
        // The tolerance covers what a rough metal of this index itself reflects.
        ("conductor = { n = 0.0001, k = 100, roughness = 0.5 }", 1e-2),
    ] {
        for transport in [SPLITTING, SINGLE_PATH] {
            let (film, report) = render_film(&furnace(material, 64), transport);
            assert_eq!((report.non_finite, report.unmatched), (0, 0));
            let mean = Mean::of(&film);
            println!("X8: {material}: {:?} +- {:?}", mean.value, mean.error);
            let off = (mean.value[1] - 1.0).abs();
            assert!(off <= tolerance + 3.0 * mean.error[1], "{material}: {mean:?}");
            assert!(mean.error[1] < 2e-3, "{material}: {mean:?}");
        }
    }
}

#[test]
fn x8_no_mirror_image_of_a_smooth_ball_shows_its_inside() {
    // A ray that is sent below a triangle would hit the ball again, from inside, and lose half of its light each time.
    let (film, _) = render_film(&furnace("mirror.reflectance = 0.5", 16), EVERY_BRANCH);
    let darkest = film.pixels.iter().map(|pixel| pixel.rgb[1]).fold(1.0, f32::min);
    assert!((darkest - 0.5).abs() < 1e-6, "{darkest}");
}

#[test]
fn x8_smooth_glass_loses_no_light() {
    let (film, report) = render_film(&furnace("dielectric.index = 1.5", 64), SPLITTING);
    assert_eq!((report.non_finite, report.unmatched), (0, 0));
    let mean = Mean::of(&film);
    println!("X8: glass {:?} +- {:?}", mean.value, mean.error);
    println!("X8: glass leaves {:?}", report);
    // Some of the light that bent normals let in hits the inside at angles of total reflection repeatedly. What is left
    // of it when roulette ends its path returns so rarely and so bright that a mean is a little low.
    assert!(mean.worst_relative_error([1.0; 3]) <= 1e-3, "{mean:?}");
    assert!((mean.value[1] - 1.0).abs() <= 1e-2, "{mean:?}");
}

#[test]
fn x8_smooth_surfaces_take_the_same_light_from_lamps_aimed_at_and_met_by_chance() {
    // The sky and the lamp are found both by next-event estimation and by random hits. The weights add up to 1 if the
    // densities are right.
    let lamp = "[[object]]\nshape.sphere = { center = [2, 3, 1], radius = 1.5 }\nmaterial = \"lamp\"\n\
                [material.lamp]\nemissive.radiance = RADIANCE\n";
    for material in ["diffuse.reflectance = 0.8", "conductor = { n = 0.2, k = 3.9, roughness = 0.6 }"] {
        // A uniform sky that is partly hidden by a lamp of its own radiance is as bright as without the lamp.
        let text = furnace(material, 64) + &lamp.replace("RADIANCE", "1");
        let with = Mean::of(&render_film(&text, SPLITTING).0);
        let without = Mean::of(&render_film(&furnace(material, 64), SPLITTING).0);
        let error = with.with_joint_error(&without).error[1];
        let off = with.value[1] - without.value[1];
        assert!(off.abs() <= 3.5 * error + 1e-6, "{material}: {off} +- {error}");
    }
}

/// Returns the ball with its exact normals, or with normals computed from its faces.
fn smooth(around: u32, rings: u32, exact: bool) -> Shape {
    let (points, faces) = ball(around, rings);
    let vertices = Vertices::Double(points.clone());
    let normals = match exact {
        true => points.iter().map(|p| p.to_array().map(|x| x as f32)).collect(),
        false => vertex_normals(&vertices, &faces),
    };
    let coordinates = points.iter().map(|p| [p.x as f32, p.y as f32]).collect();
    let mesh = Mesh::new(vertices, faces).expect("faces with area");
    Shape::Mesh(mesh.with(Attributes { normals, coordinates, bare: 0 }).into())
}

#[test]
fn shading_normals_turn_with_the_mesh_whether_it_is_baked_or_an_instance() {
    let map = Transform::scale(DVec3::new(1.0, -0.5, 0.7))
        .then(&Transform::rotate(DVec3::new(1.0, 2.0, -1.0), 50.0))
        .then(&Transform::translate(DVec3::new(4.0, 0.0, 1.0)));
    let back = map.inverse().expect("a map that can be turned back");
    let body = smooth(64, 32, true);
    let (baked, instance) = (body.transformed(&map), body.copied(&map));
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let from = map.point(random.direction() * 3.0);
        let ray = Ray::new(from, map.point(random.direction() * 0.5) - from);
        let [a, b] = [&baked, &instance].map(|shape| {
            let intersection = shape.intersect(&ray, f64::INFINITY).expect("it is aimed at");
            shape.point(&ray, &intersection)
        });
        assert!((a.shading - b.shading).length() < 1e-6, "{} and {}", a.shading, b.shading);
        assert!((a.shading.length() - 1.0).abs() < 1e-12);
        // On an ellipsoid, the normal is that of the unit ball under the inverse transpose of the map. Half a step of
        // the ball's triangles, 0.05, bounds the error of interpolation.
        let expected = map.normal(back.point(a.position).normalize());
        assert!(a.shading.dot(expected) > 0.999 && a.shading.dot(a.normal) > 0.9);
    }
}

/// Programs write such meshes when they mirror them without turning their faces.
#[test]
fn faces_that_run_the_other_way_around_than_their_normals_are_smooth_all_the_same() {
    let (points, faces) = ball(16, 8);
    let back: Vec<[u32; 3]> = faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let normals: Vec<[f32; 3]> = points.iter().map(|p| p.to_array().map(|x| x as f32)).collect();
    let built = |faces: Vec<[u32; 3]>, normals: Vec<[f32; 3]>| {
        let mesh = Mesh::new(Vertices::Double(points.clone()), faces).expect("faces with area");
        Shape::Mesh(mesh.with(Attributes { normals, ..Attributes::default() }).into())
    };
    let at = |shape: &Shape, ray: &Ray| {
        let intersection = shape.intersect(ray, f64::INFINITY).expect("it is aimed at");
        shape.point(ray, &intersection)
    };
    let (right, turned) = (built(faces.clone(), normals.clone()), built(back, normals.clone()));
    // If the normal of only one corner points away, and far, the normal of the face is as good as any.
    let torn = built(faces, [&[[0.0, -9.0, 0.0]], &normals[1..]].concat());
    let mut random = Random::new(5);
    let mut flat = 0;
    for _ in 0..500 {
        let ray = Ray::new(random.direction() * 3.0, -random.direction());
        let ray = Ray::new(ray.origin, random.direction() * 0.5 - ray.origin);
        let [a, b, c] = [&right, &turned, &torn].map(|shape| at(shape, &ray));
        assert!((a.shading + b.shading).length() < 1e-12 && (a.normal + b.normal).length() < 1e-12);
        assert!(c.shading.dot(c.normal) > 0.0);
        flat += usize::from(c.shading == c.normal);
    }
    assert!(flat > 0, "no ray met the tip");
}

#[test]
fn normals_computed_from_faces_are_those_of_a_ball() {
    // Weighted by angles, they do not depend on how squares are divided into triangles.
    let (points, faces) = ball(32, 16);
    let normals = vertex_normals(&Vertices::Double(points.clone()), &faces);
    for (point, normal) in points.iter().zip(normals) {
        assert!(DVec3::from(normal.map(f64::from)).dot(*point) > 0.9995, "{normal:?} at {point}");
    }
    let cube = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let side = |bit: u32| if i & bit > 0 { 1.0 } else { -1.0 };
        DVec3::new(side(1), side(2), side(4))
    });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    for (point, normal) in cube.iter().zip(vertex_normals(&Vertices::Double(cube.to_vec()), &faces)) {
        assert!((DVec3::from(normal.map(f64::from)) - point.normalize()).length() < 1e-6, "{normal:?}");
    }
}

#[test]
fn normals_that_a_scene_writes_out_are_seen_unless_it_says_that_the_mesh_is_not_smooth() {
    let text = view([0.0, 0.0, 5.0], [0.0; 3], 22.0, 4) + &object("diffuse.reflectance = 0.5");
    for (smooth, expected) in [("", true), ("smooth = true, ", true), ("smooth = false, ", false)] {
        let text = text.replace("mesh = { ", &format!("mesh = {{ {smooth}"));
        let Shape::Mesh(mesh) = &*scene(&text).objects[0].shape else { panic!("{smooth}") };
        assert_eq!(mesh.is_smooth(), expected, "{smooth}");
    }
}

#[test]
fn texture_coordinates_are_interpolated() {
    let Shape::Mesh(mesh) = smooth(16, 8, true) else { unreachable!("it is a mesh") };
    let shape = Shape::Mesh(mesh.clone());
    let mut random = Random::new(4);
    for _ in 0..500 {
        let ray = Ray::new(DVec3::ZERO, random.direction());
        let intersection = shape.intersect(&ray, f64::INFINITY).expect("from inside");
        let place = shape.point(&ray, &intersection).position;
        let [u, v] = mesh.coordinates(intersection.part, intersection.uv).expect("it has coordinates");
        assert!((u - place.x).abs() < 1e-6 && (v - place.y).abs() < 1e-6);
    }
    let (points, faces) = ball(8, 4);
    let bare = Mesh::new(Vertices::Double(points), faces).expect("faces with area");
    assert_eq!(bare.coordinates(0, [0.2, 0.3]), None);
}

/// Returns a triangle in every format. Its second vertex has the given normal and texture coordinates.
fn files_with(normal: [f32; 3], coordinates: [f32; 2]) -> [(&'static str, Vec<u8>); 3] {
    let ([x, y, z], [u, v]) = (normal, coordinates);
    let names: String =
        ["x", "y", "z", "nx", "ny", "nz", "u", "v"].map(|name| format!("property float {name}\n")).concat();
    let header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\n{names}element face 1\n\
         property list uchar uchar vertex_indices\nend_header\n"
    );
    let rows = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, x, y, z, u, v],
        [0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
    ];
    let bytes: Vec<u8> = rows.iter().flatten().flat_map(|x: &f32| x.to_le_bytes()).collect();
    let ply = [header.as_bytes(), &bytes, &[3, 0, 1, 2]].concat();
    let obj = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nvn {x} {y} {z}\nvt {u} {v}\nf 1/1/1 2/2/2 3/1/1\n");
    let [places, normals, pairs] =
        [0..3, 3..6, 6..8].map(|range| rows.iter().flat_map(move |row| row[range.clone()].to_vec()));
    let numbers = places.chain(normals).chain(pairs).flat_map(f32::to_le_bytes);
    let json = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":0,"byteOffset":72,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":96}],"buffers":[{"byteLength":96}]}"#;
    let json = format!("{json}{}", " ".repeat(json.len().next_multiple_of(4) - json.len()));
    let number = |n: usize| (n as u32).to_le_bytes();
    let head = [b"glTF".as_slice(), &number(2), &number(28 + json.len() + 96), &number(json.len()), b"JSON"].concat();
    let glb = [&head, json.as_bytes(), &number(96), b"BIN\0"].concat().into_iter().chain(numbers).collect();
    [("a.ply", ply), ("a.obj", obj.into_bytes()), ("a.glb", glb)]
}

#[test]
fn normals_and_texture_coordinates_that_are_not_finite_are_refused() {
    let refusals = |normal, coordinates, smooth: bool| {
        files_with(normal, coordinates).map(|(name, bytes)| {
            let (_folder, path) = file(name, bytes);
            let mesh = read_mesh(&path, smooth);
            mesh.err().unwrap_or_default()
        })
    };
    let up = [0.0, 0.0, 1.0];
    let vertex_message = "the normal of vertex 1 (counted from 0) is not finite";
    let line_message = "the normal in line 6 is not finite";
    assert_eq!(refusals([0.0, f32::NAN, 0.0], [0.0; 2], true), [vertex_message, line_message, vertex_message]);
    assert_eq!(refusals([f32::INFINITY, 0.0, 0.0], [0.0; 2], true), [vertex_message, line_message, vertex_message]);
    assert_eq!(refusals([0.0, f32::NAN, 0.0], [0.0; 2], false), ["", "", ""], "flat meshes have no normals");
    for smooth in [false, true] {
        let vertex_message = "the texture coordinates of vertex 1 (counted from 0) are not finite";
        let line_message = "the texture coordinate in line 7 is not finite";
        assert_eq!(refusals(up, [f32::NAN, 0.5], smooth), [vertex_message, line_message, vertex_message]);
        assert_eq!(refusals(up, [0.5, f32::NEG_INFINITY], smooth), [vertex_message, line_message, vertex_message]);
        assert_eq!(refusals(up, [0.5, 0.5], smooth), ["", "", ""]);
    }
}

/// Returns the attributes of a file's vertices, read without and with normals.
fn attributes(name: &str, text: &str) -> [Attributes; 2] {
    let (_folder, path) = file(name, text);
    [false, true]
        .map(|smooth| read_mesh(&path, smooth))
        .map(|mesh| mesh.unwrap_or_else(|message| panic!("{message}")).attributes)
}

#[test]
fn faces_of_a_ply_may_have_texture_coordinates_of_their_own() {
    let ply = |faces: &str, of_vertices: bool| {
        let (names, pair) = if of_vertices { ("property float s\nproperty float t\n", " 7 8") } else { ("", "") };
        let rows: String = ["0 0 0", "1 0 0", "1 1 0", "0 1 0"].map(|row| format!("{row} 0 0 1{pair}\n")).concat();
        let header: String = ["x", "y", "z", "nx", "ny", "nz"].map(|name| format!("property float {name}\n")).concat();
        format!(
            "ply\nformat ascii 1.0\nelement vertex 4\n{header}{names}element face {}\n\
             property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n\
             end_header\n{rows}{faces}",
            faces.lines().count()
        )
    };
    let read = |faces: &str, of_vertices: bool| {
        let (_folder, path) = file("a.ply", ply(faces, of_vertices));
        let mesh = read_mesh(&path, true)?;
        let place = |corner: &u32| mesh.vertices.at(*corner).to_array().map(|x| x as u32);
        let places: Vec<_> = mesh.faces.iter().flatten().map(place).collect();
        let pairs: Vec<_> = mesh.faces.iter().flatten().map(|c| mesh.attributes.coordinates[*c as usize]).collect();
        assert_eq!(mesh.attributes.normals, vec![[0.0, 0.0, 1.0]; mesh.vertices.count()]);
        Ok::<_, String>((mesh.vertices.count(), places, pairs, mesh.attributes.bare))
    };
    // Two triangles with a seam between them. One end of the seam is the same point of the image for both.
    let seam = "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 6 0 0 0.5 1 0.25 1 0\n";
    let places = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]];
    let pairs = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [0.5, 1.0], [0.25, 1.0]];
    for of_vertices in [false, true] {
        assert_eq!(read(seam, of_vertices), Ok((5, places.to_vec(), pairs.to_vec(), 0)));
    }
    let quad = read("4 0 1 2 3 8 0 0 1 0 1 1 0 1 0\n", false).expect("one face");
    let fan = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    assert_eq!((quad.0, &quad.2[..], quad.3), (4, &fan[..], 0));
    // A face without coordinates of its own shows those of its vertices.
    let mixed = "3 0 1 2 6 0 0 1 0 1 1 0\n3 0 2 3 0 0\n";
    let [bare, own] = [false, true].map(|of_vertices| read(mixed, of_vertices).expect("two faces"));
    assert_eq!((bare.0, bare.3, own.0, own.3), (6, 1, 6, 0));
    assert!(bare.2[3..] == [[0.0, 0.0]; 3] && own.2[3..] == [[7.0, 8.0]; 3] && own.2[..3] == pairs[..3]);
    // No face has coordinates.
    let none = "3 0 1 2 0 0\n3 0 2 3 0 0\n";
    assert_eq!(read(none, true).expect("two faces").2, [[7.0, 8.0]; 6]);
    let (_folder, path) = file("a.ply", ply(none, false));
    let mesh = read_mesh(&path, true).expect("two faces");
    assert!(mesh.attributes.coordinates.is_empty() && mesh.attributes.bare == 0 && mesh.vertices.count() == 4);
    for (faces, message) in [
        ("3 0 1 2 6 0 0 1 0 1 1e39 0\n", "texture coordinates at vertex 2 (counted from 0) are not finite"),
        ("3 0 1 4 6 0 0 1 0 1 1 0\n", "a face refers to vertex 4, but the 4 vertices are numbered from 0"),
        ("3 0 1 -1 6 0 0 1 0 1 1 0\n", "a face refers to a negative vertex, but the 4 vertices are numbered from 0"),
    ] {
        assert_eq!(read(faces, false), Err(message.into()));
    }
}

#[test]
fn files_give_normals_where_they_are_wanted_and_texture_coordinates_where_they_are() {
    let expected = Attributes {
        normals: vec![[0.0, 0.0, 1.0], [0.0, 0.6, 0.8], [0.0, 1.0, 0.0]],
        coordinates: vec![[0.0, 0.25], [0.5, 0.75], [1.0, 0.0]],
        bare: 0,
    };
    let flat = Attributes { normals: Vec::new(), ..expected.clone() };
    let rows = ["0 0 0 0 0 1 0 0.25", "1 0 0 0 0.6 0.8 0.5 0.75", "0 1 0 0 1 0 1 0"];
    // A name without its partner means something else.
    for (more, [u, v]) in
        [(None, ["u", "v"]), (None, ["s", "t"]), (None, ["texture_u", "texture_v"]), (Some("s"), ["u", "v"])]
    {
        let known = ["x", "y", "z", "nx", "ny", "nz", u, v];
        let names: String = known.into_iter().chain(more).map(|name| format!("property float {name}\n")).collect();
        let rows = rows.map(|row| row.to_owned() + if more.is_some() { " 9" } else { "" });
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\n{names}element face 1\nproperty list uchar int vertex_indices\n\
             end_header\n{}\n3 0 1 2\n",
            rows.join("\n")
        );
        assert_eq!(attributes("a.ply", &text), [flat.clone(), expected.clone()]);
    }
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 0.5 0.75\nvt 1 0\nvn 0 0 1\nvn 0 0.6 0.8\nvn 0 1 0\nf 1/1/1 2/2/2 3/3/3\n";
    assert_eq!(attributes("a.obj", obj)[1], expected);
    assert_eq!(attributes("a.obj", obj)[0].coordinates, expected.coordinates);
    assert_eq!(
        attributes("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        [Attributes::default(), Attributes::default()]
    );
    // Faces without normals or coordinates leave those of the others as they are.
    let mixed = obj.to_owned() + "o bare\nf 3 2 1\nf 1 2 3/1\n";
    let [flat_one, smooth_one] = attributes("a.obj", &mixed);
    assert_eq!(
        (&smooth_one.normals[..3], &smooth_one.coordinates[..3]),
        (&expected.normals[..], &expected.coordinates[..])
    );
    assert_eq!((&smooth_one.normals[3..], smooth_one.bare), (&[[0.0; 3]; 4][..], 2));
    assert_eq!(flat_one.coordinates[3..], [[0.0; 2], [0.0; 2], [0.0; 2], [0.0, 0.25]]);
    // Floats in sequence: positions, normals and coordinates, whose v runs down in glTF.
    let numbers: Vec<f32> = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .into_iter()
        .chain(expected.normals.iter().flatten().copied())
        .chain(expected.coordinates.iter().flat_map(|[u, v]| [*u, 1.0 - v]))
        .collect();
    let folder = Folder::with("a.bin", numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>());
    let text = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2}}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":0,"byteOffset":36,"componentType":5126,"count":3,"type":"VEC3"},
{"bufferView":0,"byteOffset":72,"componentType":5126,"count":3,"type":"VEC2"}],
"bufferViews":[{"buffer":0,"byteLength":96}],"buffers":[{"uri":"a.bin","byteLength":96}]}"#;
    folder.write("a.gltf", text);
    let path = folder.path_of("a.gltf");
    let found = read_mesh(&path, true).expect("a glTF file").attributes;
    assert_eq!(found.coordinates, expected.coordinates);
    for (found, expected) in found.normals.iter().flatten().zip(expected.normals.iter().flatten()) {
        assert!((found - expected).abs() < 1e-7);
    }
    assert!(read_mesh(&path, false).expect("a glTF file").attributes.normals.is_empty());
}
