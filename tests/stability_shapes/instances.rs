//! Rows X4 and S6 of the stability catalog for meshes that are placed by a map: light alternately enters and leaves
//! them, and a ray that leaves one never hits it again.

use std::sync::Arc;

use abbe::math::{DVec3, Ray, Transform};
use abbe::shape::{Instance, Shape};

use super::OFFSET;
use super::glass::{Aim, EVENTS, Tally, follow, maps};
use crate::support::bodies::{ball, closed_mesh};
use crate::support::random::Random;
use crate::support::scenes::{SINGLE_PATH, body, environment, render_film, view};

/// Returns the ball of `bodies`, placed by a map.
fn instance(map: &Transform) -> Shape {
    let (points, faces) = ball();
    let Shape::Mesh(mesh) = closed_mesh(points, faces) else { unreachable!("it is a mesh") };
    Shape::Instance(Box::new(Instance::new(mesh, *map).expect("a map that can be turned back")))
}

/// Returns a target on or in the ball, in its own space, and the least cosine between a ray and the target's arm. Below
/// that cosine, the ray touches the ball in a point that faces both ways.
fn target(random: &mut Random) -> (Aim, DVec3, f64) {
    let (points, faces) = ball();
    let [a, b, _] = faces[(random.number() * faces.len() as f64) as usize].map(|i| points[i as usize]);
    match (random.number() * 3.0) as u32 {
        0 => (Aim::Anywhere, random.direction() * 0.95 * random.number(), -2.0),
        1 => (Aim::Edge, a + (b - a) * random.number(), 0.3),
        _ => (Aim::Corner, a, 0.3),
    }
}

/// Follows rays from 4 radii away, drawn in the ball's own space, until enough has happened.
fn tally(body: &Shape, map: &Transform, targets: &[(Aim, DVec3, f64)], size: f64, events: u64) -> Tally {
    let mut random = Random::new(52);
    let mut tally = Tally::default();
    while tally.events < events {
        for (_, aimed, steepness) in targets {
            let origin = random.direction() * 4.0;
            if -(*aimed - origin).normalize().dot(aimed.normalize_or_zero()) >= *steepness {
                let origin = map.point(origin);
                follow(body, Ray::new(origin, map.point(*aimed) - origin), size, &mut random, &mut tally);
            }
        }
    }
    tally
}

fn targets() -> Vec<(Aim, DVec3, f64)> {
    let mut random = Random::new(53);
    (0..3000).map(|_| target(&mut random)).collect()
}

/// Sizes, and offsets in units of size.
const PLACES: [(f64, f64); 6] = [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (1.0, 1e4), (1e-3, 1e6), (1e3, 100.0)];

fn placed(map: &Transform, (size, offset): (f64, f64)) -> Transform {
    map.then(&Transform::scale(DVec3::splat(size))).then(&Transform::translate(OFFSET * offset * size))
}

#[test]
fn x4_rays_enter_and_leave_an_instance_of_a_glass_mesh_by_turns() {
    let uneven = Transform::scale(DVec3::new(1.0, 0.5, 0.7)).then(&maps()[1]);
    let mirrored = Transform::scale(DVec3::new(-0.8, 1.0, 1.2)).then(&maps()[1]);
    let point_mirrored = maps()[1].then(&Transform::scale(DVec3::splat(-1.0)));
    let targets = targets();
    for (form, map) in [maps()[0], maps()[1], uneven, mirrored, point_mirrored].iter().enumerate() {
        for place in PLACES {
            let map = placed(map, place);
            let result = tally(&instance(&map), &map, &targets, place.0, EVENTS);
            assert_eq!(result.wrong, 0, "form {form}, size and offset {place:?}: {result:?}");
        }
    }
}

#[test]
fn x4_rays_into_thin_and_sheared_instances_go_astray_no_more_often_than_in_baked_meshes() {
    // A ray aimed exactly at the rim of a thin body has no room to start between the faces that meet there, in an
    // instance as well as in a baked mesh. Such rays are counted, and no others may go astray.
    let (points, faces) = ball();
    let all = targets();
    let inner: Vec<_> = all.iter().copied().filter(|target| matches!(target.0, Aim::Anywhere)).collect();
    for map in &maps()[2..] {
        for place in PLACES {
            let map = placed(map, place);
            let result = tally(&instance(&map), &map, &inner, place.0, EVENTS);
            assert_eq!(result.wrong, 0, "{map:?}: {result:?}");
            let baked = closed_mesh(points.clone(), faces.clone()).transformed(&map);
            let wrong = [&instance(&map), &baked].map(|body| tally(body, &map, &all, place.0, 50_000).wrong as f64);
            // Counts of rare events have a variance equal to their mean.
            assert!(wrong[0] <= wrong[1] + 5.0 * (wrong[0] + wrong[1] + 1.0).sqrt(), "{map:?}: {wrong:?}");
        }
    }
}

#[test]
fn s6_scaling_an_instance_by_a_power_of_two_changes_no_bit_of_any_path() {
    let targets = targets();
    for map in maps() {
        let map = map.then(&Transform::translate(DVec3::new(0.3, -7.0, 2.0)));
        let mut expected = None;
        for exponent in [0, -40, -20, 20, 40] {
            let size = libm::exp2(f64::from(exponent));
            let map = map.then(&Transform::scale(DVec3::splat(size)));
            let result = tally(&instance(&map), &map, &targets, size, 20_000);
            assert_eq!(*expected.get_or_insert(result), result, "2^{exponent}");
        }
    }
}

#[test]
fn an_instance_is_where_its_baked_triangles_are() {
    let mut random = Random::new(54);
    let (points, faces) = ball();
    let mesh = closed_mesh(points, faces);
    let mirror = maps()[4].then(&Transform::scale(DVec3::new(1.0, -0.7, 1.0)));
    for map in maps().into_iter().chain([mirror]) {
        let map = map.then(&Transform::translate(DVec3::new(30.0, -7.0, 2.0)));
        let (placed, baked) = (instance(&map), mesh.transformed(&map));
        assert!((placed.area() / baked.area() - 1.0).abs() < 1e-12);
        assert!(placed.is_closed());
        let (wide, tight) = (placed.bounds().expect("finite"), baked.bounds().expect("finite"));
        assert!(wide.min.cmple(tight.min).all() && wide.max.cmpge(tight.max).all());
        assert!((wide.min - tight.min).length() < 1e-9 && (wide.max - tight.max).length() < 1e-9);
        let mut met = 0;
        for _ in 0..5000 {
            let origin = map.point(random.direction() * 4.0);
            let ray = Ray::new(origin, map.point(random.direction() * 0.9 * random.number()) - origin);
            let both = [&placed, &baked].map(|shape| shape.intersect(&ray, f64::INFINITY).expect("it is aimed at"));
            let [a, b] = [placed.point(&ray, &both[0]), baked.point(&ray, &both[1])];
            // On an edge, either of two triangles may be hit. The map there and back rounds as much as the thin side
            // allows.
            assert!((both[0].t - both[1].t).abs() < 1e-11 * both[1].t, "{map:?}");
            if both[0].part == both[1].part {
                met += 1;
                assert!((a.normal - b.normal).length() < 1e-11, "{} and {}", a.normal, b.normal);
                let within = a.error + b.error;
                let off = (a.position - b.position).dot(a.normal).abs();
                assert!(off <= within.dot(a.normal.abs()), "{off:e} off, {within} allowed");
            }
        }
        assert!(met > 4900);
    }
}

#[test]
fn copies_of_a_mesh_share_its_triangles() {
    let (points, faces) = ball();
    let Shape::Mesh(mesh) = closed_mesh(points, faces) else { unreachable!("it is a mesh") };
    let shape = Shape::Mesh(mesh.clone());
    for map in maps() {
        match shape.copied(&map) {
            Shape::Mesh(same) => assert!(map == Transform::IDENTITY && Arc::ptr_eq(&same, &mesh)),
            Shape::Instance(placed) => assert!(map != Transform::IDENTITY && Arc::ptr_eq(placed.mesh(), &mesh)),
            other => panic!("{other:?}"),
        }
    }
}

/// In the space of a huge mesh that is placed very small, positions and directions are beyond the range of 32 bits.
/// There, boxes of missing children used to be hit, and others missed.
#[test]
fn copies_whose_own_space_is_beyond_32_bits_are_met_as_others_are() {
    let (points, faces) = ball();
    let seen = |radius: f64, scale: f64, away: f64| {
        let points: Vec<[f64; 3]> = points.iter().map(|point| (*point * radius).to_array()).collect();
        let text = view([away; 3], [0.0; 3], 50.0, 12)
            + "[render]\nsamples = 16\n"
            + &body(
                "matte",
                "diffuse = { reflectance = 0.5 }",
                &[&format!("mesh = {{ points = {points:?}, faces = {faces:?} }}")],
            )
            + &format!("instances = [[{{ scale = {scale:e} }}]]\n")
            + &environment(1.0);
        let (film, report) = render_film(&text, SINGLE_PATH);
        assert_eq!(report.non_finite, 0, "{radius:e} at {scale:e} from {away:e}");
        let sum: f64 = film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1])).sum();
        sum / film.pixels.len() as f64
    };
    // The body is too far away to be seen.
    for [radius, scale, away] in [[1e30, 1e-30, 1e9], [1e25, 1e-25, 1e14], [1e30, 1e-15, 1e24]] {
        let found = seen(radius, scale, away);
        assert!((found - 1.0).abs() < 0.02, "{radius:e} at {scale:e} from {away:e}: {found}");
    }
    let near = seen(1.0, 1.0, 2.0);
    assert!(near < 0.9, "{near}");
    for scale in [1e-30, 1e-36, 1e-38, 1e-40, 1e-44, 1e-50] {
        let found = seen(1e30, scale, 2e30 * scale);
        assert!((found / near - 1.0).abs() < 0.01, "{scale:e}: {found}, not {near}");
    }
}
