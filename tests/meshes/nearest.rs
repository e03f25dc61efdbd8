//! A tree of boxes only saves work: it finds what a search through everything finds, to the last bit.

use abbe::math::{DVec3, Ray};
use abbe::scene::{Hit, Scene};
use abbe::shape::{Intersection, Mesh, Shape, Triangle, Vertices};
use abbe::spectrum::Curve;

use crate::support::random::Random;
use crate::support::scenes::{body, quad, scene, view};

const RAYS: u32 = 100_000;

/// Returns the nearest crossing of all. If several are equally near, it is the first.
fn search(shapes: impl Iterator<Item = (u32, Option<Intersection>)>) -> Option<(u32, Intersection)> {
    shapes
        .filter_map(|(number, intersection)| Some((number, intersection?)))
        .reduce(|nearest, next| if next.1.t < nearest.1.t { next } else { nearest })
}

fn assert_found(scene: &Scene<Curve>, ray: &Ray) -> bool {
    let shapes = scene.objects.iter().enumerate();
    let all = shapes.map(|(number, object)| (number as u32, object.shape.intersect(ray, f64::INFINITY)));
    let nearest = search(all).map(|(object, intersection)| Hit { object, intersection });
    assert_eq!(scene.intersect(ray), nearest, "{ray:?}");
    nearest.is_some()
}

/// Returns a ray between two random points of a cube about the origin.
fn ray(random: &mut Random, half: f64) -> Ray {
    let mut place = || DVec3::from([(); 3].map(|()| random.between(-half, half)));
    let (from, to) = (place(), place());
    Ray::new(from, to - from)
}

fn numbers(random: &mut Random, low: f64, high: f64) -> [f64; 3] {
    [(); 3].map(|()| random.between(low, high))
}

#[test]
fn the_tree_of_a_scene_finds_what_a_search_finds() {
    let mut random = Random::new(21);
    let objects: String = (0..240)
        .map(|i| {
            let (center, size) = (numbers(&mut random, -4.0, 4.0), random.between(0.05, 0.5));
            let mut vector = || numbers(&mut random, -0.7, 0.7);
            let shape = match i % 5 {
                0 => format!("sphere = {{ center = {center:?}, radius = {size} }}"),
                1 => format!("cube = {{ center = {center:?}, size = {size} }}"),
                2 => format!("disc = {{ center = {center:?}, normal = {:?}, radius = {size} }}", vector()),
                3 => quad(center, vector(), vector()),
                _ => format!("triangle = {{ points = [{center:?}, {:?}, {:?}] }}", vector(), vector()),
            };
            let steps = if i % 3 == 0 {
                "{ scale = [1, 0.6, 1.2] }, { rotate = { axis = [1, 1, 0], degrees = 25 } }"
            } else {
                ""
            };
            format!("[[object]]\nshape.{shape}\nmaterial = \"m\"\ntransform = [{steps}]\n")
        })
        .collect();
    let floor = "[[object]]\nshape.plane = { point = [0, -3, 0], normal = [0, 1, 0] }\nmaterial = \"m\"\n";
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 40.0, 4) + "[material.m]\nmirror = {}\n" + &objects + floor;
    let scene = scene(&text);
    let hits = (0..RAYS).filter(|_| assert_found(&scene, &ray(&mut random, 6.0))).count();
    assert!(hits as u32 > RAYS / 2, "only {hits} rays meet anything");
}

#[test]
fn of_coincident_objects_the_first_is_hit() {
    // Walls of overlapping parallelograms and discs, with several in each place. Their bounding boxes are flat.
    let mut random = Random::new(22);
    let mut shapes = Vec::new();
    for i in 0..36 {
        let z = 0.3 * f64::from(i % 3) - 0.37;
        let center = [0.7 * f64::from(i % 6) - 2.0, 0.7 * f64::from(i / 6) - 2.0, z];
        for (u, v) in
            [([0.5, 0.0, 0.0], [0.0, 0.5, 0.0]), ([0.0, 0.6, 0.0], [0.4, 0.0, 0.0]), ([0.3, 0.0, 0.0], [0.0, 0.3, 0.0])]
        {
            shapes.push(quad(center, u, v));
        }
        shapes.push(format!("disc = {{ center = {center:?}, normal = [0, 0, 1], radius = 0.45 }}"));
    }
    // The order does not depend on the places.
    for i in (1..shapes.len()).rev() {
        shapes.swap(i, (random.number() * (i + 1) as f64) as usize);
    }
    let shapes: Vec<&str> = shapes.iter().map(String::as_str).collect();
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 40.0, 4) + &body("m", "mirror = {}", &shapes);
    let scene = scene(&text);
    for _ in 0..RAYS {
        let (from, to) = (DVec3::from(numbers(&mut random, -3.0, 3.0)), DVec3::from(numbers(&mut random, -2.0, 2.0)));
        assert_found(&scene, &Ray::new(from + DVec3::Z * 5.0, to - from - DVec3::Z * 5.0));
    }
}

/// Returns triangles around random places. Some of them appear twice, and some lie in a plane of constant y.
fn soup(random: &mut Random) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for i in 0..1500 {
        let first = points.len() as u32;
        let center = DVec3::from(numbers(random, -2.0, 2.0));
        let mut corners = [(); 3].map(|()| center + DVec3::from(numbers(random, -0.3, 0.3)));
        if i % 3 == 0 {
            let level = 0.1 * (center.y * 10.0).round();
            corners.iter_mut().for_each(|corner| corner.y = level);
        }
        points.extend(corners);
        faces.extend(vec![[first, first + 1, first + 2]; 1 + usize::from(i % 4 == 0)]);
    }
    (points, faces)
}

#[test]
fn the_tree_of_a_mesh_finds_what_a_search_finds() {
    let mut random = Random::new(23);
    let (points, mut faces) = soup(&mut random);
    for i in (1..faces.len()).rev() {
        faces.swap(i, (random.number() * (i + 1) as f64) as usize);
    }
    let hits = assert_mesh_finds(&points, &faces, RAYS / 4, 3.0, &mut random);
    assert!(hits > RAYS / 8, "only {hits} rays meet anything");
}

#[test]
fn boxes_that_begin_at_a_hit_hide_no_equally_near_triangle() {
    // Overlapping triangles in planes whose boxes are exact in 32 bits, so that rounding outward gives them no
    // thickness.
    let mut random = Random::new(24);
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for i in 0..400 {
        let center = DVec3::from(numbers(&mut random, -2.0, 2.0));
        let mut corners = [(); 3].map(|()| center + DVec3::from(numbers(&mut random, -1.3, 1.3)));
        let level = 0.5 * center[i % 3].round();
        corners.iter_mut().for_each(|corner| corner[i % 3] = level);
        let first = points.len() as u32;
        points.extend(corners);
        faces.push([first, first + 1, first + 2]);
    }
    let hits = assert_mesh_finds(&points, &faces, RAYS / 2, 5.0, &mut random);
    assert!(hits > RAYS / 8, "only {hits} rays meet anything");
}

/// Asserts that the tree finds what a search finds. Returns how many rays hit anything.
fn assert_mesh_finds(points: &[DVec3], faces: &[[u32; 3]], rays: u32, half: f64, random: &mut Random) -> u32 {
    let triangle = |face: &[u32; 3]| Shape::Triangle(Triangle::new(face.map(|corner| points[corner as usize])));
    let triangles: Vec<Shape> = faces.iter().map(triangle).collect();
    let mesh = Mesh::new(Vertices::Double(points.to_vec()), faces.to_vec()).expect("faces with area");
    let mesh = Shape::Mesh(mesh.into());
    let mut hits = 0;
    for _ in 0..rays {
        let ray = ray(random, half);
        let all = triangles.iter().enumerate();
        let all = all.map(|(number, triangle)| (number as u32, triangle.intersect(&ray, f64::INFINITY)));
        let nearest = search(all).map(|(part, intersection)| Intersection { part, ..intersection });
        assert_eq!(mesh.intersect(&ray, f64::INFINITY), nearest, "{ray:?}");
        hits += u32::from(nearest.is_some());
    }
    hits
}
