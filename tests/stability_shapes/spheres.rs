//! Rows S1 to S5, S7 and X5 of the stability catalog: spheres, and unit directions.

use abbe::math::{DVec3, Frame, Ray, Transform, UNIT_ROUNDOFF};
use abbe::shape::{Shape, Sphere, SurfacePoint};

use super::OFFSET;
use crate::support::exact::{Exact, ExactVector};
use crate::support::larger::larger;
use crate::support::random::Random;

const RAYS: usize = 20_000;

/// Returns both roots of |origin + t direction - center| = radius, for a direction of any length.
fn exact_roots(center: DVec3, radius: f64, ray: &Ray) -> Option<[Exact; 2]> {
    let (d, n) = (ExactVector::from(center) - ray.origin.into(), ExactVector::from(ray.direction));
    let (length_squared, along, radius) = (n.dot(n), n.dot(d), Exact::from(radius));
    let under_root = along * along - length_squared * (d.dot(d) - radius * radius);
    if under_root < Exact::ZERO {
        return None;
    }
    let root = under_root.sqrt();
    Some([(along - root) / length_squared, (along + root) / length_squared])
}

/// Returns a ray from a random side whose line passes `impact` away from the center.
fn ray_at_impact(center: DVec3, distance: f64, impact: f64, random: &mut Random) -> Ray {
    let outward = random.direction();
    let across = Frame::about(outward).to_world(DVec3::X);
    let sin = impact / distance;
    let cos = (1.0 - sin * sin).sqrt();
    Ray::new(center + outward * distance, across * sin - outward * cos)
}

fn hit(shape: &Shape, ray: &Ray) -> Option<f64> {
    shape.intersect(ray, f64::INFINITY).map(|intersection| intersection.t)
}

#[test]
fn s1_far_spheres_are_hit_within_16_roundings_of_distance_over_radius() {
    let mut random = Random::new(1);
    for (center, radius) in [(DVec3::ZERO, 1.0), (DVec3::new(0.3, -0.2, 0.1), 0.7)] {
        let shape = Shape::Sphere(Sphere::new(center, radius));
        for distance in [1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e8] {
            let mut worst = 0f64;
            for _ in 0..RAYS {
                let impact = 0.999 * radius * random.number().sqrt();
                let ray = ray_at_impact(center, distance * radius, impact, &mut random);
                let t = hit(&shape, &ray).expect("a ray aimed at a sphere hits it");
                let arm = ExactVector::from(ray.origin) + ExactVector::from(ray.direction) * t.into() - center.into();
                let error = (arm.length() - radius.into()).abs().rounded() / radius;
                assert!(t < distance * radius, "the near side is hit");
                worst = larger(worst, error / (UNIT_ROUNDOFF * distance));
            }
            println!("S1: distance {distance:e} R, error {worst:.1} u D / R");
            assert!(distance > 1e6 || worst <= 16.0);
        }
    }
}

#[test]
fn s2_rays_that_graze_a_sphere_hit_or_miss_as_they_should() {
    let mut random = Random::new(2);
    let shape = Shape::Sphere(Sphere::new(DVec3::ZERO, 1.0));
    // The last pair distinguishes formulas: the expanded discriminant is already off by (D / R)^2 roundings.
    for (distance, nearness) in [(10.0, 1e-2), (10.0, 1e-4), (10.0, 1e-6), (10.0, 1e-8), (100.0, 1e-12)] {
        let mut hits = 0;
        for _ in 0..RAYS {
            let side = if random.number() < 0.5 { -1.0 } else { 1.0 };
            let ray = ray_at_impact(DVec3::ZERO, distance, 1.0 + side * nearness, &mut random);
            let expected = exact_roots(DVec3::ZERO, 1.0, &ray).is_some();
            assert_eq!(hit(&shape, &ray).is_some(), expected, "{ray:?} at {nearness:e}");
            hits += usize::from(expected);
        }
        assert!((RAYS / 3..RAYS * 2 / 3).contains(&hits));
    }
}

/// The wall of a room of 100 units, made of a sphere (Beason 2014, *smallpt*).
const WALL: (DVec3, f64) = (DVec3::new(1e5 + 1.0, 40.8, 81.6), 1e5);

fn in_the_room(random: &mut Random) -> DVec3 {
    DVec3::new(random.between(2.0, 98.0), random.between(1.0, 80.0), random.between(1.0, 169.0))
}

#[test]
fn s3_both_sides_of_a_sphere_as_large_as_a_wall_are_hit_within_1e8th_of_a_unit() {
    let mut random = Random::new(3);
    let shape = Shape::Sphere(Sphere::new(WALL.0, WALL.1));
    let mut worst = 0f64;
    for _ in 0..RAYS {
        let ray = Ray::new(in_the_room(&mut random), random.direction());
        let [_, far] = exact_roots(WALL.0, WALL.1, &ray).expect("the room is inside");
        let t = hit(&shape, &ray).expect("the room is inside");
        worst = larger(worst, (Exact::from(t) - far).abs().rounded());
        let outside = Ray::new(DVec3::new(-50.0, 40.8, 81.6), in_the_room(&mut random) - DVec3::new(-50.0, 40.8, 81.6));
        let [near, _] = exact_roots(WALL.0, WALL.1, &outside).expect("it aims at a point inside");
        let t = hit(&shape, &outside).expect("it aims at a point inside");
        worst = larger(worst, (Exact::from(t) - near).abs().rounded());
    }
    println!("S3: error of t {worst:.1e}");
    assert!(worst <= 1e-8);
}

#[test]
fn s4_rays_that_bounce_off_a_sphere_as_large_as_a_wall_cross_the_room() {
    let mut random = Random::new(4);
    let shape = Shape::Sphere(Sphere::new(WALL.0, WALL.1));
    // Starting too close to the surface shows in one of 70 000 rays.
    for _ in 0..20 * RAYS {
        let target = DVec3::new(1.0, random.between(1.0, 80.0), random.between(1.0, 160.0));
        let origin = in_the_room(&mut random);
        let ray = Ray::new(origin, target - origin);
        let point = surface_point(&shape, &ray);
        check_inward(&shape, WALL, &point, &mut random);
    }
}

fn surface_point(shape: &Shape, ray: &Ray) -> SurfacePoint {
    let intersection = shape.intersect(ray, f64::INFINITY).expect("the ray was aimed at the sphere");
    shape.point(ray, &intersection)
}

/// Checks that a ray that leaves toward the inside starts there and hits the far side.
fn check_inward(shape: &Shape, (center, radius): (DVec3, f64), point: &SurfacePoint, random: &mut Random) {
    // The length is only as exact as plain scaling makes it: up to 3 roundings off 1.
    let direction = random.direction().normalize();
    let inward = if direction.dot(point.normal) > 0.0 { -direction } else { direction };
    let leaving = point.leave(inward);
    let [behind, ahead] = exact_roots(center, radius, &leaving).expect("the ray runs inside");
    assert!(behind < Exact::ZERO && ahead > Exact::ZERO, "{leaving:?} starts outside");
    let t = hit(shape, &leaving).expect("the far side is ahead");
    assert!((t / ahead.rounded() - 1.0).abs() < 0.5, "{t:e} instead of {:e}", ahead.rounded());
}

#[test]
fn s5_directions_are_unit_vectors_within_2_roundings() {
    let mut random = Random::new(5);
    let off_unit = |v: DVec3| (ExactVector::from(v).length() - 1.0.into()).abs().rounded() / UNIT_ROUNDOFF;
    let (mut ray_error, mut normal_error) = (0f64, 0f64);
    for _ in 0..200_000 {
        let size = libm::exp10(random.between(-100.0, 100.0));
        ray_error = larger(ray_error, off_unit(Ray::new(DVec3::ZERO, random.direction() * size).direction));
        let factors = DVec3::new(random.between(0.1, 3.0), random.between(-3.0, -0.1), random.between(0.1, 3.0));
        let map = Transform::rotate(random.direction(), random.between(0.0, 360.0)).then(&Transform::scale(factors));
        normal_error = larger(normal_error, off_unit(map.normal(random.direction())));
    }
    println!("S5: rays {ray_error:.2} u, normals {normal_error:.2} u");
    assert!(ray_error <= 2.0, "rays: {ray_error} u");
    assert!(normal_error <= 2.0, "normals: {normal_error} u");
}

#[test]
fn s7_spheres_of_any_size_are_hit_where_they_are() {
    for size in [1e-24, 1e-20, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e6, 1e18, 1e20] {
        let mut random = Random::new(7);
        let mut worst = 0f64;
        let shape = Shape::Sphere(Sphere::new(DVec3::ZERO, size));
        for _ in 0..5_000 {
            let impact = 0.9 * random.number().sqrt() * size;
            let ray = ray_at_impact(DVec3::ZERO, 10.0 * size, impact, &mut random);
            let [near, _] = exact_roots(DVec3::ZERO, size, &ray).expect("the ray was aimed at the sphere");
            let t = hit(&shape, &ray).expect("the ray was aimed at the sphere");
            worst = larger(worst, (t / near.rounded() - 1.0).abs());
        }
        assert!(worst <= 32.0 * UNIT_ROUNDOFF, "size {size:e}: {worst:e}");
    }
}

#[test]
fn x5_rays_that_leave_a_sphere_outward_miss_it_and_inward_meet_its_far_side() {
    // Radius, then offset and distance of the ray's origin in units of the radius.
    let settings = [
        (1.0, 0.0, 5.0),
        (1.0, 10.0, 5.0),
        (1.0, 1e3, 5.0),
        (1.0, 0.0, 1e3),
        (1e-3, 0.0, 5.0),
        (1e-3, 1e3, 5.0),
        (1e5, 1.0, 1.001),
        (1e5, 1e3, 5.0),
    ];
    for (radius, offset, distance) in settings {
        let mut random = Random::new(8);
        let center = OFFSET * offset * radius;
        let shape = Shape::Sphere(Sphere::new(center, radius));
        for _ in 0..RAYS {
            let origin = center + random.direction() * distance * radius;
            let ray = Ray::new(origin, center + random.direction() * 0.9 * radius - origin);
            let point = surface_point(&shape, &ray);
            check_inward(&shape, (center, radius), &point, &mut random);
            let direction = random.direction();
            let outward = if direction.dot(point.normal) < 0.0 { -direction } else { direction };
            let again = hit(&shape, &point.leave(outward));
            assert_eq!(again, None, "radius {radius:e}, offset {offset} R, distance {distance} R");
        }
    }
}
