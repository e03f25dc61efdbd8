//! Row X3 of the stability catalog where it is hardest: surfaces through the world's origin, and narrow ones.

use abbe::math::{DMat3, DVec3, Frame, Ray, Transform};
use abbe::shape::{Cube, Ellipsoid, Quad, Shape, Sphere, Triangle};

use crate::support::random::Random;

/// Returns how many of the rays that leave a shape at targets on it hit it again: on either side, or outside a closed
/// shape.
fn count_returning(rays: usize, mut draw: impl FnMut(&mut Random) -> (Shape, DVec3)) -> usize {
    let mut random = Random::new(42);
    let mut again = 0;
    for _ in 0..rays {
        let (shape, target) = draw(&mut random);
        let direction = random.direction();
        let context = Ray::new(target - direction * random.between(1.0, 5.0), direction);
        let Some(intersection) = shape.intersect(&context, f64::INFINITY) else { continue };
        let point = shape.point(&context, &intersection);
        let direction = Ray::new(DVec3::ZERO, random.direction()).direction;
        let inward = shape.is_closed() && direction.dot(point.normal) < 0.0;
        let leaving = point.leave(if inward { -direction } else { direction });
        again += usize::from(shape.intersect(&leaving, f64::INFINITY).is_some());
    }
    again
}

#[test]
fn x3_no_ray_hits_what_it_leaves_where_the_coordinates_of_the_surface_are_zero() {
    // The floors of most scenes. An offset relative to a coordinate of 0 does not leave them.
    let on_floor = |random: &mut Random| DVec3::new(random.between(-1.0, 1.0), 0.0, random.between(-1.0, 1.0));
    let triangle = count_returning(100_000, |random| {
        let points = std::array::from_fn(|_| on_floor(random));
        (Shape::Triangle(Triangle::new(points)), (points[0] + points[1] + points[2]) / 3.0)
    });
    assert_eq!(triangle, 0, "triangles");
    let cube = count_returning(100_000, |random| {
        let (half, tilt) = (random.between(0.1, 3.0), random.between(-0.1, 0.1));
        let standing = Shape::Cube(Cube::new(DVec3::Y * half, DVec3::splat(2.0 * half)));
        let map = if random.number() < 0.5 { Transform::IDENTITY } else { Transform::rotate(DVec3::X, tilt) };
        (standing.transformed(&map), map.point(on_floor(random) * half))
    });
    assert_eq!(cube, 0, "cubes");
    let sphere = count_returning(100_000, |random| {
        let radius = random.between(0.1, 3.0);
        (Shape::Sphere(Sphere::new(DVec3::Y * radius, radius)), on_floor(random) * 0.1 * radius)
    });
    assert_eq!(sphere, 0, "spheres");
}

#[test]
fn x3_no_ray_hits_the_narrow_shape_that_it_leaves() {
    for width in [1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8] {
        let narrow = |random: &mut Random| {
            let frame = Frame::about(random.direction());
            [DVec3::X, DVec3::new(random.number(), width, 0.0)].map(|side| frame.to_world(side))
        };
        let triangle = count_returning(50_000, |random| {
            let [u, v] = narrow(random);
            let corner = random.direction() * random.between(0.0, 3.0).floor();
            (Shape::Triangle(Triangle::new([corner, corner + u, corner + v])), corner + u * 0.3 + v * 0.4)
        });
        assert_eq!(triangle, 0, "triangles of width {width:e}");
        let quad = count_returning(50_000, |random| {
            let [u, v] = narrow(random);
            let center = random.direction();
            let target = center + u * random.between(-1.0, 1.0) + v * random.between(-1.0, 1.0);
            (Shape::Quad(Quad::new(center, u, v)), target)
        });
        assert_eq!(quad, 0, "quads of width {width:e}");
        let ellipsoid = count_returning(50_000, |random| {
            let turned = |random: &mut Random| Transform::rotate(random.direction(), random.between(0.0, 360.0));
            let flat = Transform::scale(DVec3::new(1.0, width.max(1e-3), 0.5));
            let map = turned(random).then(&flat).then(&turned(random));
            let body =
                Shape::Ellipsoid(Ellipsoid::new(DVec3::Y * 0.7, DMat3::from_diagonal(DVec3::new(1.0, 0.7, 2.0))));
            (body.transformed(&map), map.vector(random.direction() * 0.3))
        });
        assert_eq!(ellipsoid, 0, "ellipsoids of width {width:e}");
    }
}
