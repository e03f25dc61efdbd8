//! Rows B1 to B3 and B6 of the stability catalog: boxes of the tree, and vertices that are no numbers. (Rows B4 and B5
//! are tested where the tree is built.)

use abbe::math::{Bounds, DVec3, Ray};
use abbe::shape::{Bvh, Mesh, Shape, Triangle, Vectors, Vertices, Visitor, read_mesh};

use super::OFFSET;
use crate::meshes::files::file;
use crate::support::random::Random;

/// Whether a walk shows an item.
struct Reached<'a> {
    bvh: &'a Bvh,
    item: u32,
    reached: bool,
}

impl Visitor for Reached<'_> {
    fn visit(&mut self, _: impl Vectors, first: usize, groups: usize, t_max: f64) -> Option<f64> {
        self.reached |= self.bvh.items()[first..first + groups].contains(&self.item);
        Some(t_max)
    }
}

fn reaches(boxes: &[Bounds], ray: &Ray, item: u32) -> bool {
    let bvh = &Bvh::new::<1>(boxes.iter().copied());
    let [mut any, mut nearest] = [(); 2].map(|()| Reached { bvh, item, reached: false });
    bvh.walk(ray, f64::INFINITY, &mut any);
    bvh.walk_in_order(ray, f64::INFINITY, &mut nearest);
    assert_eq!(any.reached, nearest.reached);
    any.reached
}

/// A point whose coordinates f32 holds, so that its box is not rounded outward.
fn single(point: DVec3) -> DVec3 {
    point.as_vec3().as_dvec3()
}

#[test]
fn b1_a_ray_within_a_side_of_a_box_reaches_it() {
    let mut random = Random::new(31);
    for _ in 0..100_000 {
        let corners = [single(random.direction() * 3.0), single(random.direction() * 3.0)];
        let mut bounds = Bounds::around(corners);
        let axis = (random.number() * 3.0) as usize;
        if random.number() < 0.3 {
            // A wall: the box is flat.
            bounds.max[axis] = bounds.min[axis];
        }
        let mut target = bounds.min + (bounds.max - bounds.min) * random.number();
        let mut origin = random.direction() * 10.0;
        target[axis] = if random.number() < 0.5 { bounds.min[axis] } else { bounds.max[axis] };
        origin[axis] = target[axis];
        let mut direction = (target - origin).normalize();
        direction[axis] = if random.number() < 0.5 { 0.0 } else { -0.0 };
        let far_away = Bounds { min: DVec3::splat(100.0), max: DVec3::splat(101.0) };
        assert!(reaches(&[far_away, bounds], &Ray { origin, direction }, 1), "{bounds:?}, {origin}");
    }
}

#[test]
fn b2_a_ray_that_hits_a_triangle_on_the_rim_of_its_box_reaches_the_box() {
    for (size, offset) in [(1.0, 0.0), (1e-3, 100.0), (10.0, 1e3)] {
        let mut random = Random::new(32);
        let (mut hits, mut missed) = (0, 0);
        for _ in 0..200_000 {
            let corner = single(OFFSET * offset + random.direction());
            let mut arm = |axis: DVec3| single(corner + axis * size * random.between(-1.0, 1.0));
            let points = [corner, arm(DVec3::X), arm(DVec3::Y)];
            // The triangle is half a side of the flat box: aim at its corner, or along the edges they share.
            let along = if random.number() < 0.5 { 0.0 } else { random.number() };
            let target = corner + (points[1] - corner) * along;
            let ray = Ray::new(target + random.direction() * 5.0 * size, DVec3::X);
            let ray = Ray::new(ray.origin, target - ray.origin);
            let triangle = Triangle::new(points);
            let bounds = Bounds::around(points);
            if Shape::Triangle(triangle).intersect(&ray, f64::INFINITY).is_some() {
                hits += 1;
                missed += usize::from(!reaches(&[bounds], &ray, 0));
            }
        }
        assert!(hits > 50_000, "only {hits} rays hit");
        assert_eq!(missed, 0, "of {hits}, size {size:e}, offset {offset:e}");
    }
}

fn ply(number: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 {number} 0\n0 1 0\n3 0 1 2\n"
    )
}

fn obj(number: &str) -> String {
    format!("v 0 0 0\nv 1 {number} 0\nv 0 1 0\nf 1 2 3\n")
}

#[test]
fn b3_mesh_files_with_vertices_that_are_not_finite_are_refused() {
    let refusal = |name, text: String| {
        let (_folder, path) = file(name, text);
        read_mesh(&path).err()
    };
    for (name, text) in [("mesh.ply", ply as fn(&str) -> String), ("mesh.obj", obj)] {
        for number in ["nan", "inf", "-inf", "1e39"] {
            let message = refusal(name, text(number)).unwrap_or_else(|| panic!("{name} with {number} is accepted"));
            // By the line where it is told, else by the vertex.
            let place = ["vertex 1 ", "line 11 ", "the vertex in line 2 "];
            assert!(place.iter().any(|place| message.contains(place)), "{name} with {number}: {message}");
        }
        assert_eq!(refusal(name, text("0.5")), None, "{name} is sound");
    }
}

#[test]
fn b3_the_largest_vertices_a_file_can_hold_build_a_mesh_that_is_hit() {
    let most = f32::MAX;
    let points = vec![[-most, -most, -most], [most, -most, -most], [0.0, most, -most], [1.0, 2.0, 3.0]];
    let mesh = Mesh::new(Vertices::Single(points), vec![[0, 1, 2], [0, 1, 3]]).expect("they have areas");
    assert_eq!(mesh.degenerate(), 0);
    let shape = Shape::Mesh(mesh.into());
    let ray = Ray::new(DVec3::new(0.0, 0.0, -10.0 * f64::from(most)), DVec3::Z);
    let crossing = shape.intersect(&ray, f64::INFINITY).expect("the ray runs through the first triangle");
    assert!((crossing.t / (9.0 * f64::from(most)) - 1.0).abs() < 1e-15 && crossing.part == 0, "{crossing:?}");
    assert!(shape.area().is_finite() && shape.pdf(&ray, &crossing).is_finite());
}

/// Long triangles between points of a lattice: they are cut in planes of the lattice, within which many rays run.
#[test]
fn b6_triangles_that_are_cut_are_met_as_if_they_were_whole() {
    let mut random = Random::new(36);
    let mut steps = |most: f64| DVec3::from([(); 3].map(|()| (random.between(-most, most)).round()));
    let mut triangles = Vec::new();
    while triangles.len() < 2000 {
        let corner = steps(16.0);
        let points = [corner, corner + steps(24.0), corner + steps(1.0)].map(|point| point * 0.25);
        if !Triangle::is_degenerate(points) {
            triangles.push(points);
        }
    }
    let faces: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = Mesh::new(Vertices::Double(triangles.concat()), faces).expect("triangles");
    let mesh = Shape::Mesh(mesh.into());
    let alone: Vec<Shape> = triangles.iter().map(|&points| Shape::Triangle(Triangle::new(points))).collect();
    let mut hits = 0;
    for i in 0..20_000 {
        let origin = steps(24.0) * 0.25;
        let direction = match i % 3 {
            0 => DVec3::AXES[i / 3 % 3],
            1 => (steps(24.0) * 0.25 - origin).normalize_or(DVec3::X),
            _ => steps(1e9).normalize(),
        };
        let ray = Ray { origin, direction };
        let found = mesh.intersect(&ray, f64::INFINITY).map(|crossing| (crossing.t, crossing.part));
        let each = (0..).zip(&alone).filter_map(|(i, one)| Some((one.intersect(&ray, f64::INFINITY)?.t, i)));
        let nearest = each.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(found, nearest, "{ray:?}");
        assert_eq!(mesh.is_crossed(&ray, f64::INFINITY, None), nearest.is_some(), "{ray:?}");
        hits += usize::from(found.is_some());
    }
    assert!(hits > 5000, "{hits}");
}
