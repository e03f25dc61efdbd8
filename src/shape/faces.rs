//! Triangulation of mesh faces with any number of corners.

use std::ops::Range;

use super::Vertices;
use super::ear_clipping::{MAX_CORNERS, clip_ears};
use crate::math::{DVec2, DVec3};

/// The triangles of faces. Each face is a fan about its first corner until it is cut.
#[derive(Clone, Debug, Default)]
pub struct Faces {
    fans: Vec<[u32; 3]>,
    /// Ranges of the triangles of each face that has several.
    fan_ranges: Vec<Range<usize>>,
}

impl Faces {
    /// Adds a face. With fewer than 3 corners it has no triangle.
    pub fn push(&mut self, corners: &[u32]) {
        let first = self.fans.len();
        let rest = corners.get(1..).unwrap_or_default();
        self.fans.extend(rest.windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        if self.fans.len() > first + 1 {
            self.fan_ranges.push(first..self.fans.len());
        }
    }

    /// Returns the triangles. A fan about one corner is right for a convex face. Fans of other faces would overlap, so
    /// these faces are cut again. So are faces with corners on their sides, if that leaves fewer triangles without
    /// area: such triangles are dropped later, and with them what their corners carry. Faces whose sides cross stay as
    /// they are, and so do faces whose corners are not finite vertices.
    ///
    /// # Errors
    /// A sentence about a face that has too many corners.
    pub fn triangles(mut self, vertices: &Vertices) -> Result<Vec<[u32; 3]>, String> {
        for place in self.fan_ranges {
            let fan = &mut self.fans[place];
            if fan.iter().flatten().any(|&corner| corner as usize >= vertices.count()) {
                continue;
            }
            let Some(polygon) = FacePlane::new(fan, vertices) else { continue };
            let (overlaps, flat) = (polygon.has_flipped(fan), polygon.count_flat(fan));
            if !overlaps && flat == 0 {
                continue;
            }
            let corners: Vec<u32> = fan[0][..2].iter().copied().chain(fan.iter().map(|face| face[2])).collect();
            if overlaps && corners.len() > MAX_CORNERS {
                let count = corners.len();
                return Err(format!("a face that is not convex has {count} corners, more than {MAX_CORNERS}"));
            }
            let points: Vec<DVec3> = corners.iter().map(|&corner| vertices.at(corner)).collect();
            let Some(cut) = clip_ears(&project_along(polygon.normal, &points), polygon.error) else { continue };
            let cut: Vec<[u32; 3]> = cut.into_iter().map(|face| face.map(|corner| corners[corner])).collect();
            if overlaps || polygon.count_flat(&cut) < flat {
                fan.copy_from_slice(&cut);
            }
        }
        Ok(self.fans)
    }
}

/// The plane of a face, given by its triangles.
struct FacePlane<'v> {
    vertices: &'v Vertices,
    normal: DVec3,
    error: f64,
}

impl<'v> FacePlane<'v> {
    /// Returns `None` if the face has no area.
    ///
    /// The normals of the triangles add up to that of Newell's method (Sutherland, Sproull & Schumacker 1974, *A
    /// Characterization of Ten Hidden-Surface Algorithms*), which accounts for the whole polygon.
    fn new(fan: &[[u32; 3]], vertices: &'v Vertices) -> Option<Self> {
        let points = || fan.iter().flatten().map(|&corner| vertices.at(corner));
        let mut polygon = Self { vertices, normal: DVec3::ZERO, error: error(points(), vertices) };
        polygon.normal = fan.iter().map(|face| polygon.area_normal(face).0).sum::<DVec3>().try_normalize()?;
        Some(polygon)
    }

    /// Returns the normal of a triangle, with twice its area as length, and the length that rounding makes of 0.
    fn area_normal(&self, face: &[u32; 3]) -> (DVec3, f64) {
        let [a, b, c] = face.map(|corner| self.vertices.at(corner));
        let rounding = self.error * ((b - a).length() + (c - b).length() + (a - c).length());
        ((b - a).cross(c - a), rounding)
    }

    /// Returns whether one of the triangles faces the other way.
    fn has_flipped(&self, faces: &[[u32; 3]]) -> bool {
        faces.iter().map(|face| self.area_normal(face)).any(|(normal, rounding)| normal.dot(self.normal) < -rounding)
    }

    /// Counts the triangles that have no area.
    fn count_flat(&self, faces: &[[u32; 3]]) -> usize {
        faces
            .iter()
            .map(|face| self.area_normal(face))
            .filter(|(normal, rounding)| normal.length() <= *rounding)
            .count()
    }
}

/// Returns how far points may be off because of the precision of their coordinates, including the rounding in what is
/// computed from them.
fn error(points: impl Iterator<Item = DVec3>, vertices: &Vertices) -> f64 {
    let epsilon = match vertices {
        Vertices::Single(_) => f64::from(f32::EPSILON),
        Vertices::Double(_) => f64::EPSILON,
    };
    2.0 * epsilon * points.map(|point| point.abs().max_element()).fold(0.0, f64::max)
}

/// Projects points along a direction, counterclockwise about it. Points in a plane across an axis keep their
/// coordinates to the last bit.
fn project_along(normal: DVec3, points: &[DVec3]) -> Vec<DVec2> {
    let axis = normal.abs().max_position();
    let (mut across, mut up) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (across, up) = (up, across);
    }
    let [right, high] = [across, up].map(|other| normal[other] / normal[axis]);
    let project = |point: &DVec3| DVec2::new(point[across] - point[axis] * right, point[up] - point[axis] * high);
    points.iter().map(project).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the triangles of one face, and the ratio of their area to that of the face.
    fn cut(points: &[[f64; 3]], single: bool) -> (Vec<[u32; 3]>, f64) {
        let vertices = match single {
            true => Vertices::Single(points.iter().map(|point| point.map(|x| x as f32)).collect()),
            false => Vertices::Double(points.iter().map(|&point| point.into()).collect()),
        };
        let mut faces = Faces::default();
        faces.push(&(0..points.len() as u32).collect::<Vec<u32>>());
        let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a);
        let fan = faces.fans.iter().map(|face| normal(face.map(|corner| vertices.at(corner)))).sum::<DVec3>();
        let triangles = faces.triangles(&vertices).expect("few corners");
        let sum: f64 = triangles.iter().map(|face| normal(face.map(|corner| vertices.at(corner))).length()).sum();
        (triangles, sum / fan.length())
    }

    fn fan(count: u32) -> Vec<[u32; 3]> {
        (2..count).map(|corner| [0, corner - 1, corner]).collect()
    }

    #[test]
    fn faces_that_are_not_convex_have_their_area_in_every_plane() {
        let corner = [[1.0, -1.0], [1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]];
        let dart = [[2.0, 2.0], [0.0, 0.5], [-2.0, 2.0], [0.0, 0.0]];
        for outline in [&corner[..], &dart] {
            for [u, v] in [
                [DVec3::X, DVec3::Y],
                [DVec3::Y, DVec3::X],
                [DVec3::Z, DVec3::X],
                [DVec3::Y, DVec3::Z],
                [DVec3::Z, DVec3::Y],
                [DVec3::new(1.0, 0.2, -0.3), DVec3::new(0.1, -2.0, 0.7)],
            ] {
                for (place, size) in [(0.0, 1.0), (100.0, 1.0), (0.0, 1e-20), (0.0, 1e18)] {
                    let point = |&[a, b]: &[f64; 2]| ((DVec3::splat(place) + u * a + v * b) * size).to_array();
                    let points: Vec<[f64; 3]> = outline.iter().map(point).collect();
                    for single in [true, false] {
                        let (triangles, share) = cut(&points, single);
                        assert_ne!(triangles, fan(points.len() as u32));
                        assert!((share - 1.0).abs() < 1e-6, "{points:?}: {share}");
                    }
                }
            }
        }
    }

    #[test]
    fn convex_faces_share_their_first_corner_unless_corners_lie_on_their_sides() {
        let normal = DVec3::new(0.3, -0.5, 0.8).normalize();
        let (u, v) = normal.any_orthonormal_pair();
        for count in 4..40 {
            for single in [true, false] {
                let around = |i: u32| DVec2::from_angle(f64::from(i) / f64::from(count) * std::f64::consts::TAU);
                let point = |corner: DVec2| (DVec3::ONE * 10.0 + u * corner.x + v * corner.y).to_array();
                let points: Vec<[f64; 3]> = (0..count).map(|i| point(around(i))).collect();
                assert_eq!(cut(&points, single).0, fan(count));
                // Every other corner lies on a side, but for the rounding of its coordinates.
                let corners = (0..count).flat_map(|i| [around(i), (around(i) + around(i + 1)) / 2.0]);
                let mut points: Vec<[f64; 3]> = corners.map(point).collect();
                for _ in 0..2 {
                    let (triangles, share) = cut(&points, single);
                    let area = |face: &[u32; 3]| {
                        let [a, b, c] = face.map(|corner| DVec3::from(points[corner as usize]));
                        (b - a).cross(c - a).length()
                    };
                    assert!((share - 1.0).abs() < 1e-6 && triangles.iter().all(|face| area(face) > 1e-6), "{count}");
                    points.rotate_left(1);
                }
            }
        }
    }

    #[test]
    fn faces_that_no_cut_makes_right_stay_as_they_are() {
        let bow = [[0.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let nowhere = [[0.0, 0.0, 0.0], [1.0, f64::NAN, 0.0], [f64::INFINITY, 0.0, 0.0], [0.0, 2.0, 0.0]];
        for points in [bow, nowhere, [[1.0; 3]; 4], [[1e300, -1e300, 0.0]; 4]] {
            for single in [true, false] {
                assert_eq!(cut(&points, single).0, fan(4));
            }
        }
        let mut faces = Faces::default();
        [&[][..], &[0], &[0, 1], &[0, 1, 2, 9], &[2, u32::MAX, 1, 0]].into_iter().for_each(|face| faces.push(face));
        let triangles = faces.triangles(&Vertices::Double(vec![DVec3::X, DVec3::Y, DVec3::Z]));
        assert_eq!(triangles, Ok(vec![[0, 1, 2], [0, 2, 9], [2, u32::MAX, 1], [2, 1, 0]]));
    }

    #[test]
    fn a_face_with_countless_corners_is_cut_only_where_it_is_convex() {
        let count = MAX_CORNERS as u32 + 1;
        let around = |i: u32| DVec2::from_angle(f64::from(i) / f64::from(count) * std::f64::consts::TAU).extend(0.0);
        let mut points: Vec<[f64; 3]> = (0..count).map(|i| around(i).to_array()).collect();
        assert_eq!(cut(&points, false).0, fan(count));
        points[7] = [0.0, -0.5, 0.0];
        let mut faces = Faces::default();
        faces.push(&(0..count).collect::<Vec<u32>>());
        let message = faces.triangles(&Vertices::Double(points.into_iter().map(DVec3::from).collect()));
        assert_eq!(message, Err("a face that is not convex has 4097 corners, more than 4096".into()));
    }
}
