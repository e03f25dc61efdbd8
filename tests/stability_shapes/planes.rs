//! Rows P1 to P4 of the stability catalog: planes and discs.

use abbe::math::{DVec3, Frame, Ray, UNIT_ROUNDOFF};
use abbe::shape::{Cube, Disc, Plane, Quad, Shape, Triangle};

use super::OFFSET;
use crate::support::exact::{Exact, ExactVector};
use crate::support::larger::larger;
use crate::support::random::Random;

/// Distance of a ray's start from its hit. A number with few digits would hide rounding errors of t.
const DISTANCE: f64 = 9.870_123_456_789;

/// Returns the largest errors over many rays that hit a plane, through a point at coordinate `offset`, at an angle: the
/// height of the hit above the plane in roundings of the distance, and that of t in roundings over the angle's cosine.
fn plane_errors(offset: f64, cos: f64) -> [f64; 2] {
    let mut random = Random::new(11);
    let mut worst = [0f64; 2];
    for _ in 0..20_000 {
        let normal = Ray::new(DVec3::ZERO, random.direction()).direction;
        let frame = Frame::about(normal);
        let [a, b] = random.pair();
        let point = OFFSET * offset + frame.to_world(DVec3::new(a, b, 0.0));
        let direction = frame.to_world(DVec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos));
        let ray = Ray::new(point - direction * DISTANCE, direction);
        let plane = Shape::Plane(Plane::new(point, normal));
        let t = plane.intersect(&ray, f64::INFINITY).expect("the ray was aimed at the plane").t;
        // The plane normalizes its normal once more. The normal that it keeps is the one that its points report.
        let kept = plane.point(&ray, &plane.intersect(&ray, f64::INFINITY).expect("as above")).normal;
        let (n, along) = (ExactVector::from(kept), ExactVector::from(ray.direction));
        let start = ExactVector::from(ray.origin) - point.into();
        let height = (start + along * t.into()).dot(n) / n.length();
        let exact = -(start.dot(n) / along.dot(n));
        let relative = ((Exact::from(t) - exact) / exact).abs();
        worst[0] = worst[0].max(height.abs().rounded() / (UNIT_ROUNDOFF * DISTANCE));
        worst[1] = worst[1].max(relative.rounded() * cos / UNIT_ROUNDOFF);
    }
    println!("P1, P2: offset {offset:e}, cos {cos:e}: height {:.2} u D, t {:.2} u / cos", worst[0], worst[1]);
    worst
}

#[test]
fn p1_hits_lie_on_a_plane_wherever_it_is() {
    for offset in [0.0, 1e3, 1e6] {
        for cos in [1.0, 1e-2] {
            let [height, _] = plane_errors(offset, cos);
            // The row allows 8 u (D + C). The difference of points is formed first, so C does not matter.
            assert!(height <= 8.0, "offset {offset:e}, cos {cos:e}: {height} u D");
        }
    }
}

#[test]
fn p2_grazing_hits_stay_on_the_plane_and_lose_no_more_than_the_angle_takes() {
    for cos in [1e-2, 1e-4, 1e-6, 1e-8] {
        let [height, t] = plane_errors(0.0, cos);
        assert!(height <= 4.0, "cos {cos:e}: {height} u D");
        assert!(t <= 4.0, "cos {cos:e}: {t} u / cos");
    }
}

#[test]
fn p3_rays_within_or_beside_a_plane_miss_it() {
    let mut random = Random::new(13);
    let flat = [
        Shape::Plane(Plane::new(DVec3::ZERO, DVec3::Y)),
        Shape::Disc(Disc::new(DVec3::ZERO, DVec3::Y, 2.0, None).expect("no direction is asked for")),
        Shape::Quad(Quad::new(DVec3::ZERO, DVec3::Z * 2.0, DVec3::X * 2.0)),
        Shape::Triangle(Triangle::new([DVec3::X * 2.0, DVec3::Z * 2.0, DVec3::new(-3.0, 0.0, -3.0)])),
    ];
    for _ in 0..1_000 {
        let [x, z] = random.pair();
        for height in [0.0, -0.0, 1e-300, 1.0, -1.0] {
            for up in [0.0, -0.0] {
                let direction = DVec3::new(random.between(-1.0, 1.0), up, random.between(-1.0, 1.0));
                let ray = Ray::new(DVec3::new(x, height, z), direction);
                for shape in &flat {
                    assert_eq!(shape.intersect(&ray, f64::INFINITY), None, "{shape:?}, {ray:?}");
                }
            }
        }
    }
    // A ray from a NaN point, along a NaN direction or along no direction hits nothing.
    for shape in flat.iter().chain([&Shape::Cube(Cube::new(DVec3::ZERO, DVec3::ONE))]) {
        for (origin, direction) in [(DVec3::NAN, DVec3::Y), (DVec3::Y, DVec3::NAN), (DVec3::Y, DVec3::ZERO)] {
            assert_eq!(shape.intersect(&Ray { origin, direction }, f64::INFINITY), None, "{shape:?}");
        }
    }
}

/// Returns a ray aimed near the rim of the unit disc about `center`, and how far outside the rim it crosses, |d|^2 - 1.
fn ray_near_rim(center: DVec3, normal: DVec3, nearness: f64, random: &mut Random) -> (Ray, f64) {
    let (sin, cos) = libm::sincos(random.between(0.0, std::f64::consts::TAU));
    let radius = 1.0 + random.between(-nearness, nearness);
    let target = center + Frame::about(normal).to_world(DVec3::new(cos, sin, 0.0) * radius);
    let origin = target + (normal + random.direction() * 0.5) * 5.0;
    let ray = Ray::new(origin, target - origin);
    let (n, along) = (ExactVector::from(normal), ExactVector::from(ray.direction));
    let start = ExactVector::from(ray.origin) - center.into();
    let arm = start - along * (start.dot(n) / along.dot(n));
    (ray, (arm.dot(arm) - 1.0.into()).rounded())
}

#[test]
fn p4_the_rim_of_a_disc_is_where_it_should_be() {
    for offset in [0.0, 1e3, 1e5] {
        let mut random = Random::new(14);
        let mut worst = 0f64;
        for ray_index in 0..100_000 {
            let normal = Ray::new(DVec3::ZERO, random.direction()).direction;
            let center = OFFSET * offset;
            let disc = Shape::Disc(Disc::new(center, normal, 1.0, None).expect("no direction is asked for"));
            // Half of the rays test the row as it stands. The others aim at the rim as exactly as they can.
            let nearness = if ray_index % 2 == 0 { 0.01 } else { 0.0 };
            let (ray, outside) = ray_near_rim(center, normal, nearness, &mut random);
            if disc.intersect(&ray, f64::INFINITY).is_some() != (outside < 0.0) {
                assert!(nearness == 0.0, "offset {offset:e}: |d|^2 - 1 = {outside:e}");
                worst = larger(worst, outside.abs() / UNIT_ROUNDOFF);
            }
        }
        println!("P4: offset {offset:e}: the furthest wrong hit lies {worst:.1} u off the rim");
        assert!(worst <= 64.0, "offset {offset:e}: {worst} u");
    }
}
