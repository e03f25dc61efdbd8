//! Where the points of shapes lie in images on them.

use std::f64::consts::{PI, TAU};

use super::{Crossing, Shape};
use crate::math::{DMat3, DVec3, Transform};

/// The coordinates (u, v) of the points of a shape, by which images lie on it; a transform carries them along.
///
/// - quad: 0 to 1 along its u and its v; disc: so on the square around it;
/// - triangle: (0, 0), (1, 0), (0, 1) at its points;
/// - cube: 0 to 1 on each face, seen upright from outside; on the top face v runs to -z, on the bottom face to +z;
/// - mesh: as its file says;
/// - sphere: longitude and latitude, seen from outside, +z in the middle, +x at u = 3/4, +y at v = 1;
/// - plane: scene units from its `point`, u horizontal and v up; on a horizontal one u = +x, so that v = -z on a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coordinates {
    /// A quad or a disc.
    Square,
    /// A triangle, and whether its last two points changed places.
    Triangle {
        /// By a mirroring transform.
        swapped: bool,
    },
    /// A cube.
    Cube,
    /// A mesh, or an instance of one.
    Mesh,
    /// A sphere or an ellipsoid.
    Sphere {
        /// Its center in the world.
        center: DVec3,
        /// From the world's directions to its own.
        inverse: DMat3,
    },
    /// A plane.
    Plane {
        /// Where u = v = 0.
        origin: DVec3,
        /// What to multiply a way from there by to have u.
        u: DVec3,
        /// The same for v.
        v: DVec3,
    },
}

impl Shape {
    /// The texture coordinates of a mesh at a crossing; (0, 0) where there are none.
    fn mesh_coordinates(&self, crossing: &Crossing) -> [f64; 2] {
        let found = match self {
            Self::Mesh(mesh) => mesh.coordinates(crossing.part, crossing.uv),
            Self::Instance(instance) => instance.mesh().coordinates(crossing.part, crossing.uv),
            _ => None,
        };
        found.unwrap_or_default()
    }
}

impl Coordinates {
    /// Of a shape before a transform; none if the shape has no coordinates.
    pub fn new(shape: &Shape, map: &Transform) -> Option<Self> {
        let inverse = map.inverse_linear();
        Some(match shape {
            Shape::Quad(_) | Shape::Disc(_) => Self::Square,
            Shape::Triangle(_) => Self::Triangle { swapped: map.mirrors() },
            Shape::Cube(_) => Self::Cube,
            Shape::Sphere(sphere) => Self::Sphere { center: map.point(sphere.center()), inverse },
            Shape::Plane(plane) => {
                let normal = plane.normal();
                let u = DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X);
                let [u, v] = [u, normal.cross(u)].map(|axis| inverse.transpose() * axis);
                Self::Plane { origin: map.point(plane.origin()), u, v }
            }
            Shape::Mesh(mesh) if mesh.has_coordinates() => Self::Mesh,
            Shape::Ellipsoid(_) | Shape::Mesh(_) | Shape::Instance(_) => return None,
        })
    }

    /// At a crossing of the shape, whose point in the world is known.
    pub fn at(&self, shape: &Shape, crossing: &Crossing, position: DVec3) -> [f64; 2] {
        let [a, b] = crossing.uv;
        let unit = |[x, y]: [f64; 2]| [0.5 + 0.5 * x, 0.5 + 0.5 * y];
        match self {
            Self::Square => unit([a, b]),
            Self::Mesh => shape.mesh_coordinates(crossing),
            Self::Triangle { swapped } => {
                if *swapped {
                    [b, a]
                } else {
                    [a, b]
                }
            }
            // Faces -x, +x, -y, +y, -z, +z, whose own coordinates run along the next two axes.
            Self::Cube => unit(match crossing.part {
                0 => [b, a],
                1 => [-b, a],
                2 => [b, a],
                3 => [b, -a],
                4 => [-a, b],
                _ => [a, b],
            }),
            Self::Sphere { center, inverse } => {
                let DVec3 { x, y, z } = *inverse * (position - *center);
                [0.5 + libm::atan2(x, z) / TAU, 1.0 - libm::atan2((x * x + z * z).sqrt(), y) / PI]
            }
            Self::Plane { origin, u, v } => {
                let way = position - *origin;
                [way.dot(*u), way.dot(*v)]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Ray;
    use crate::shape::{Cube, Disc, Plane, Quad, Sphere, Triangle};

    /// Coordinates of the point that a ray toward -`from` first meets.
    fn seen(shape: Shape, map: &Transform, from: DVec3, toward: DVec3) -> [f64; 2] {
        let coordinates = Coordinates::new(&shape, map).expect("the shape has coordinates");
        let shape = shape.transformed(map);
        let ray = Ray { origin: from, direction: (toward - from).normalize() };
        let crossing = shape.intersect(&ray, f64::INFINITY).expect("the ray meets the shape");
        coordinates.at(&shape, &crossing, shape.point(&ray, &crossing).position)
    }

    fn assert_near(found: [f64; 2], expected: [f64; 2]) {
        let near = (0..2).all(|i| (found[i] - expected[i]).abs() < 1e-12);
        assert!(near, "{found:?} is not {expected:?}");
    }

    /// Whatever moves, turns, stretches or mirrors a shape carries its coordinates along.
    #[test]
    fn a_point_keeps_its_coordinates_under_every_transform() {
        let shapes = [
            (Shape::Quad(Quad::new(DVec3::new(1.0, 0.5, 0.0), DVec3::X * 2.0, DVec3::Y)), DVec3::new(0.3, 0.9, 0.0)),
            (Shape::Disc(Disc::new(DVec3::ZERO, DVec3::Z, 2.0, Some(DVec3::X)).unwrap()), DVec3::new(0.3, -0.7, 0.0)),
            (
                Shape::Triangle(Triangle::new([DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.5)])),
                DVec3::new(0.6, 0.8, 0.2),
            ),
            (Shape::Cube(Cube::new(DVec3::new(0.1, 0.2, 0.3), DVec3::splat(2.0))), DVec3::new(0.4, 0.1, 1.3)),
            (Shape::Sphere(Sphere::new(DVec3::new(0.0, 0.5, 0.0), 1.0)), DVec3::new(0.48, 1.1, 0.64)),
            (
                Shape::Plane(Plane::new(DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 3.0))),
                DVec3::new(5.0, 4.0, -1.0),
            ),
        ];
        let maps = [
            Transform::translate(DVec3::new(3.0, -2.0, 1.0)),
            Transform::rotate(DVec3::new(1.0, 2.0, -0.5), 77.0).then(&Transform::translate(DVec3::X)),
            Transform::scale(DVec3::new(0.5, 3.0, 1.25)).then(&Transform::rotate(DVec3::new(0.3, 1.0, 0.0), 200.0)),
            Transform::scale(DVec3::new(-1.0, 1.0, 1.0)),
        ];
        for (shape, point) in shapes {
            let from = point + DVec3::new(0.1, 0.2, 2.0);
            let plain = seen(shape.clone(), &Transform::IDENTITY, from, point);
            for map in maps {
                assert_near(seen(shape.clone(), &map, map.point(from), map.point(point)), plain);
            }
        }
    }

    #[test]
    fn images_on_a_cube_stand_upright_seen_from_outside() {
        let cube = || Shape::Cube(Cube::new(DVec3::ZERO, DVec3::splat(2.0)));
        // Outward, to the right and up as one sees the face.
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
            assert_near(seen(cube(), &Transform::IDENTITY, 2.0 * outward + point, point), [0.7, 0.2]);
        }
    }

    #[test]
    fn a_sphere_shows_z_in_the_middle_and_x_on_the_right() {
        let at = |direction: DVec3| {
            let sphere = Shape::Sphere(Sphere::new(DVec3::new(1.0, 2.0, 3.0), 0.5));
            let center = DVec3::new(1.0, 2.0, 3.0);
            seen(sphere, &Transform::IDENTITY, center + 4.0 * direction, center)
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
            seen(plane, &Transform::IDENTITY, point + normal, point)
        };
        assert_near(at(DVec3::Y, DVec3::new(3.0, 0.0, 5.0)), [3.0, -5.0]);
        assert_near(at(DVec3::Z, DVec3::new(3.0, 5.0, 0.0)), [3.0, 5.0]);
        assert_near(at(-DVec3::Z, DVec3::new(3.0, 5.0, 0.0)), [-3.0, 5.0]);
        assert_near(at(DVec3::X, DVec3::new(0.0, 5.0, 3.0)), [-3.0, 5.0]);
    }
}
