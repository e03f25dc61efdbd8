//! Closed bodies to trace rays against.

use std::f64::consts::{PI, TAU};

use abbe::math::DVec3;
use abbe::shape::{Mesh, Shape, Vertices};

const POINTS_PER_RING: u32 = 24;
const RINGS: u32 = 11;

/// Returns the points and outward faces of a closed, convex ball of 528 triangles about the origin, radius 1.
pub fn ball() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points = vec![DVec3::Z, -DVec3::Z];
    for ring in 1..=RINGS {
        for step in 0..POINTS_PER_RING {
            let polar = PI * f64::from(ring) / f64::from(RINGS + 1);
            // Rotated a little, so that only the poles lie in a coordinate plane.
            let azimuth = TAU * (f64::from(step) + 0.37) / f64::from(POINTS_PER_RING);
            let (sin, cos) = libm::sincos(polar);
            points.push(DVec3::new(sin * libm::cos(azimuth), sin * libm::sin(azimuth), cos));
        }
    }
    (points, ball_faces(POINTS_PER_RING, RINGS))
}

/// Returns the faces of a ball with two poles and `rings` rings of `per_ring` points between them, stored ring by ring.
pub fn ball_faces(per_ring: u32, rings: u32) -> Vec<[u32; 3]> {
    let vertex = |ring: u32, step: u32| 2 + (ring - 1) * per_ring + step % per_ring;
    let mut faces = Vec::new();
    for step in 0..per_ring {
        faces.push([0, vertex(1, step), vertex(1, step + 1)]);
        for ring in 1..rings {
            faces.push([vertex(ring, step), vertex(ring + 1, step), vertex(ring + 1, step + 1)]);
            faces.push([vertex(ring, step), vertex(ring + 1, step + 1), vertex(ring, step + 1)]);
        }
        faces.push([1, vertex(rings, step + 1), vertex(rings, step)]);
    }
    faces
}

/// Builds a mesh and panics if it is not closed.
pub fn closed_mesh(points: Vec<DVec3>, faces: Vec<[u32; 3]>) -> Shape {
    let mesh = Mesh::new(Vertices::Double(points), faces).expect("the faces have areas");
    assert_eq!((mesh.degenerate(), mesh.open_edges()), (0, 0));
    Shape::Mesh(mesh.into())
}
