use super::mesh::SMALL_MESH;
use super::packed_triangles::PackedTriangles;
use super::{Intersection, Shape, Triangle, Vertices};
use crate::math::{DVec3, Ray};

/// The triangles of several small shapes in one tree, through which a ray goes only once.
#[derive(Clone, Debug)]
pub struct Pool {
    packed: PackedTriangles,
    /// Index of the shape, and of the triangle in the shape.
    owners: Vec<[u32; 2]>,
}

impl Pool {
    /// Returns whether a shape may go into a pool. Larger meshes are better left alone.
    pub fn takes(shape: &Shape) -> bool {
        match shape {
            Shape::Triangle(_) => true,
            Shape::Mesh(mesh) => mesh.count() <= SMALL_MESH,
            _ => false,
        }
    }

    /// Creates the pool of the triangles of those shapes that it takes. The shapes come with their numbers, in
    /// ascending order.
    pub fn new<'a>(shapes: impl Iterator<Item = (u32, &'a Shape)>) -> Self {
        let (mut points, mut owners) = (Vec::<DVec3>::new(), Vec::new());
        for (number, shape) in shapes {
            let mut add = |triangle: &Triangle, part: u32| {
                points.extend(triangle.points);
                owners.push([number, part]);
            };
            match shape {
                Shape::Triangle(triangle) => add(triangle, 0),
                Shape::Mesh(mesh) if Self::takes(shape) => {
                    (0..mesh.count()).for_each(|part| add(&mesh.triangle(part), part));
                }
                _ => {}
            }
        }
        let triangles: Vec<[u32; 3]> = (0..owners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { packed: PackedTriangles::new(&Vertices::Double(points), &triangles), owners }
    }

    /// Returns the nearest crossing with 0 < t <= `t_max` of a shape for which `accept` is true, with the shape's
    /// number. Of equally near crossings, it is that of the lowest number. `from` is the triangle that the ray leaves,
    /// as a shape and a part.
    #[inline]
    pub fn nearest(
        &self,
        ray: &Ray,
        t_max: f64,
        from: Option<[u32; 2]>,
        accept: impl Fn(u32) -> bool,
    ) -> Option<(u32, Intersection)> {
        let owner = |item: u32| self.owners[item as usize];
        let starts_on = |item| from == Some(owner(item));
        let intersection = self.packed.nearest(ray, t_max, starts_on, |item| accept(owner(item)[0]))?;
        let [number, part] = owner(intersection.part);
        Some((number, Intersection { part, ..intersection }))
    }

    /// Returns whether there is a crossing with 0 < t <= `t_max` for which `accept` is true, given the shape's number
    /// and part, and t.
    #[inline]
    pub fn any(&self, ray: &Ray, t_max: f64, from: Option<[u32; 2]>, accept: impl Fn([u32; 2], f64) -> bool) -> bool {
        let owner = |item: u32| self.owners[item as usize];
        let starts_on = |item| from == Some(owner(item));
        self.packed.any(ray, t_max, starts_on, |item, t| accept(owner(item), t))
    }
}
