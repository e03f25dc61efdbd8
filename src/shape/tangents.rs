//! How the points of shapes move with their coordinates.

use std::f64::consts::{PI, TAU};

use super::{Coordinates, Crossing, Shape, SurfacePoint};
use crate::math::DVec3;

impl Coordinates {
    /// The derivatives of a point of the shape by its coordinates u and v, in the world; none where a mesh has no
    /// coordinates or a triangle of it lies on a line in the image.
    ///
    /// At the poles of a sphere, where u turns without moving the point, the first is 0.
    pub fn tangents(&self, shape: &Shape, crossing: &Crossing, point: &SurfacePoint) -> Option<[DVec3; 2]> {
        match self {
            Self::Square => {
                let plane = match shape {
                    Shape::Quad(quad) => quad.plane(),
                    Shape::Disc(disc) => disc.plane(),
                    _ => return None,
                };
                Some([plane.u * 2.0, plane.v * 2.0])
            }
            Self::Triangle { swapped } => {
                let Shape::Triangle(triangle) = shape else { return None };
                let [p1, p2, p3] = triangle.points();
                Some(if *swapped { [p3 - p1, p2 - p1] } else { [p2 - p1, p3 - p1] })
            }
            Self::Cube => {
                let Shape::Cube(cube) = shape else { return None };
                let plane = cube.face(crossing.part);
                let [a, b] = [plane.u * 2.0, plane.v * 2.0];
                // As the coordinates of the faces are turned.
                Some(match crossing.part {
                    0 | 2 => [b, a],
                    1 => [-b, a],
                    3 => [b, -a],
                    4 => [-a, b],
                    _ => [a, b],
                })
            }
            Self::Mesh => match shape {
                Shape::Mesh(mesh) => mesh.tangents(crossing.part),
                Shape::Instance(instance) => instance.tangents(crossing.part),
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
                // The directions in the plane in which one coordinate rests.
                let [along_u, along_v] = [v.cross(point.normal), point.normal.cross(*u)];
                Some([along_u / along_u.dot(*u), along_v / along_v.dot(*v)])
            }
        }
    }
}

/// The derivatives over a triangle by coordinates given at its corners; none if those lie on a line.
pub(super) fn over_triangle([p1, p2, p3]: [DVec3; 3], at: [[f32; 2]; 3]) -> Option<[DVec3; 2]> {
    let [a, b, c] = at.map(|uv| uv.map(f64::from));
    let [along, across] = [p2 - p1, p3 - p1];
    let [[u1, v1], [u2, v2]] = [b, c].map(|uv| [uv[0] - a[0], uv[1] - a[1]]);
    let area = u1 * v2 - v1 * u2;
    let tangents = [(along * v2 - across * v1) / area, (across * u1 - along * u2) / area];
    (area != 0.0 && tangents.iter().all(|tangent| tangent.is_finite())).then_some(tangents)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Ray, Transform};
    use crate::shape::{Attributes, Cube, Disc, Mesh, Plane, Quad, Sphere, Triangle, Vertices};

    /// A square whose second triangle shows the image in a mirror.
    fn mirrored_mesh() -> Shape {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.2, 1.0, 0.1), DVec3::Y, DVec3::new(1.2, 1.0, 0.1)];
        let faces = vec![[0, 1, 2], [0, 4, 3]];
        let coordinates = vec![[0.5, 0.25], [1.0, 0.5], [0.75, 1.5], [1.0, 0.125], [1.5, 0.5]];
        let (mesh, _) = Mesh::new(Vertices::Double(points), faces).unwrap();
        Shape::Mesh(mesh.with(Attributes { normals: Vec::new(), coordinates }).into())
    }

    /// Steps along a surface change its coordinates as the tangents say, under every transform.
    #[test]
    fn tangents_are_the_derivatives_of_points_by_coordinates() {
        let quad = Quad::new(DVec3::new(1.0, 0.5, 0.0), DVec3::new(2.0, 0.3, 0.0), DVec3::Y);
        let disc = Disc::new(DVec3::ZERO, DVec3::new(0.2, 0.0, 1.0), 2.0, Some(DVec3::X)).unwrap();
        let triangle = Triangle::new([DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 2.0, 0.5)]);
        let mut cases = vec![
            (Shape::Quad(quad), DVec3::new(0.3, 0.9, 0.0)),
            (Shape::Disc(disc), DVec3::new(0.3, -0.7, -0.06)),
            (Shape::Triangle(triangle), DVec3::new(0.6, 0.8, 0.2)),
            (Shape::Sphere(Sphere::new(DVec3::new(0.0, 0.5, 0.0), 1.0)), DVec3::new(0.48, 1.1, 0.64)),
            (Shape::Plane(Plane::new(DVec3::Y, DVec3::new(0.0, 1.0, 3.0))), DVec3::new(5.0, 4.0, -1.0)),
            (mirrored_mesh(), DVec3::new(0.9, 0.3, 0.03)),
            (mirrored_mesh(), DVec3::new(0.3, 0.7, 0.03)),
        ];
        for outward in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z] {
            let cube = Cube::new(DVec3::ZERO, DVec3::splat(2.0));
            cases.push((Shape::Cube(cube), outward + outward.any_orthonormal_vector() * 0.3));
        }
        let maps = [
            Transform::IDENTITY,
            Transform::rotate(DVec3::new(1.0, 2.0, -0.5), 77.0).then(&Transform::translate(DVec3::X)),
            Transform::scale(DVec3::new(0.5, 3.0, 1.25)).then(&Transform::rotate(DVec3::new(0.3, 1.0, 0.0), 200.0)),
            Transform::scale(DVec3::new(-1.0, 1.0, 1.5)),
        ];
        for (shape, place) in cases {
            for map in maps {
                let coordinates = Coordinates::new(&shape, &map).unwrap();
                for placed in [shape.clone().transformed(&map), shape.copied(&map)] {
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
            let crossing = shape.intersect(&ray, f64::INFINITY).expect("the ray meets the shape");
            let point = shape.point(&ray, &crossing);
            (crossing, point, coordinates.at(shape, &crossing, point.position))
        };
        let (crossing, point, [u, v]) = see(place);
        let [along_u, along_v] = coordinates.tangents(shape, &crossing, &point).expect("it has coordinates");
        assert!(along_u.dot(point.normal).abs() <= 1e-12 * along_u.length(), "{shape:?}: out of the surface");
        const STEP: f64 = 1e-6;
        for way in [outward.any_orthonormal_vector(), outward.cross(outward.any_orthonormal_vector())] {
            let [(_, ahead, [u1, v1]), (_, behind, [u2, v2])] = [STEP, -STEP].map(|step| see(place + way * step));
            let moved = ahead.position - behind.position;
            let expected = along_u * (u1 - u2) + along_v * (v1 - v2);
            // What is left is of third order in the step, beside roundings of places and coordinates: 1e-15 times tangents up
            // to 40 long. A wrong tangent is off by the step.
            assert!((moved - expected).length() < 1e-12, "{shape:?} at {u} {v}: {moved}, not {expected}");
        }
    }
}
