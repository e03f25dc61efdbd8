//! Rows X1 to X3, X6 and X7 of the stability catalog: new rays from flat surfaces. (Row X4 is in `glass.rs`, X5 in
//! `spheres.rs`, more of X3 in `returning.rs`.)

use abbe::math::{DVec3, Frame, Ray, UNIT_ROUNDOFF};
use abbe::shape::{Disc, Plane, Quad, Shape, SurfacePoint, Triangle};

use super::OFFSET;
use crate::support::exact::ExactVector;
use crate::support::larger::larger;
use crate::support::random::Random;

/// Size of the surface, then its coordinate offset and the distance of the ray's origin, both in units of size.
const SETTINGS: [(f64, f64, f64); 12] = [
    (1.0, 1.0, 5.0),
    (1e-6, 1.0, 5.0),
    (1e-3, 1.0, 5.0),
    (1e3, 1.0, 5.0),
    (1e6, 1.0, 5.0),
    (1.0, 1.0, 1e3),
    (1.0, 1.0, 1e5),
    (1.0, 1e3, 5.0),
    (1.0, 1e5, 5.0),
    (1.0, 0.0, 5.0),
    (1e-6, 1e5, 1e5),
    (1e6, 1e5, 1e5),
];

/// A ray that hits a surface, the ray that leaves from there, and the corners of the triangle that it leaves.
struct Departure {
    context: Ray,
    t: f64,
    point: SurfacePoint,
    leaving: Ray,
    corners: [DVec3; 3],
    /// The corner that completes the triangle to a parallelogram.
    fourth: DVec3,
}

impl Departure {
    /// Returns the distance of the new origin from the plane of the triangle.
    fn height(&self) -> f64 {
        let [a, b, c] = self.corners.map(ExactVector::from);
        let normal = (b - a).cross(c - a);
        ((ExactVector::from(self.leaving.origin) - a).dot(normal) / normal.length()).abs().rounded()
    }
}

/// Tests departures from the triangle (0, 0), (1, 0), (0, 1) of a square in any orientation, which `shape` builds from
/// its corners. They are at the points that `aim` returns.
fn departures(
    (size, offset, distance): (f64, f64, f64),
    aim: fn([f64; 2]) -> [f64; 2],
    shape: impl Fn([DVec3; 3], DVec3) -> Shape,
    mut test: impl FnMut(&Shape, &Departure),
) {
    const COUNT: usize = 40_000;
    let mut random = Random::new(41);
    let mut tested = 0;
    for _ in 0..4 * COUNT {
        let frame = Frame::about(random.direction());
        let place = |x, y| OFFSET * offset * size + frame.to_world(DVec3::new(x, y, 0.0)) * size;
        let corners = [place(0.0, 0.0), place(1.0, 0.0), place(0.0, 1.0)];
        let fourth = place(1.0, 1.0);
        let built = shape(corners, fourth);
        let [x, y] = aim(random.pair());
        let direction = random.direction();
        let cos = direction.dot(frame.to_world(DVec3::Z));
        if cos.abs() < 0.05 {
            continue;
        }
        let context = Ray::new(place(x, y) - direction * distance * size, direction);
        let Some(intersection) = built.intersect(&context, f64::INFINITY) else { continue };
        let point = built.point(&context, &intersection);
        let leaving = point.leave(Ray::new(DVec3::ZERO, random.direction()).direction);
        tested += 1;
        test(&built, &Departure { context, t: intersection.t, point, leaving, corners, fourth });
        if tested == COUNT {
            return;
        }
    }
    panic!("only {tested} rays hit the shape of size {size:e} that they are aimed at");
}

/// Returns a point anywhere in the triangle.
fn anywhere([x, y]: [f64; 2]) -> [f64; 2] {
    if x + y > 1.0 { [1.0 - x, 1.0 - y] } else { [x, y] }
}

/// Returns a point on the edge that the triangle shares with the other one of the square.
fn on_shared_edge([x, _]: [f64; 2]) -> [f64; 2] {
    [x, 1.0 - x]
}

fn first_triangle(corners: [DVec3; 3], _: DVec3) -> Shape {
    Shape::Triangle(Triangle::new(corners))
}

fn hits(shape: &Shape, ray: &Ray) -> bool {
    shape.intersect(ray, f64::INFINITY).is_some()
}

/// Returns whether a ray hits the other triangle of the square.
fn hits_neighbor(departure: &Departure) -> bool {
    let [_, b, c] = departure.corners;
    hits(&Shape::Triangle(Triangle::new([b, departure.fourth, c])), &departure.leaving)
}

#[test]
fn x1_without_an_offset_half_of_all_new_rays_hit_the_surface_that_they_leave() {
    let (mut own, mut all) = (0, 0);
    departures(SETTINGS[0], anywhere, first_triangle, |shape, departure| {
        let origin = departure.context.at(departure.t);
        own += usize::from(hits(shape, &Ray { origin, direction: departure.leaving.direction }));
        all += 1;
    });
    let share = f64::from(own as u32) / f64::from(all as u32);
    println!("X1: {share:.3} of the rays hit their own surface");
    assert!((0.2..0.6).contains(&share), "{share}");
}

#[test]
fn x2_a_sheet_a_thousandth_of_the_size_away_is_seen_at_every_scale() {
    for setting in SETTINGS {
        departures(setting, anywhere, first_triangle, |_, departure| {
            let side = departure.point.normal * departure.leaving.direction.dot(departure.point.normal).signum();
            let sheet = Shape::Plane(Plane::new(departure.corners[0] + side * 1e-3 * setting.0, side));
            // Nearly parallel rays hit the sheet far away, or never because of rounding.
            let steep = departure.leaving.direction.dot(side) > 1e-9;
            assert!(!steep || hits(&sheet, &departure.leaving), "{setting:?}: {:?}", departure.leaving);
        });
    }
}

#[test]
fn x3_no_ray_hits_the_triangles_that_it_leaves_and_the_offset_is_a_few_roundings() {
    for setting in SETTINGS {
        let (size, offset, distance) = setting;
        let (mut own, mut highest) = (0, 0f64);
        departures(setting, anywhere, first_triangle, |shape, departure| {
            own += usize::from(hits(shape, &departure.leaving) || hits_neighbor(departure));
            highest = larger(highest, departure.height());
        });
        let roundings = highest / (UNIT_ROUNDOFF * (size + offset * size));
        println!("X3: size {size:e}, offset {offset:e} s, distance {distance:e} s: moved by {roundings:.1} u (s + C)");
        assert_eq!(own, 0, "{setting:?}");
        assert!(roundings <= 32.0, "{setting:?}: {roundings} u (s + C)");
    }
}

#[test]
fn x3_no_ray_hits_the_plane_quad_or_disc_that_it_leaves() {
    let plane = |[a, b, c]: [DVec3; 3], _| Shape::Plane(Plane::new(a, (b - a).cross(c - a)));
    let quad = |[a, b, c]: [DVec3; 3], d: DVec3| Shape::Quad(Quad::new((a + d) * 0.5, (b - a) * 0.5, (c - a) * 0.5));
    let disc = |[a, b, c]: [DVec3; 3], _| {
        let normal = (b - a).cross(c - a);
        Shape::Disc(Disc::new(a, normal, (b - a).length() * 2.0, None).expect("no direction is asked for"))
    };
    for setting in SETTINGS {
        let (size, offset, _) = setting;
        let mut highest = 0f64;
        let mut check = |shape: &Shape, departure: &Departure| {
            assert!(!hits(shape, &departure.leaving), "{setting:?}: {shape:?}, {:?}", departure.leaving);
            let away = departure.leaving.origin - departure.point.position;
            highest = larger(highest, away.dot(departure.point.normal).abs());
        };
        departures(setting, anywhere, plane, &mut check);
        departures(setting, anywhere, quad, &mut check);
        departures(setting, anywhere, disc, &mut check);
        let roundings = highest / (UNIT_ROUNDOFF * (size + offset * size));
        println!("X3: flat shapes, {setting:?}: moved by {roundings:.1} u (s + C)");
        assert!(roundings <= 32.0, "{setting:?}: {roundings} u (s + C)");
    }
}

#[test]
fn x6_rays_do_not_hit_a_neighbor_in_the_plane_that_they_leave() {
    for setting in [(1.0, 0.0, 5.0), (1.0, 1e3, 5.0), (1.0, 1e5, 5.0)] {
        departures(setting, on_shared_edge, first_triangle, |_, departure| {
            assert!(!hits_neighbor(departure), "{setting:?}: {:?}", departure.leaving);
        });
    }
}

#[test]
fn x7_the_distance_of_the_camera_does_not_move_new_rays_away() {
    let mut highest = 0f64;
    departures((1.0, 1.0, 1e5), anywhere, first_triangle, |_, departure| highest = highest.max(departure.height()));
    println!("X7: moved by {highest:.1e} s");
    // The row allows 1e-9 s. Rays start from points that are computed from the triangle's corners, so the distance does
    // not matter at all.
    assert!(highest <= 64.0 * UNIT_ROUNDOFF, "{highest:e}");
}
