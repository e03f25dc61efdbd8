//! Triangles under a tree of boxes, in the order of its leaves, tested against a ray four at a time.

use super::bvh::{Crossings, GROUP, Line, Number, VectorVisitor, prefetch};
use super::triangle::ShearedRay;
use super::{Bvh, Intersection, Vectors, Vertices, fragments};
use crate::math::{DVec3, Ray};

/// A tree over triangles, with copies of all their corners.
#[derive(Clone, Debug)]
pub(super) struct PackedTriangles {
    bvh: Bvh,
    blocks: Blocks,
}

/// The corners in the precision of the vertices.
#[derive(Clone, Debug)]
enum Blocks {
    Single(Vec<Block<f32>>),
    Double(Vec<Block<f64>>),
}

/// Four triangles side by side: four numbers for each corner and coordinate. Absent triangles have NaN.
#[derive(Clone, Debug)]
struct Block<T>([[[T; GROUP]; 3]; 3]);

impl PackedTriangles {
    /// Builds the tree over triangles whose corners index the vertices.
    pub fn new(vertices: &Vertices, triangles: &[[u32; 3]]) -> Self {
        let corners = |index: u32| triangles[index as usize].map(|corner| vertices.at(corner));
        Self::with_bvh(fragments::build_tree(triangles.len() as u32, corners), vertices, triangles)
    }

    fn with_bvh(bvh: Bvh, vertices: &Vertices, triangles: &[[u32; 3]]) -> Self {
        let blocks = match vertices {
            Vertices::Single(points) => Blocks::Single(blocks(points, triangles, bvh.items(), f32::NAN)),
            Vertices::Double(points) => Blocks::Double(blocks(points, triangles, bvh.items(), f64::NAN)),
        };
        Self { bvh, blocks }
    }

    /// Returns the nearest crossing with 0 < t <= `t_max` of a triangle for which `accept` is true. Of equally near
    /// crossings, it is that of the triangle listed first.
    ///
    /// `starts_on` tells which triangle the ray leaves. The ray was offset by that triangle's error bound, so that its
    /// origin lies on the side to which it leaves, and the outcome of an exact test is known.
    #[inline]
    pub fn nearest(
        &self,
        ray: &Ray,
        t_max: f64,
        starts_on: impl Fn(u32) -> bool,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Intersection> {
        let mut nearest: Option<Intersection> = None;
        self.search::<true>(ray, t_max, starts_on, |found, t_max| {
            if !accept(found.part) {
                return Some(t_max);
            }
            if nearest.is_none_or(|nearest| found.t < nearest.t || found.part < nearest.part) {
                nearest = Some(found);
            }
            Some(found.t)
        });
        nearest
    }

    /// Returns whether there is a crossing with 0 < t <= `t_max` for which `accept` is true, given its triangle and t.
    #[inline]
    pub fn any(
        &self,
        ray: &Ray,
        t_max: f64,
        starts_on: impl Fn(u32) -> bool,
        accept: impl Fn(u32, f64) -> bool,
    ) -> bool {
        let mut is_found = false;
        self.search::<false>(ray, t_max, starts_on, |found, t_max| {
            is_found = accept(found.part, found.t);
            (!is_found).then_some(t_max)
        });
        is_found
    }

    /// Calls `take` with crossings, in nearer boxes first if `ORDERED`. `take` returns how far to search from then on,
    /// or `None` to end the search.
    #[inline]
    fn search<const ORDERED: bool>(
        &self,
        ray: &Ray,
        t_max: f64,
        starts_on: impl Fn(u32) -> bool,
        take: impl FnMut(Intersection, f64) -> Option<f64>,
    ) {
        let (sheared, items) = (ShearedRay::new(ray), self.bvh.items());
        let line = sheared.line();
        match &self.blocks {
            Blocks::Single(blocks) => {
                let mut search = Search { blocks, items, line, sheared, starts_on, take };
                self.bvh.walk_with_vectors::<ORDERED>(ray, t_max, &mut search);
            }
            Blocks::Double(blocks) => {
                let mut search = Search { blocks, items, line, sheared, starts_on, take };
                self.bvh.walk_with_vectors::<ORDERED>(ray, t_max, &mut search);
            }
        }
    }
}

fn blocks<P: Copy + Into<[T; 3]>, T: Copy>(
    points: &[P],
    triangles: &[[u32; 3]],
    items: &[u32],
    absent: T,
) -> Vec<Block<T>> {
    let block = |items: &[u32]| {
        let mut block = Block([[[absent; GROUP]; 3]; 3]);
        for (lane, &item) in items.iter().enumerate().filter(|&(_, &item)| item != Bvh::NONE) {
            for (corner, &vertex) in triangles[item as usize].iter().enumerate() {
                let point: [T; 3] = points[vertex as usize].into();
                for (axis, &x) in point.iter().enumerate() {
                    block.0[corner][axis][lane] = x;
                }
            }
        }
        block
    };
    items.chunks_exact(GROUP).map(block).collect()
}

struct Search<'a, T, L, F> {
    blocks: &'a [Block<T>],
    items: &'a [u32],
    line: Line,
    sheared: ShearedRay,
    starts_on: L,
    take: F,
}

impl<T: Number, L: Fn(u32) -> bool, F: FnMut(Intersection, f64) -> Option<f64>> VectorVisitor for Search<'_, T, L, F> {
    #[inline(always)]
    fn visit(&mut self, vectors: impl Vectors, first: usize, groups: usize, mut t_max: f64) -> Option<f64> {
        for group in first..first + groups {
            let (block, items) = (&self.blocks[group], &self.items[group * GROUP..][..GROUP]);
            let Some(mut crossings) = block.meet(vectors, &self.line, &self.sheared, t_max) else { continue };
            while let Some(lane) = pop_lane(&mut crossings.hits) {
                if crossings.t[lane] <= t_max {
                    t_max = (self.take)(Intersection { part: items[lane], ..crossing_of(&crossings, lane) }, t_max)?;
                }
            }
            while let Some(lane) = pop_lane(&mut crossings.unsure) {
                if !(self.starts_on)(items[lane])
                    && let Some(crossing) = block.intersect_exactly(lane, &self.sheared, t_max)
                {
                    t_max = (self.take)(Intersection { part: items[lane], ..crossing }, t_max)?;
                }
            }
        }
        Some(t_max)
    }

    #[inline(always)]
    fn prefetch(&self, group: usize) {
        prefetch(&self.blocks[group]);
    }
}

/// Removes the lowest of some lanes and returns it.
#[inline(always)]
fn pop_lane(lanes: &mut u32) -> Option<usize> {
    let lane = lanes.trailing_zeros() as usize;
    let is_there = *lanes != 0;
    *lanes &= lanes.wrapping_sub(1);
    is_there.then_some(lane & (GROUP - 1))
}

/// Returns the crossing with one of the triangles.
#[inline(always)]
fn crossing_of(intersections: &Crossings, lane: usize) -> Intersection {
    let Crossings { t, v, w, determinant, .. } = intersections;
    Intersection { t: t[lane], part: 0, uv: [v[lane] / determinant[lane], w[lane] / determinant[lane]] }
}

impl<T: Number> Block<T> {
    /// Returns the triangles that a ray meets with 0 < t <= `t_max`, edges and corners included.
    ///
    /// The edge functions are rounded as in `ShearedRay::intersect`. One that is not 0 has the right sign, because
    /// rounding keeps the order of products. So a triangle with edge functions of opposite signs is rejected there as
    /// well, and no other is rejected here. Cases for which that test needs more digits are left to it.
    #[inline(always)]
    fn meet(&self, vectors: impl Vectors, line: &Line, sheared: &ShearedRay, t_max: f64) -> Option<Crossings> {
        let [x, y, z] = sheared.order;
        let corners = self.0.each_ref().map(|corner| [&corner[x], &corner[y], &corner[z]]);
        vectors.meet(corners, line, t_max)
    }

    /// Computes the crossing with one of the triangles with 0 < t <= `t_max`, with more digits where needed.
    #[inline(never)]
    fn intersect_exactly(&self, lane: usize, sheared: &ShearedRay, t_max: f64) -> Option<Intersection> {
        let corner = |corner: &[[T; GROUP]; 3]| DVec3::from(corner.map(|x| x[lane].into()));
        sheared.intersect([corner(&self.0[0]), corner(&self.0[1]), corner(&self.0[2])], t_max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sample_sphere;
    use crate::shape::Triangle;

    /// Returns a linear congruential generator of numbers in [0, 1).
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 1u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    #[test]
    fn plain_and_wide_instructions_give_the_same_bits() {
        let mut number = numbers();
        // On a lattice, so that many rays meet edges, corners and several triangles at once.
        let mut coordinate = || ((number() * 16.0) as i32 - 8) as f32 * 0.25;
        let points: Vec<[f32; 3]> = (0..3000).map(|_| [(); 3].map(|()| coordinate())).collect();
        let mut faces: Vec<[u32; 3]> = (0..1000).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let corner = |corner: u32| DVec3::from(points[corner as usize].map(f64::from));
        faces.retain(|face| !Triangle::is_degenerate(face.map(corner)));
        let double = points.iter().map(|p| DVec3::from(p.map(f64::from))).collect();
        for vertices in [Vertices::Single(points.clone()), Vertices::Double(double)] {
            let bounds = faces.iter().map(|face| Triangle::new(face.map(corner)).bounds());
            let wide = PackedTriangles::with_bvh(Bvh::new::<GROUP>(bounds), &vertices, &faces);
            let plain = PackedTriangles { bvh: wide.bvh.clone().plain(), blocks: wide.blocks.clone() };
            let mut hits = 0;
            for i in 0..60_000 {
                let mut place = || ((number() * 16.0) as i32 - 8) as f64 * 0.25;
                let mut origin = DVec3::new(place(), place(), place());
                let direction = match i % 4 {
                    0 => sample_sphere([number(), number()]),
                    // Along an axis, with a 0 of either sign in the other components.
                    1 => DVec3::from([[0.0, -0.0, 1.0], [-1.0, 0.0, -0.0], [-0.0, 1.0, 0.0]][i / 4 % 3]),
                    2 => (DVec3::new(place(), place(), place()) - origin).normalize_or(DVec3::X),
                    // A component so small that its reciprocal does not fit into 32 bits.
                    _ => DVec3::new(1e-42 * (number() - 0.5), 1.0, 1e-300),
                };
                if i % 3 == 0 {
                    origin += sample_sphere([number(), number()]);
                }
                let ray = Ray { origin, direction };
                let t_max = if i % 5 == 0 { number() } else { f64::INFINITY };
                let found = wide.nearest(&ray, t_max, |_| false, |_| true);
                assert_eq!(found, plain.nearest(&ray, t_max, |_| false, |_| true), "{ray:?}");
                assert_eq!(found.is_some(), wide.any(&ray, t_max, |_| false, |_, _| true), "{ray:?}");
                assert_eq!(found.is_some(), plain.any(&ray, t_max, |_| false, |_, _| true), "{ray:?}");
                if i % 16 < 4 {
                    let one = |part: u32| {
                        let triangle = Triangle::new(faces[part as usize].map(corner));
                        triangle.intersect(&ray, t_max).map(|intersection| Intersection { part, ..intersection })
                    };
                    let each = (0..faces.len() as u32).filter_map(one);
                    let nearest = each.min_by(|a, b| a.t.total_cmp(&b.t).then(a.part.cmp(&b.part)));
                    assert_eq!(found, nearest, "{ray:?}");
                }
                hits += usize::from(found.is_some());
            }
            assert!(hits > 30_000, "only {hits} rays meet anything");
        }
    }
}
