//! Rows X4 and S6 of the stability catalog: light alternately enters and leaves closed glass bodies.

use abbe::math::{DMat3, DVec3, Ray, Transform};
use abbe::shape::{Cube, Ellipsoid, Shape, Sphere};

use super::OFFSET;
use crate::support::bodies::{ball, closed_mesh};
use crate::support::random::Random;

const INDEX: f64 = 1.5;
pub const EVENTS: u64 = 200_000;
/// Number of crossings after which a ray that is trapped by total reflection is abandoned.
const MAX_CROSSINGS: u32 = 40;

/// Counts of what happened to the rays.
#[derive(Clone, Copy, Default, PartialEq, Debug)]
pub struct Tally {
    pub events: u64,
    pub wrong: u64,
    /// Hash of the part of every crossing, and of its distance in units of the body's size.
    hash: u64,
}

/// Returns the direction after an interface, reflected or refracted at random by the Fresnel reflectance, and whether
/// the ray passed through.
///
/// Born & Wolf 1999, section 1.5, equations 8 and 21, without polarization.
fn scatter(direction: DVec3, normal: DVec3, leaving: bool, random: &mut Random) -> (DVec3, bool) {
    let (facing, from, to) = if leaving { (-normal, INDEX, 1.0) } else { (normal, 1.0, INDEX) };
    let (eta, cos) = (from / to, -direction.dot(facing));
    let cos_squared = 1.0 - eta * eta * (1.0 - cos * cos);
    let beyond = cos_squared.max(0.0).sqrt();
    let s = (from * cos - to * beyond) / (from * cos + to * beyond);
    let p = (to * cos - from * beyond) / (to * cos + from * beyond);
    if random.number() < 0.5 * (s * s + p * p) || cos_squared <= 0.0 {
        ((direction + facing * (2.0 * cos)).normalize(), false)
    } else {
        ((direction * eta + facing * (eta * cos - beyond)).normalize(), true)
    }
}

/// Follows a ray from outside until it leaves for good. A convex body is entered only once.
pub fn follow(body: &Shape, mut ray: Ray, size: f64, random: &mut Random, tally: &mut Tally) {
    let mut inside = false;
    for event in 0..MAX_CROSSINGS {
        let Some(intersection) = body.intersect(&ray, f64::INFINITY) else {
            tally.wrong += u64::from(inside);
            return;
        };
        tally.events += 1;
        let key = (intersection.t / size).to_bits().rotate_left(17) ^ u64::from(intersection.part);
        tally.hash = (tally.hash ^ key).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        let point = body.point(&ray, &intersection);
        let leaving = ray.direction.dot(point.normal) > 0.0;
        let again = event > 0 && !inside;
        if leaving != inside || again {
            tally.wrong += 1;
            return;
        }
        let (direction, passed) = scatter(ray.direction, point.normal, leaving, random);
        inside ^= passed;
        ray = point.leave(direction);
    }
}

/// Follows rays from 4 sizes away, aimed at targets of the body, until enough has happened.
///
/// At the rim of a body of triangles, as seen from `origin`, rays touch the body in a point that faces both ways. Rays
/// for which the cosine to the target's arm is below `steepness` are left out.
fn tally(
    (body, center, size): (&Shape, DVec3, f64),
    events: u64,
    steepness: f64,
    mut target: impl FnMut(&mut Random) -> DVec3,
) -> Tally {
    let mut random = Random::new(51);
    let mut tally = Tally::default();
    for _ in 0..20 * events {
        if tally.events >= events {
            break;
        }
        let origin = center + random.direction() * 4.0 * size;
        let aimed = target(&mut random);
        let ray = Ray::new(origin, aimed - origin);
        if -ray.direction.dot((aimed - center).normalize_or_zero()) >= steepness {
            follow(body, ray, size, &mut random, &mut tally);
        }
    }
    tally
}

/// A steepness that leaves nothing out.
pub const ANY_STEEPNESS: f64 = -2.0;

/// Size, and coordinate offset in units of size.
const PLACES: [(f64, f64); 6] = [(1.0, 0.0), (1e-3, 0.0), (1e3, 0.0), (1.0, 100.0), (1e-6, 0.0), (1.0, 1e4)];

/// The target of a ray: anywhere on a face or inside the body near it, on an edge, or at a corner.
#[derive(Clone, Copy, Debug)]
pub enum Aim {
    Anywhere,
    Edge,
    Corner,
}

fn check_mesh(aim: Aim) {
    for (size, offset) in PLACES {
        let (points, faces) = ball();
        let center = OFFSET * offset * size;
        let points: Vec<DVec3> = points.into_iter().map(|p| (p + OFFSET * offset) * size).collect();
        let body = closed_mesh(points.clone(), faces.clone());
        let steepness = if matches!(aim, Aim::Anywhere) { ANY_STEEPNESS } else { 0.3 };
        let result = tally((&body, center, size), EVENTS, steepness, |random| {
            let [a, b, _] = faces[(random.number() * faces.len() as f64) as usize].map(|i| points[i as usize]);
            match aim {
                Aim::Anywhere => center + random.direction() * 0.95 * size * random.number(),
                Aim::Edge => a + (b - a) * random.number(),
                Aim::Corner => a,
            }
        });
        assert_eq!(result.wrong, 0, "aimed at {aim:?}, size {size:e}, offset {offset:e}: {result:?}");
    }
}

#[test]
fn x4_rays_aimed_anywhere_enter_and_leave_a_glass_mesh_by_turns() {
    check_mesh(Aim::Anywhere);
}

#[test]
fn x4_rays_aimed_at_edges_enter_and_leave_a_glass_mesh_by_turns() {
    check_mesh(Aim::Edge);
}

#[test]
fn x4_rays_aimed_at_corners_enter_and_leave_a_glass_mesh_by_turns() {
    check_mesh(Aim::Corner);
}

/// Returns a rotation about none of the world's axes.
fn turn(degrees: f64) -> Transform {
    Transform::rotate(DVec3::new(0.3, -1.0, 0.6), degrees)
}

/// Returns maps of the unit body: as it is, turned, thin, thin and turned, sheared.
pub fn maps() -> [Transform; 5] {
    let thin = Transform::scale(DVec3::new(1.0, 1e-3, 0.7));
    let sheared = turn(40.0).then(&Transform::scale(DVec3::new(1.0, 0.2, 0.6))).then(&turn(75.0));
    [Transform::IDENTITY, turn(33.0), thin, thin.then(&turn(33.0)), sheared]
}

/// Checks the unit body in every place and form, with rays aimed at the image of what `target` draws on the unit body.
fn check_unit_body(body: &Shape, target: impl Fn(Aim, &mut Random) -> DVec3) {
    for (form, map) in maps().iter().enumerate() {
        // The last place puts the body on the world's origin, where coordinates cancel.
        let standing = (1.0, map.vector(DVec3::Y));
        for (size, center) in PLACES.map(|(size, offset)| (size, OFFSET * offset * size)).into_iter().chain([standing])
        {
            let map = map.then(&Transform::scale(DVec3::splat(size))).then(&Transform::translate(center));
            let placed = body.transformed(&map);
            for aim in [Aim::Anywhere, Aim::Edge, Aim::Corner] {
                let result =
                    tally((&placed, center, size), 60_000, ANY_STEEPNESS, |random| map.point(target(aim, random)));
                assert_eq!(result.wrong, 0, "aimed at {aim:?}, form {form}, size {size:e} at {center}: {result:?}");
            }
        }
    }
}

#[test]
fn x4_rays_enter_and_leave_a_glass_cube_by_turns() {
    let cube = Shape::Cube(Cube::new(DVec3::ZERO, DVec3::splat(2.0)));
    check_unit_body(&cube, |aim, random| {
        // On a face, one coordinate is at its limit. On an edge two are, at a corner three.
        let ends = match aim {
            Aim::Anywhere => 1,
            Aim::Edge => 2,
            Aim::Corner => 3,
        };
        let first = (random.number() * 3.0) as usize;
        let mut point = DVec3::from_array(std::array::from_fn(|_| random.between(-1.0, 1.0)));
        for axis in (first..first + ends).map(|axis| axis % 3) {
            point[axis] = point[axis].signum();
        }
        point
    });
}

#[test]
fn x4_rays_enter_and_leave_a_glass_ellipsoid_by_turns() {
    let ball = Shape::Ellipsoid(Ellipsoid::new(DVec3::ZERO, DMat3::IDENTITY));
    check_unit_body(&ball, |aim, random| {
        let radius = match aim {
            Aim::Anywhere => random.number(),
            Aim::Edge => 1.0 - 1e-9 * random.number(),
            Aim::Corner => 1.0,
        };
        random.direction() * radius
    });
}

#[test]
fn x4_rays_enter_and_leave_a_glass_sphere_by_turns() {
    for (size, offset) in PLACES {
        let center = OFFSET * offset * size;
        let sphere = Shape::Sphere(Sphere::new(center, size));
        let result = tally((&sphere, center, size), EVENTS, ANY_STEEPNESS, |random| center + random.direction() * size);
        assert_eq!(result.wrong, 0, "size {size:e}, offset {offset:e}: {result:?}");
    }
}

#[test]
fn s6_scaling_a_glass_body_by_a_power_of_two_changes_no_bit_of_any_path() {
    let (points, faces) = ball();
    let bodies = [
        closed_mesh(points, faces),
        Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0)),
        Shape::Ellipsoid(Ellipsoid::new(DVec3::ZERO, DMat3::from_diagonal(DVec3::new(1.0, 0.6, 0.8)))),
        Shape::Cube(Cube::new(DVec3::ZERO, DVec3::new(1.0, 0.6, 0.8))),
    ];
    for body in bodies {
        let mut expected = None;
        for exponent in [0, -40, -20, 20, 40] {
            let size = libm::exp2(f64::from(exponent));
            let scaled = body.transformed(&Transform::scale(DVec3::splat(size)));
            let result = tally((&scaled, DVec3::ZERO, size), 20_000, ANY_STEEPNESS, |random| {
                random.direction() * 0.4 * size * random.number()
            });
            assert_eq!(result.wrong, 0);
            assert_eq!(*expected.get_or_insert(result), result, "2^{exponent}");
        }
    }
}
