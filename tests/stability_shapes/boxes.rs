//! Rows B1 to B3 and B6 of the stability catalog: boxes of the tree, and vertices that are not numbers. (Rows B4 and B5
//! are tested where the tree is built.)

use std::cell::Cell;
use std::sync::Arc;

use abbe::math::{Bounds, DMat3, DVec3, Frame, Ray, Transform};
use abbe::shape::{Bvh, Cube, Disc, Ellipsoid, Mesh, Quad, Shape, Triangle, Vertices, Visitor, read_mesh};

use super::OFFSET;
use crate::meshes::files::file;
use crate::support::random::Random;
use crate::support::scenes::{body, object, scene, view};

/// Records whether a walk reaches an item.
struct Reached<'a> {
    bvh: &'a Bvh,
    item: u32,
    reached: bool,
}

impl Visitor for Reached<'_> {
    fn visit(&mut self, first: usize, groups: usize, t_max: f64) -> Option<f64> {
        self.reached |= self.bvh.items()[first..first + groups].contains(&self.item);
        Some(t_max)
    }
}

fn reaches(boxes: &[Bounds], ray: &Ray, item: u32) -> bool {
    let bvh = &Bvh::new::<1>(boxes.iter().copied());
    let [mut any, mut nearest] = [(); 2].map(|()| Reached { bvh, item, reached: false });
    bvh.walk::<false>(ray, f64::INFINITY, &mut any);
    bvh.walk::<true>(ray, f64::INFINITY, &mut nearest);
    assert_eq!(any.reached, nearest.reached);
    any.reached
}

/// Returns a point whose coordinates are exact in f32, so that its box is not rounded outward.
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
            // A wall, whose box is flat.
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
            // The triangle is half a side of the flat box. Rays aim at its corner, or along the edges that both share.
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
        read_mesh(&path, false).err()
    };
    for (name, text) in [("mesh.ply", ply as fn(&str) -> String), ("mesh.obj", obj)] {
        for number in ["nan", "inf", "-inf", "1e39"] {
            let message = refusal(name, text(number)).unwrap_or_else(|| panic!("{name} with {number} is accepted"));
            // The message names the line if it is known, and otherwise the vertex.
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
    let intersection = shape.intersect(&ray, f64::INFINITY).expect("the ray runs through the first triangle");
    assert!(
        (intersection.t / (9.0 * f64::from(most)) - 1.0).abs() < 1e-15 && intersection.part == 0,
        "{intersection:?}"
    );
    assert!(shape.area().is_finite() && shape.pdf(&ray, &intersection).is_finite());
}

/// Returns long, slanting shapes around and beside the center of the world.
fn needles(random: &mut Random) -> Vec<Shape> {
    let mesh = Mesh::new(
        Vertices::Double(vec![DVec3::NEG_ONE, DVec3::X, DVec3::Y, DVec3::ONE]),
        vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
    );
    let mesh = Arc::new(mesh.expect("triangles"));
    let kinds = [
        Shape::Cube(Cube::new(DVec3::ZERO, DVec3::splat(2.0))),
        Shape::Ellipsoid(Ellipsoid::new(DVec3::ZERO, DMat3::IDENTITY)),
        Shape::Quad(Quad::new(DVec3::ZERO, DVec3::X, DVec3::Y)),
        Shape::Disc(Disc::new(DVec3::ZERO, DVec3::Z, 1.0, None).expect("a disc")),
        Shape::Mesh(mesh),
    ];
    let mut needle = |number: usize| {
        let frame = Frame::about(random.direction());
        let [x, y] = [random.between(0.001, 0.05), random.between(0.001, 0.05)];
        let axes = DMat3::from_cols(frame.to_world(DVec3::X), frame.to_world(DVec3::Y), frame.to_world(DVec3::Z));
        let axes = axes * DMat3::from_diagonal([DVec3::new(3.0, x, y), DVec3::new(x, y, 3.0)][number % 2]);
        let map = Transform::affine(axes, random.direction() * random.between(0.0, 2.0));
        kinds[number % kinds.len()].copied(&map)
    };
    (0..500).map(&mut needle).collect()
}

#[test]
fn b6_boxes_of_pieces_hold_all_that_rays_meet_of_a_shape() {
    let mut random = Random::new(37);
    let shapes = needles(&mut random);
    let (mut hits, mut pieces) = (0, 0);
    for shape in &shapes {
        let mut boxes = Vec::new();
        shape.boxes(shapes.len(), |bounds| boxes.push(bounds));
        pieces += boxes.len();
        let whole = shape.bounds().expect("it is finite");
        let within = |bounds: &Bounds, point: DVec3| point.cmpge(bounds.min).all() && point.cmple(bounds.max).all();
        for _ in 0..400 {
            let at = whole.min + (whole.max - whole.min) * DVec3::from([(); 3].map(|()| random.number()));
            let aim = if random.number() < 0.5 { at } else { whole.center() };
            let ray = Ray::new(aim + random.direction() * 4.0, DVec3::X);
            let ray = Ray::new(ray.origin, aim - ray.origin);
            if let Some(intersection) = shape.intersect(&ray, f64::INFINITY) {
                let point = shape.point(&ray, &intersection).position;
                assert!(boxes.iter().any(|bounds| within(bounds, point)), "{shape:?}, {ray:?}");
                hits += 1;
            }
        }
    }
    assert!(pieces > 3 * shapes.len() && hits > 20_000, "{pieces} pieces, {hits} hits");
}

/// Each ray used to enter the boxes of every third needle.
#[test]
fn b6_objects_whose_pieces_have_boxes_are_met_as_if_they_were_whole_and_few_are_tried() {
    const NEEDLES: usize = 1000;
    let mut random = Random::new(38);
    let mut needle = |number: usize| {
        let ([x, y], [z, degrees]) = (random.pair(), random.pair());
        let shape =
            ["cube = { center = [0, 0, 0], size = [8, 0.01, 0.02] }", "sphere = { center = [0, 0, 0], radius = 1 }"];
        let thin = ["", "{ scale = [4, 0.01, 0.02] }, "][number % 2];
        let axis = [x - 0.5, y - 0.5, z - 0.5];
        let turn = format!("{{ rotate = {{ axis = {axis:?}, degrees = {} }} }}", 360.0 * degrees);
        let at = random.direction() * 3.0;
        object("gray", shape[number % 2])
            + &format!("transform = [{thin}{turn}, {{ translate = [{}, {}, {}] }}]\n", at.x, at.y, at.z)
    };
    let needles: String = (0..NEEDLES).map(&mut needle).collect();
    let text = view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4) + &body("gray", "diffuse.reflectance = 0.5", &[]) + &needles;
    let scene = scene(&text);
    let (mut hits, tried) = (0, Cell::new(0));
    let counts = |_: u32| {
        tried.set(tried.get() + 1);
        true
    };
    for _ in 0..5000 {
        let origin = random.direction() * 6.0;
        let ray = Ray::new(origin, random.direction() * 3.0 - origin);
        let found = scene.nearest(&ray, f64::INFINITY, &counts).map(|hit| (hit.intersection.t, hit.object));
        let each = (0..).zip(scene.objects.iter());
        let each = each.filter_map(|(i, one)| Some((one.shape.intersect(&ray, f64::INFINITY)?.t, i)));
        let nearest = each.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(found, nearest, "{ray:?}");
        assert_eq!(scene.is_occluded(&ray, f64::INFINITY, None, &Cell::new(None)), nearest.is_some(), "{ray:?}");
        hits += usize::from(found.is_some());
    }
    println!("B6: {hits} hits, {} tried", tried.get());
    assert!(hits > 1000 && tried.get() < 5000 * NEEDLES / 10, "{hits} hits, {} tried", tried.get());
}

/// Long triangles between points of a lattice. They are split in planes of the lattice, in which many rays run.
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
        let found = mesh.intersect(&ray, f64::INFINITY).map(|intersection| (intersection.t, intersection.part));
        let each = (0..).zip(&alone).filter_map(|(i, one)| Some((one.intersect(&ray, f64::INFINITY)?.t, i)));
        let nearest = each.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        assert_eq!(found, nearest, "{ray:?}");
        assert_eq!(mesh.is_crossed(&ray, f64::INFINITY, None), nearest.is_some(), "{ray:?}");
        hits += usize::from(found.is_some());
    }
    assert!(hits > 5000, "{hits}");
}
