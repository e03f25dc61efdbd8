//! Small objects share a tree, in which rays find the same as object by object.

use std::cell::Cell;

use abbe::math::{DVec3, Ray};
use abbe::scene::{Hit, RayEnds};

use crate::support::random::Random;
use crate::support::scenes::{body, environment, scene, view};

/// Returns blocks that touch, a roof of single triangles, a lamp, a ball and a floor. Coordinates are whole numbers, so
/// that many crossings tie.
fn village() -> String {
    let block = |x: i32, z: i32| {
        let corner = |i: i32| format!("[{}, {}, {}]", x + (i & 1), i >> 1 & 1, z + (i >> 2));
        let points: Vec<String> = (0..8).map(corner).collect();
        format!(
            "mesh = {{ points = [{}], faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], \
             [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]] }}",
            points.join(", ")
        )
    };
    let blocks = [block(-1, 0), block(0, 0), block(0, 1), block(-1, 0)];
    let triangles = ["[[-1, 1, 0], [0, 2, 0], [0, 1, 0]]", "[[0, 1, 0], [0, 2, 0], [1, 1, 0]]"];
    let triangles = triangles.map(|points| format!("triangle = {{ points = {points} }}"));
    let mut shapes: Vec<&str> = blocks.iter().map(String::as_str).collect();
    shapes.insert(2, "sphere = { center = [0, 1, 1], radius = 1 }");
    shapes.insert(3, "quad = { center = [0, 0, 0], u = [4, 0, 0], v = [0, 0, -4] }");
    shapes.extend(triangles.iter().map(String::as_str));
    view([0.0, 3.0, 9.0], [0.0; 3], 40.0, 4)
        + &body("stone", "diffuse = { reflectance = 0.5 }", &shapes)
        + &environment(1.0)
}

#[test]
fn rays_find_in_a_shared_tree_what_they_find_object_by_object() {
    let scene = scene(&village());
    let mut random = Random::new(31);
    let (mut hits, mut ties) = (0, 0);
    for i in 0..40_000 {
        // Every other ray starts on whole and half numbers and aims at them, through edges and corners.
        let mut place = || {
            let x = random.between(-3.0, 3.0);
            if i % 2 == 0 { (2.0 * x).round() / 2.0 } else { x }
        };
        let [origin, target] = [(); 2].map(|()| DVec3::new(place(), place(), place()));
        let Some(direction) = (target - origin).try_normalize() else { continue };
        let ray = Ray { origin, direction };
        let intersections = || {
            let intersection = |object: usize| scene.objects[object].shape.intersect(&ray, f64::INFINITY);
            (0..scene.objects.len())
                .filter_map(move |i| intersection(i).map(|intersection| Hit { object: i as u32, intersection }))
        };
        let nearest =
            intersections().min_by(|a, b| a.intersection.t.total_cmp(&b.intersection.t).then(a.object.cmp(&b.object)));
        assert_eq!(scene.intersect(&ray), nearest, "{ray:?}");
        let Some(hit) = nearest else { continue };
        hits += 1;
        ties += usize::from(intersections().filter(|other| other.intersection.t == hit.intersection.t).count() > 1);
        // A light at the distance of a crossing, which is an object of the scene or none.
        let distance = if i % 3 == 0 { hit.intersection.t } else { random.between(0.0, 5.0) };
        for light in [None, Some(hit.object), Some(0), Some(5), Some(7)] {
            let hides = |other: &Hit| {
                light.is_none_or(|light| light != other.object)
                    && (other.intersection.t < distance
                        || other.intersection.t == distance && light.is_none_or(|light| other.object < light))
            };
            let expected = intersections().any(|other| hides(&other));
            assert_eq!(
                scene.is_occluded(&ray, distance, light, &Cell::new(None)),
                expected,
                "{ray:?} {light:?} {distance}"
            );
        }
    }
    assert!(hits > 20_000 && ties > 1000, "{hits} rays meet something, {ties} two things at once");
}

/// Returns a village of blocks. If `large`, the blocks have too many triangles for the shared tree, and each has a tree
/// of its own.
fn blocks(large: bool) -> String {
    let more: String = (0..1100).map(|i| format!(", [{i}, 99, 0], [{i}, 99, 1], [{}, 99, 0]", i + 1)).collect();
    let faces: String = (0..1100).map(|i| format!(", [{}, {}, {}]", 3 * i + 8, 3 * i + 9, 3 * i + 10)).collect();
    let (points, faces) = if large { (more, faces) } else { Default::default() };
    village().replace("]], faces", &format!("]{points}], faces")).replace("[3, 7, 5]]", &format!("[3, 7, 5]{faces}]"))
}

#[test]
fn the_triangle_of_a_lamp_is_occluded_by_others_of_the_lamp_and_by_what_stands_before_it() {
    for large in [false, true] {
        let scene = scene(&blocks(large));
        let mut random = Random::new(32);
        let (mut free, mut hidden) = (0, 0);
        for i in 0..40_000 {
            let mut place = || {
                let x = random.between(-2.0, 2.0);
                if i % 2 == 0 { (2.0 * x).round() / 2.0 } else { x }
            };
            let [origin, target] = [(); 2].map(|()| DVec3::new(place(), place(), place()));
            let Some(direction) = (target - origin).try_normalize() else { continue };
            let ray = Ray { origin, direction };
            let lamp = [0, 1, 4, 5][i % 4];
            let shape = &scene.objects[lamp].shape;
            let own_hit = shape.intersect(&ray, f64::INFINITY);
            for part in 0..12 {
                let Some(intersection) = shape.intersect_triangle(&ray, part) else { continue };
                let ends = RayEnds { start: None, light: Some(lamp as u32), part: Some(part) };
                let whole = scene.is_occluded(&ray, intersection.t, Some(lamp as u32), &Cell::new(None));
                let expected = whole || own_hit != Some(intersection);
                assert_eq!(
                    scene.is_occluded(&ray, intersection.t, ends, &Cell::new(None)),
                    expected,
                    "{ray:?} {lamp} {part}"
                );
                (free, hidden) = (free + usize::from(!expected), hidden + usize::from(expected && !whole));
            }
        }
        assert!(free > 500 && hidden > 500, "{free} are free, {hidden} hidden by the lamp alone");
    }
}
