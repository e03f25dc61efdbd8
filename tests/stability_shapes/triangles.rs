//! Rows T1 to T5 of the stability catalog: edges, slivers, sizes and triangles without area.

use abbe::math::{DVec3, Frame, Ray, UNIT_ROUNDOFF};
use abbe::shape::{Intersection, Mesh, Shape, Triangle, Vertices, read_mesh};

use super::OFFSET;
use crate::meshes::files::file;
use crate::support::bodies::{ball, closed_mesh};
use crate::support::exact::{Exact, ExactVector};
use crate::support::larger::larger;
use crate::support::random::Random;

const RAYS: usize = 20_000;

/// Returns rays from inside a ball of triangles at coordinate `offset`, aimed at points of its faces: anywhere, on an
/// edge or at a corner.
fn rays_at(points: &[DVec3], faces: &[[u32; 3]], offset: f64) -> [Vec<Ray>; 3] {
    let mut random = Random::new(21);
    std::array::from_fn(|aim| {
        let rays = (0..RAYS).map(|_| {
            let face = faces[(random.number() * faces.len() as f64) as usize];
            let [a, b, c] = face.map(|corner| points[corner as usize]);
            let [along, across] = random.pair();
            let target = match aim {
                0 => a + (b - a) * along + (c - a) * across * (1.0 - along),
                1 => a * (1.0 - along) + b * along,
                _ => a,
            };
            let origin = OFFSET * offset + random.direction() * 0.5 * random.number();
            Ray::new(origin, target - origin)
        });
        rays.collect()
    })
}

#[test]
fn t1_no_ray_leaves_a_closed_mesh_through_an_edge_or_a_corner() {
    for offset in [0.0, 1.0, 100.0, 1e5] {
        let (mut points, faces) = ball();
        points.iter_mut().for_each(|p| *p += OFFSET * offset);
        let aims = rays_at(&points, &faces, offset);
        let shape = closed_mesh(points, faces);
        for (aim, rays) in ["anywhere", "edges", "corners"].iter().zip(aims) {
            let lost = rays.iter().filter(|ray| shape.intersect(ray, f64::INFINITY).is_none()).count();
            assert_eq!(lost, 0, "aimed at {aim}, offset {offset:e}");
        }
    }
}

#[test]
fn t2_edges_are_seldom_hit_twice_and_the_first_of_the_nearest_triangles_is_taken() {
    let (points, faces) = ball();
    let triangles: Vec<Shape> =
        faces.iter().map(|face| Shape::Triangle(Triangle::new(face.map(|corner| points[corner as usize])))).collect();
    let aims = rays_at(&points, &faces, 0.0);
    let shape = closed_mesh(points, faces);
    for (aim, rays) in ["anywhere", "edges", "corners"].iter().zip(aims) {
        let mut doubles = 0;
        for ray in &rays {
            let all = (0..).zip(&triangles);
            let hits: Vec<Intersection> = all
                .filter_map(|(part, triangle)| Some(Intersection { part, ..triangle.intersect(ray, f64::INFINITY)? }))
                .collect();
            let nearest = hits.iter().copied().min_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
            assert_eq!(shape.intersect(ray, f64::INFINITY), nearest);
            doubles += usize::from(hits.len() > 1);
        }
        let share = doubles as f64 / RAYS as f64;
        println!("T2: aimed at {aim}: {share:.4} hit more than one triangle");
        assert!(*aim == "corners" || share < 0.005, "aimed at {aim}: {share}");
    }
}

#[test]
fn t2_of_coincident_triangles_the_one_listed_first_is_hit() {
    let (points, faces) = ball();
    let count = faces.len() as u32;
    let rays = rays_at(&points, &faces, 0.0);
    let twice: Vec<[u32; 3]> = faces.iter().chain(&faces).copied().collect();
    let mesh = Mesh::new(Vertices::Double(points), twice).expect("the faces have areas");
    let shape = Shape::Mesh(mesh.into());
    for ray in rays.iter().flatten() {
        let intersection = shape.intersect(ray, f64::INFINITY).expect("the ball is closed");
        assert!(intersection.part < count, "{intersection:?}");
    }
}

/// Returns the affine coordinates (u, v) at which a line crosses a triangle's plane.
fn exact_coordinates([a, b, c]: [DVec3; 3], ray: &Ray) -> [Exact; 2] {
    let (start, along) = (ExactVector::from(ray.origin) - a.into(), ExactVector::from(ray.direction));
    let (e1, e2) = (ExactVector::from(b) - a.into(), ExactVector::from(c) - a.into());
    // Cramer's rule for start + t along = u e1 + v e2.
    let across = along.cross(e2);
    let determinant = e1.dot(across);
    [start.dot(across) / determinant, along.dot(start.cross(e1)) / determinant]
}

#[test]
fn t3_slivers_are_hit_and_know_where() {
    for height in [1.0, 1e-2, 1e-4, 1e-6, 1e-8] {
        let mut random = Random::new(23);
        let (mut worst, mut tested) = (0f64, 0);
        while tested < RAYS {
            let frame = Frame::about(random.direction());
            let place = |x, y| OFFSET * 3.0 + frame.to_world(DVec3::new(x, y, 0.0));
            let points = [place(0.0, 0.0), place(1.0, 0.0), place(random.number(), height)];
            let [a, b] = random.pair();
            let target = points[0] + (points[1] - points[0]) * a + (points[2] - points[0]) * b * (1.0 - a);
            let origin = target + (frame.to_world(DVec3::Z) + random.direction() * 0.5) * 5.0;
            let ray = Ray::new(origin, target - origin);
            let exact = exact_coordinates(points, &ray);
            let inside = [exact[0], exact[1], Exact::from(1.0) - exact[0] - exact[1]];
            if inside.iter().any(|x| x.rounded() < 1e-3) {
                continue;
            }
            tested += 1;
            let shape = Shape::Triangle(Triangle::new(points));
            let intersection = shape.intersect(&ray, f64::INFINITY).expect("the ray runs through its inside");
            for (found, exact) in intersection.uv.into_iter().zip(exact) {
                worst = larger(worst, (Exact::from(found) - exact).abs().rounded());
            }
        }
        let roundings = worst * height / UNIT_ROUNDOFF;
        println!("T3: height {height:e}: coordinates off by {worst:.1e}, {roundings:.1} u / h");
        assert!(roundings <= 64.0, "height {height:e}: {roundings} u / h");
    }
}

#[test]
fn t4_triangles_of_any_size_are_hit_inside_and_missed_outside() {
    for size in [1e-20, 1e-12, 1e-10, 1e-6, 1.0, 1e6, 1e10, 1e12, 1e20] {
        let mut random = Random::new(24);
        for _ in 0..5_000 {
            let points = std::array::from_fn(|_| random.direction() * size);
            let [a, b] = random.pair();
            // Twice the triangle's parallelogram in each direction, so that about an eighth of the rays hit.
            let (a, b) = (2.0 * a - 0.5, 2.0 * b - 0.5);
            let target = points[0] + (points[1] - points[0]) * a + (points[2] - points[0]) * b;
            let origin = random.direction() * 5.0 * size;
            let ray = Ray::new(origin, target - origin);
            let margin = a.min(b).min(1.0 - a - b);
            if margin.abs() < 1e-3 {
                continue;
            }
            let intersection = Shape::Triangle(Triangle::new(points)).intersect(&ray, f64::INFINITY);
            assert_eq!(intersection.is_some(), margin > 0.0, "size {size:e}: {points:?}, {ray:?}");
        }
    }
}

/// One good triangle, and three without area: on a line, with two equal corners, and a point.
const POINTS: [[f32; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.3], [2.0, 0.2, 0.6], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]];
const FACES: [[u32; 3]; 4] = [[0, 1, 3], [0, 1, 2], [0, 3, 4], [0, 0, 4]];

#[test]
fn t5_triangles_without_area_are_dropped_and_reported() {
    let points: String = POINTS.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    let faces: String = FACES.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1)).collect();
    let (_folder, path) = file("flat.obj", points + &faces);
    let file = read_mesh(&path, false).expect("the file is sound");
    let mesh = Mesh::new(file.vertices, file.faces).expect("one triangle has an area");
    assert_eq!((mesh.count(), mesh.degenerate()), (1, 3));
    let only_flat = Mesh::new(Vertices::Single(POINTS.to_vec()), FACES[1..].to_vec());
    assert!(only_flat.is_none());
}

#[test]
fn t5_triangles_without_area_give_no_nan() {
    let mut random = Random::new(25);
    let faces = FACES.map(|face| face.map(|corner| DVec3::from(POINTS[corner as usize].map(f64::from))));
    for points in &faces[1..] {
        assert!(Triangle::is_degenerate(*points), "{points:?}");
        for _ in 0..10_000 {
            let target = points[0] + (points[1] - points[0]) * random.number();
            let origin = random.direction() * 3.0;
            let ray = Ray::new(origin, target - origin);
            if let Some(hit) = Shape::Triangle(Triangle::new(*points)).intersect(&ray, f64::INFINITY) {
                assert!(hit.t.is_finite() && hit.uv.iter().all(|x| x.is_finite()), "{points:?}, {ray:?}: {hit:?}");
            }
        }
    }
}
