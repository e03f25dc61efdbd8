//! Texture coordinates: where the points of shapes lie in the images on them.

use std::f64::consts::{PI, TAU};
use std::ops::Neg;

use super::{Disc, Intersection, Quad, Shape, SurfacePoint};
use crate::math::{DMat3, DVec3, Transform, horizontal_tangent};

/// The texture coordinates (u, v) of the points of a shape. Transforms carry them along.
///
/// - quad: 0 to 1 along its u and its v; disc: the same on the square around it;
/// - triangle: (0, 0), (1, 0), (0, 1) at its points;
/// - cube: 0 to 1 on each face, seen upright from outside; on the top face v runs to -z, on the bottom face to +z;
/// - mesh: as its file says;
/// - sphere: longitude and latitude, seen from outside, with +z in the middle, +x at u = 3/4, +y at v = 1;
/// - plane: scene units from its `point`, u horizontal and v up; on a horizontal one u = +x, so that v = -z on a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coordinates {
    /// A quad or a disc.
    Square,
    /// A triangle, and whether its last two points were swapped.
    Triangle {
        /// Whether a mirroring transform has swapped the points.
        swapped: bool,
    },
    /// A cube.
    Cube,
    /// A mesh, or an instance of one.
    Mesh,
    /// A sphere or an ellipsoid.
    Sphere {
        /// Center of the sphere in the world.
        center: DVec3,
        /// Takes directions from the world to the sphere's own space.
        inverse: DMat3,
    },
    /// A plane.
    Plane {
        /// The point where u = v = 0.
        origin: DVec3,
        /// The gradient of u.
        u: DVec3,
        /// The gradient of v.
        v: DVec3,
    },
}

impl Coordinates {
    /// Creates the coordinates of a shape after the transform `map`. `shape` itself is not yet transformed. Returns
    /// `None` if the shape has no coordinates.
    pub fn new(shape: &Shape, map: &Transform) -> Option<Self> {
        let inverse = map.inverse_linear();
        Some(match shape {
            Shape::Quad(_) | Shape::Disc(_) => Self::Square,
            Shape::Triangle(_) => Self::Triangle { swapped: map.swaps_handedness() },
            Shape::Cube(_) => Self::Cube,
            Shape::Sphere(sphere) => Self::Sphere { center: map.point(sphere.center), inverse },
            Shape::Plane(plane) => {
                let normal = plane.normal();
                let u = horizontal_tangent(normal);
                let [u, v] = [u, normal.cross(u)].map(|axis| inverse.transpose() * axis);
                Self::Plane { origin: map.point(plane.point), u, v }
            }
            Shape::Mesh(mesh) if mesh.has_coordinates() => Self::Mesh,
            Shape::Ellipsoid(_) | Shape::Mesh(_) | Shape::Instance(_) => return None,
        })
    }

    /// Returns the coordinates at a crossing of the shape. `position` is the point in the world.
    pub fn at(&self, shape: &Shape, intersection: &Intersection, position: DVec3) -> [f64; 2] {
        let unit = |uv: [f64; 2]| uv.map(|x| 0.5 + 0.5 * x);
        match self {
            Self::Square => unit(intersection.uv),
            Self::Mesh => {
                shape.mesh().and_then(|mesh| mesh.coordinates(intersection.part, intersection.uv)).unwrap_or_default()
            }
            Self::Triangle { swapped } => swapped_if(*swapped, intersection.uv),
            Self::Cube => unit(upright(intersection.part, intersection.uv)),
            Self::Sphere { center, inverse } => {
                let DVec3 { x, y, z } = *inverse * (position - *center);
                [0.5 + libm::atan2(x, z) / TAU, 1.0 - libm::atan2((x * x + z * z).sqrt(), y) / PI]
            }
            Self::Plane { origin, u, v } => {
                let offset = position - *origin;
                [offset.dot(*u), offset.dot(*v)]
            }
        }
    }

    /// Returns the derivatives of a point of the shape with respect to its coordinates u and v, in the world. Returns
    /// `None` if a mesh has no coordinates or if one of its triangles is mapped to a line in the image.
    ///
    /// At the poles of a sphere, where a change of u does not move the point, the first derivative is 0.
    pub fn tangents(&self, shape: &Shape, intersection: &Intersection, point: &SurfacePoint) -> Option<[DVec3; 2]> {
        match self {
            Self::Square => {
                let (Shape::Disc(Disc { plane }) | Shape::Quad(Quad { plane })) = shape else { return None };
                Some([plane.u * 2.0, plane.v * 2.0])
            }
            Self::Triangle { swapped } => {
                let Shape::Triangle(triangle) = shape else { return None };
                let [p1, p2, p3] = triangle.points;
                Some(swapped_if(*swapped, [p2 - p1, p3 - p1]))
            }
            Self::Cube => {
                let Shape::Cube(cube) = shape else { return None };
                let plane = cube.face(intersection.part);
                Some(upright(intersection.part, [plane.u * 2.0, plane.v * 2.0]))
            }
            Self::Mesh => match shape {
                Shape::Mesh(mesh) => mesh.tangents(intersection.part),
                Shape::Instance(instance) => instance.tangents(intersection.part),
                _ => None,
            },
            Self::Sphere { center, inverse } => {
                let DVec3 { x, y, z } = *inverse * (point.position - *center);
                let across = (x * x + z * z).sqrt();
                let (sin, cos) = if across > 0.0 { (x / across, z / across) } else { (0.0, 1.0) };
                let along = [DVec3::new(z, 0.0, -x) * TAU, DVec3::new(-y * sin, across, -y * cos) * PI];
                let forward = inverse.inverse();
                Some(along.map(|own| forward * own))
            }
            Self::Plane { u, v, .. } => {
                // The directions in the plane along which one of the coordinates is constant.
                let [along_u, along_v] = [v.cross(point.normal), point.normal.cross(*u)];
                Some([along_u / along_u.dot(*u), along_v / along_v.dot(*v)])
            }
        }
    }
}

fn swapped_if<T>(swapped: bool, [a, b]: [T; 2]) -> [T; 2] {
    if swapped { [b, a] } else { [a, b] }
}

/// Converts a pair along a cube face's own coordinates to the pair along the coordinates of an upright image.
///
/// The own coordinates of the faces -x, +x, -y, +y, -z, +z run along the next two axes.
fn upright<T: Neg<Output = T>>(face: u32, [a, b]: [T; 2]) -> [T; 2] {
    match face {
        0 | 2 => [b, a],
        1 => [-b, a],
        3 => [b, -a],
        4 => [-a, b],
        _ => [a, b],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ray;
    use crate::shape::{Attributes, Cube, Mesh, Plane, Sphere, Triangle, Vertices};

    /// Returns the coordinates of the first point that a ray from `from` to `toward` meets.
    fn seen_coordinates(shape: Shape, map: &Transform, from: DVec3, toward: DVec3) -> [f64; 2] {
        let coordinates = Coordinates::new(&shape, map).expect("the shape has coordinates");
        let shape = shape.transformed(map);
        let ray = Ray { origin: from, direction: (toward - from).normalize() };
        let intersection = shape.intersect(&ray, f64::INFINITY).expect("the ray meets the shape");
        coordinates.at(&shape, &intersection, shape.point(&ray, &intersection).position)
    }

    fn assert_near(found: [f64; 2], expected: [f64; 2]) {
        let near = (0..2).all(|i| (found[i] - expected[i]).abs() < 1e-12);
        assert!(near, "{found:?} is not {expected:?}");
    }

    /// Returns shapes, each with one of its points.
    fn shapes() -> Vec<(Shape, DVec3)> {
        let quad = Quad::new(DVec3::new(1.0, 0.5, 0.0), DVec3::new(2.0, 0.3, 0.0), DVec3::Y);
        let disc = Disc::new(DVec3::ZERO, DVec3::new(0.2, 0.0, 1.0), 2.0, Some(DVec3::X)).unwrap();
        let triangle = Triangle::new([DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.5)]);
        vec![
            (Shape::Quad(quad), DVec3::new(0.3, 0.9, 0.0)),
            (Shape::Disc(disc), DVec3::new(0.3, -0.7, -0.06)),
            (Shape::Triangle(triangle), DVec3::new(0.6, 0.8, 0.2)),
            (Shape::Sphere(Sphere::new(DVec3::new(0.0, 0.5, 0.0), 1.0)), DVec3::new(0.48, 1.1, 0.64)),
            (Shape::Plane(Plane::new(DVec3::Y, DVec3::new(0.0, 1.0, 3.0))), DVec3::new(5.0, 4.0, -1.0)),
            (mirrored_mesh(), DVec3::new(0.9, 0.3, 0.03)),
            (mirrored_mesh(), DVec3::new(0.3, 0.7, 0.03)),
        ]
    }

    fn maps() -> [Transform; 5] {
        [
            Transform::IDENTITY,
            Transform::translate(DVec3::new(3.0, -2.0, 1.0)),
            Transform::rotate(DVec3::new(1.0, 2.0, -0.5), 77.0).then(&Transform::translate(DVec3::X)),
            Transform::scale(DVec3::new(0.5, 3.0, 1.25)).then(&Transform::rotate(DVec3::new(0.3, 1.0, 0.0), 200.0)),
            Transform::scale(DVec3::new(-1.0, 1.0, 1.5)),
        ]
    }

    /// Whatever moves, rotates, stretches or mirrors a shape carries its coordinates along.
    #[test]
    fn a_point_keeps_its_coordinates_under_every_transform() {
        let cube = Cube::new(DVec3::new(0.1, 0.2, 0.3), DVec3::splat(2.0));
        for (shape, point) in shapes().into_iter().chain([(Shape::Cube(cube), DVec3::new(0.4, 0.1, 1.3))]) {
            let from = point + DVec3::new(0.1, 0.2, 2.0);
            let plain = seen_coordinates(shape.clone(), &Transform::IDENTITY, from, point);
            for map in maps() {
                assert_near(seen_coordinates(shape.clone(), &map, map.point(from), map.point(point)), plain);
            }
        }
    }

    #[test]
    fn images_on_discs_stand_upright_as_on_planes() {
        // The directions toward the viewer, to the right and up.
        for (normal, right, up) in [
            (DVec3::NEG_Z, DVec3::NEG_X, DVec3::Y),
            (DVec3::Z, DVec3::X, DVec3::Y),
            (DVec3::X, DVec3::NEG_Z, DVec3::Y),
            (DVec3::Y, DVec3::X, DVec3::NEG_Z),
            (DVec3::new(0.0, 0.6, -0.8), DVec3::NEG_X, DVec3::new(0.0, 0.8, 0.6)),
        ] {
            let disc = || Shape::Disc(Disc::new(DVec3::ZERO, normal, 1.0, None).expect("it has a radius"));
            let point = 0.4 * right - 0.6 * up;
            assert_near(seen_coordinates(disc(), &Transform::IDENTITY, normal + point, point), [0.7, 0.2]);
        }
    }

    #[test]
    fn images_on_a_cube_stand_upright_seen_from_outside() {
        let cube = || Shape::Cube(Cube::new(DVec3::ZERO, DVec3::splat(2.0)));
        // The directions outward, to the right and up, as seen from outside.
        let faces = [
            (DVec3::Z, DVec3::X, DVec3::Y),
            (-DVec3::Z, -DVec3::X, DVec3::Y),
            (DVec3::X, -DVec3::Z, DVec3::Y),
            (-DVec3::X, DVec3::Z, DVec3::Y),
            (DVec3::Y, DVec3::X, -DVec3::Z),
            (-DVec3::Y, DVec3::X, DVec3::Z),
        ];
        for (outward, right, up) in faces {
            let point = outward + 0.4 * right - 0.6 * up;
            assert_near(seen_coordinates(cube(), &Transform::IDENTITY, 2.0 * outward + point, point), [0.7, 0.2]);
        }
    }

    #[test]
    fn a_sphere_shows_z_in_the_middle_and_x_on_the_right() {
        let at = |direction: DVec3| {
            let sphere = Shape::Sphere(Sphere::new(DVec3::new(1.0, 2.0, 3.0), 0.5));
            let center = DVec3::new(1.0, 2.0, 3.0);
            seen_coordinates(sphere, &Transform::IDENTITY, center + 4.0 * direction, center)
        };
        assert_near(at(DVec3::Z), [0.5, 0.5]);
        assert_near(at(DVec3::X), [0.75, 0.5]);
        assert_near(at(-DVec3::X), [0.25, 0.5]);
        assert_near([at(DVec3::Y)[1], at(-DVec3::Y)[1]], [1.0, 0.0]);
    }

    #[test]
    fn a_plane_counts_scene_units_to_the_right_and_up() {
        let at = |normal: DVec3, point: DVec3| {
            let plane = Shape::Plane(Plane::new(DVec3::ZERO, normal));
            seen_coordinates(plane, &Transform::IDENTITY, point + normal, point)
        };
        assert_near(at(DVec3::Y, DVec3::new(3.0, 0.0, 5.0)), [3.0, -5.0]);
        assert_near(at(DVec3::Z, DVec3::new(3.0, 5.0, 0.0)), [3.0, 5.0]);
        assert_near(at(-DVec3::Z, DVec3::new(3.0, 5.0, 0.0)), [-3.0, 5.0]);
        assert_near(at(DVec3::X, DVec3::new(0.0, 5.0, 3.0)), [-3.0, 5.0]);
    }

    /// Returns a square whose second triangle shows the image mirrored.
    fn mirrored_mesh() -> Shape {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.2, 1.0, 0.1), DVec3::Y, DVec3::new(1.2, 1.0, 0.1)];
        let faces = vec![[0, 1, 2], [0, 4, 3]];
        let coordinates = vec![[0.5, 0.25], [1.0, 0.5], [0.75, 1.5], [1.0, 0.125], [1.5, 0.5]];
        let mesh = Mesh::new(Vertices::Double(points), faces).unwrap();
        Shape::Mesh(mesh.with(Attributes { coordinates, ..Default::default() }).into())
    }

    /// Steps along a surface change its coordinates as the tangents predict, under every transform.
    #[test]
    fn tangents_are_the_derivatives_of_points_by_coordinates() {
        let mut cases = shapes();
        for outward in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z] {
            let cube = Cube::new(DVec3::ZERO, DVec3::splat(2.0));
            cases.push((Shape::Cube(cube), outward + outward.any_orthonormal_vector() * 0.3));
        }
        for (shape, place) in cases {
            for map in maps() {
                let coordinates = Coordinates::new(&shape, &map).unwrap();
                for placed in [shape.transformed(&map), shape.copied(&map)] {
                    check(&placed, &coordinates, map.point(place), map.normal(outward(&shape, place)));
                }
            }
        }
    }

    fn outward(shape: &Shape, place: DVec3) -> DVec3 {
        match shape {
            Shape::Sphere(_) => (place - DVec3::new(0.0, 0.5, 0.0)).normalize(),
            Shape::Plane(_) => DVec3::new(0.0, 1.0, 3.0).normalize(),
            Shape::Cube(_) => place.to_array().map(f64::trunc).into(),
            _ => DVec3::new(0.0, 0.0, 1.0),
        }
    }

    fn check(shape: &Shape, coordinates: &Coordinates, place: DVec3, outward: DVec3) {
        let see = |place: DVec3| {
            let ray = Ray { origin: place + outward, direction: -outward };
            let intersection = shape.intersect(&ray, f64::INFINITY).expect("the ray meets the shape");
            let point = shape.point(&ray, &intersection);
            (intersection, point, coordinates.at(shape, &intersection, point.position))
        };
        let (intersection, point, [u, v]) = see(place);
        let [along_u, along_v] = coordinates.tangents(shape, &intersection, &point).expect("it has coordinates");
        assert!(along_u.dot(point.normal).abs() <= 1e-12 * along_u.length(), "{shape:?}: out of the surface");
        const STEP: f64 = 1e-6;
        for offset in [outward.any_orthonormal_vector(), outward.cross(outward.any_orthonormal_vector())] {
            let [(_, ahead, [u1, v1]), (_, behind, [u2, v2])] = [STEP, -STEP].map(|step| see(place + offset * step));
            let moved = ahead.position - behind.position;
            let expected = along_u * (u1 - u2) + along_v * (v1 - v2);
            // The remaining error is of third order in the step, plus roundings of positions and coordinates: 1e-15
            // times tangents up to 40 long. A wrong tangent gives an error as large as the step.
            assert!((moved - expected).length() < 1e-12, "{shape:?} at {u} {v}: {moved}, not {expected}");
        }
    }
}
