//! The tree of a large mesh: no ray slips through it, at any scale and place, and a search for any crossing finds one
//! exactly where there is a nearest one.

use std::f64::consts::{PI, TAU};

use abbe::math::{DVec3, Ray};
use abbe::shape::{Mesh, Shape, Vertices};

use crate::support::bodies::ball_faces;
use crate::support::random::Random;

const AROUND: u32 = 180;
const RINGS: u32 = 90;

/// Returns points and faces of a closed ball of 32,040 triangles about a center, with radius 1 times a scale.
fn ball(center: DVec3, scale: f64) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let place = |p: DVec3| (center + p * scale).to_array().map(|x| x as f32);
    let mut points = vec![place(DVec3::Z), place(-DVec3::Z)];
    for ring in 1..RINGS {
        for step in 0..AROUND {
            let (sin, cos) = libm::sincos(PI * f64::from(ring) / f64::from(RINGS));
            let azimuth = TAU * f64::from(step) / f64::from(AROUND);
            points.push(place(DVec3::new(sin * libm::cos(azimuth), sin * libm::sin(azimuth), cos)));
        }
    }
    (points, ball_faces(AROUND, RINGS - 1))
}

fn mesh(points: &[[f32; 3]], faces: &[[u32; 3]]) -> Shape {
    let mesh = Mesh::new(Vertices::Single(points.to_vec()), faces.to_vec()).expect("faces with area");
    assert_eq!(mesh.open_edges(), 0);
    Shape::Mesh(mesh.into())
}

/// Returns a point well inside the ball.
fn inside(random: &mut Random, center: DVec3, scale: f64) -> DVec3 {
    center + random.direction() * (0.9 * scale * random.number())
}

#[test]
fn of_a_million_rays_at_edges_and_corners_none_slips_through_a_tree() {
    let mut random = Random::new(31);
    let far = DVec3::new(1000.0, -300.0, 77.0);
    // Powers of two keep the shape of the ball. Far away, its 32-bit vertices lie on a coarse lattice.
    let places = [(DVec3::ZERO, -40), (DVec3::ZERO, 0), (DVec3::ZERO, 40), (far, 0)];
    for (center, power) in places {
        let scale = libm::exp2(f64::from(power));
        let (points, faces) = ball(center, scale);
        let mesh = mesh(&points, &faces);
        for i in 0..250_000 {
            let face = faces[(random.number() * faces.len() as f64) as usize];
            let [a, b, _] = face.map(|corner| DVec3::from(points[corner as usize].map(f64::from)));
            let target = if i % 2 == 0 { a } else { a + (b - a) * random.number() };
            let from = inside(&mut random, center, scale);
            let ray = Ray::new(from, target - from);
            assert!(mesh.intersect(&ray, f64::INFINITY).is_some(), "2^{power} about {center}: {ray:?}");
            assert!(mesh.is_crossed(&ray, f64::INFINITY, None), "2^{power} about {center}: {ray:?}");
        }
    }
}

#[test]
fn rays_along_the_axes_in_planes_of_vertices_do_not_slip_through_a_tree() {
    let mut random = Random::new(32);
    let (points, faces) = ball(DVec3::ZERO, 1.0);
    let mesh = mesh(&points, &faces);
    for i in 0..60_000 {
        let (axis, other) = (i % 3, (i + 1) % 3);
        let mut from = inside(&mut random, DVec3::ZERO, 0.4);
        // The coordinate of a vertex, so that the ray runs along the sides of boxes.
        let mut level = || f64::from(points[(random.number() * points.len() as f64) as usize][other]);
        from[other] = std::iter::repeat_with(&mut level).find(|x| x.abs() < 0.8).expect("a vertex near the middle");
        let mut direction = DVec3::ZERO;
        direction[axis] = if i % 2 == 0 { 1.0 } else { -1.0 };
        let ray = Ray { origin: from, direction };
        assert!(mesh.intersect(&ray, f64::INFINITY).is_some(), "{ray:?}");
    }
}

#[test]
fn some_crossing_is_found_just_where_there_is_a_nearest_one() {
    let mut random = Random::new(33);
    let (points, faces) = ball(DVec3::ZERO, 1.0);
    let mesh = mesh(&points, &faces);
    let mut hits = 0;
    for _ in 0..100_000 {
        let from = random.direction() * 3.0;
        let to = random.direction() * random.between(0.0, 1.5);
        let ray = Ray::new(from, to - from);
        match mesh.intersect(&ray, f64::INFINITY) {
            Some(intersection) => {
                hits += 1;
                assert!(
                    mesh.is_crossed(&ray, f64::INFINITY, None) && mesh.is_crossed(&ray, intersection.t, None),
                    "{ray:?}"
                );
                assert!(!mesh.is_crossed(&ray, intersection.t.next_down(), None), "{ray:?}");
            }
            None => assert!(!mesh.is_crossed(&ray, f64::INFINITY, None), "{ray:?}"),
        }
    }
    assert!((30_000..90_000).contains(&hits), "{hits} rays meet the ball");
}
